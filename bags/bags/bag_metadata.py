"""metadata.yaml of a bag folder, in the layout of rosbag2 Jazzy (version 9)."""

import contextlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from bags.offered_qos import OfferedQos, offers_from_text
from robustnav_msgs_py.errors import BadFileError

FILE_NAME = "metadata.yaml"
ROOT_KEY = "rosbag2_bagfile_information"
LAYOUT_VERSION = 9
MOST_NAMED = 3  # things to open instead of what is no bag
# The C versions are ten times faster; they are missing where PyYAML was built without libyaml.
DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicRow:
    """One topic of a bag; a topic that was recorded with two types has two rows."""

    name: str
    type: str
    offers: tuple[OfferedQos, ...] = ()
    type_hash: str = ""
    message_count: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class FileRow:
    """One file of a bag: its name inside the folder, and what it holds."""

    name: str
    start_ns: int
    duration_ns: int
    message_count: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CustomEntry:
    """A named text that rosbag2 keeps but does not read."""

    name: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BagMetadata:
    """What metadata.yaml says: the files of a bag, its topics with their counts, and custom entries."""

    files: tuple[FileRow, ...]
    topics: tuple[TopicRow, ...] = ()
    custom: tuple[CustomEntry, ...] = ()
    ros_distro: str = "jazzy"
    storage: str = "mcap"

    @property
    def message_count(self) -> int:
        """Messages in all files."""
        return sum(row.message_count for row in self.files)

    @property
    def start_ns(self) -> int:
        """Earliest log time of the bag; a file without messages counts only where all are without."""
        return min(row.start_ns for row in self._telling_files)

    @property
    def duration_ns(self) -> int:
        """From the first message to the last."""
        return max(row.start_ns + row.duration_ns for row in self._telling_files) - self.start_ns

    @property
    def _telling_files(self) -> tuple[FileRow, ...]:
        return tuple(row for row in self.files if row.message_count) or self.files

    def as_text(self) -> str:
        """YAML without its root key, as rosbag2 also stores it inside the MCAP file."""
        return str(yaml.dump(self._as_mapping(), Dumper=DUMPER, sort_keys=False))

    def write(self, folder: Path) -> None:
        """Write metadata.yaml into `folder`; a reader sees the old one or the new one, never half of it."""
        text = yaml.dump({ROOT_KEY: self._as_mapping()}, Dumper=DUMPER, sort_keys=False)
        unfinished = folder / (FILE_NAME + ".part")
        try:
            unfinished.write_text(text, encoding="utf-8")
            unfinished.replace(folder / FILE_NAME)
        except OSError:
            with contextlib.suppress(OSError):
                unfinished.unlink(missing_ok=True)
            raise

    def _as_mapping(self) -> dict[str, Any]:
        return {
            "version": LAYOUT_VERSION,
            "storage_identifier": self.storage,
            "duration": {"nanoseconds": self.duration_ns},
            "starting_time": {"nanoseconds_since_epoch": self.start_ns},
            "message_count": self.message_count,
            "topics_with_message_count": [
                {
                    "topic_metadata": {
                        "name": row.name,
                        "type": row.type,
                        "serialization_format": "cdr",
                        "offered_qos_profiles": [offer.as_mapping() for offer in row.offers],
                        "type_description_hash": row.type_hash,
                    },
                    "message_count": row.message_count,
                }
                for row in self.topics
            ],
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [row.name for row in self.files],
            "files": [
                {
                    "path": row.name,
                    "starting_time": {"nanoseconds_since_epoch": row.start_ns},
                    "duration": {"nanoseconds": row.duration_ns},
                    "message_count": row.message_count,
                }
                for row in self.files
            ],
            "custom_data": {entry.name: entry.text for entry in self.custom} or None,
            "ros_distro": self.ros_distro,
        }


def joined(rows: Iterable[TopicRow]) -> tuple[TopicRow, ...]:
    """One row for each topic and type, in order of appearance: counts are summed, the rest is the first's."""
    found: dict[tuple[str, str], TopicRow] = {}
    for row in rows:
        known = found.get((row.name, row.type))
        count = row.message_count + (known.message_count if known else 0)
        found[row.name, row.type] = replace(known or row, message_count=count)
    return tuple(found.values())


def read_metadata(folder: Path) -> BagMetadata:
    """Read metadata.yaml of the bag in `folder`, written by us or by rosbag2 (version 4 and later).

    Raises BadFileError where it is missing or is not what rosbag2 writes.
    """
    path = folder / FILE_NAME
    try:
        document = yaml.load(path.read_text(encoding="utf-8"), Loader=LOADER)  # noqa: S506 (it is a safe loader)
    except FileNotFoundError as error:
        raise BadFileError(f"{folder} has no {FILE_NAME}, so it is no bag{_advice(folder)}") from error
    except (OSError, UnicodeDecodeError) as error:
        raise BadFileError(f"{path} cannot be read: {error}") from error
    except yaml.YAMLError as error:
        raise BadFileError(f"{path} is not YAML: {' '.join(str(error).split())}") from error
    if not isinstance(document, dict) or ROOT_KEY not in document:
        raise BadFileError(f"{path} is not the metadata of a bag: it does not begin with {ROOT_KEY}")
    try:
        return _from_mapping(document[ROOT_KEY])
    except (KeyError, TypeError, ValueError) as error:
        raise BadFileError(f"{path} is not the metadata of a bag: {error!r} in what it says") from error


def _advice(folder: Path) -> str:
    """What to open instead of a folder that is no bag."""
    bags = sorted(path.parent.name for path in folder.glob(f"*/{FILE_NAME}"))
    found = sorted(path.name for path in folder.glob("*.mcap")) + bags
    if not found:
        return ", and it holds none"
    others = f" and {len(found) - MOST_NAMED} more" if len(found) > MOST_NAMED else ""
    return f"; it holds {', '.join(found[:MOST_NAMED])}{others}: open one of these itself"


def _from_mapping(mapping: dict[str, Any]) -> BagMetadata:
    start_ns = int(mapping["starting_time"]["nanoseconds_since_epoch"])
    duration_ns = int(mapping["duration"]["nanoseconds"])
    listed = {str(row["path"]): row for row in mapping.get("files") or ()}
    files = []
    for name in mapping["relative_file_paths"]:
        row = listed.get(Path(name).name)
        files.append(
            FileRow(
                name=Path(name).name,
                start_ns=int(row["starting_time"]["nanoseconds_since_epoch"]) if row else start_ns,
                duration_ns=int(row["duration"]["nanoseconds"]) if row else duration_ns,
                message_count=int(row["message_count"] if row else mapping["message_count"]),
            )
        )
    return BagMetadata(
        files=tuple(files),
        topics=tuple(_topic_row(row) for row in mapping["topics_with_message_count"]),
        custom=tuple(
            CustomEntry(name=str(name), text=str(text))
            for name, text in (mapping.get("custom_data") or {}).items()
        ),
        ros_distro=str(mapping.get("ros_distro", "")),
        storage=str(mapping["storage_identifier"]),
    )


def _topic_row(row: dict[str, Any]) -> TopicRow:
    about = row["topic_metadata"]
    profiles = about.get("offered_qos_profiles") or []
    if isinstance(profiles, str):  # before version 9 it is a YAML text inside the YAML
        offers = offers_from_text(profiles)
    else:
        offers = tuple(OfferedQos.from_mapping(profile) for profile in profiles)
    return TopicRow(
        name=str(about["name"]),
        type=str(about["type"]),
        offers=offers,
        type_hash=str(about.get("type_description_hash", "")),
        message_count=int(row["message_count"]),
    )
