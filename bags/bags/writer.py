"""Write a bag that `ros2 bag info` and `ros2 bag play` take: a folder with MCAP files and metadata.yaml."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

from bags.bag_metadata import BagMetadata, CustomEntry, FileRow, TopicRow, joined
from bags.definitions import MessageDefinition
from bags.earlier_files import (
    CLOSED_ENTRY,
    EarlierFiles,
    file_name,
    find_earlier_files,
    lock,
    next_number,
    repair_earlier_files,
)
from bags.manifest import Manifest
from bags.mcap_scan import PROFILE
from bags.offered_qos import OfferedQos, offers_as_text
from robustnav_msgs_py.errors import BadFileError

MANIFEST_RECORD = "robustnav_manifest"
MANIFEST_ATTACHMENT = "robustnav_manifest.json"
# Tools hold metadata records in memory as soon as they open a file; attachments are read when asked for.
LARGEST_MANIFEST_RECORD = 64 * 1024
# metadata.yaml of a large graph takes 10 ms to write; at one flush a second that is too much each time.
FLUSHES_PER_METADATA = 10


@dataclass(slots=True)
class _Channel:
    topic: str
    definition: MessageDefinition
    offers: tuple[OfferedQos, ...]
    message_count: int = field(default=0)


class BagWriter:
    """Writes one bag: the folder `folder` with the file NAME_0.mcap and metadata.yaml in it.

    With `resume`, a bag that a killed recorder left in `folder` is gone on with in its next file, NAME_1.mcap
    and so on. Opening takes no time even then; `join_earlier_files()` repairs what was cut, which takes a
    second or more for a large file, and brings all into metadata.yaml. `close()` does it where nobody did.

    Chunks are compressed with zstd: on rendered images it makes files a quarter smaller than lz4 and still
    takes 1 GB/s. What was written before a `flush()` outlives a SIGKILL. `manifest` is stored at once, and
    again when `update_manifest()` brings a fuller one; readers take the last.

    One thread at a time may use a writer. Raises BadFileError where the folder exists already (with `resume`:
    and its bag was closed, or is being written) or cannot be made; OSError from the other methods says that
    the disk failed (usually: is full).
    """

    def __init__(
        self, folder: Path, *, manifest: Manifest, chunk_bytes: int = 1024 * 1024, resume: bool = False
    ) -> None:
        self.folder = folder
        self._manifest = manifest
        self._earlier_paths = find_earlier_files(folder) if resume and folder.is_dir() else ()
        self._earlier = None if self._earlier_paths else EarlierFiles()
        self._file_name = file_name(folder, next_number(folder, self._earlier_paths))
        self._channels: list[_Channel] = []
        self._schema_ids: dict[str, int] = {}
        self._first_ns: int | None = None
        self._last_ns = 0
        self._flushes = 0
        self._metadata_is_old = True
        self._file = _create(folder, self._file_name, folder_may_exist=resume)
        self._mcap = McapWriter(self._file, chunk_size=chunk_bytes, compression=CompressionType.ZSTD)
        self._mcap.start(profile=PROFILE, library=f"robustnav {manifest.version}".rstrip())
        self._store_manifest()
        self.flush()

    @property
    def path(self) -> Path:
        """The file that is written."""
        return self.folder / self._file_name

    @property
    def file_bytes(self) -> int:
        """Size of the MCAP file so far."""
        return self._file.tell()

    def add_topic(self, topic: str, definition: MessageDefinition, offers: Sequence[OfferedQos] = ()) -> int:
        """Add a topic and return the channel to write its messages with.

        A topic that changes its type is added once for each type.
        """
        schema_id = self._schema_ids.get(definition.type)
        if schema_id is None:
            encoding = "ros2msg" if definition.text else ""
            schema_id = self._mcap.register_schema(definition.type, encoding, definition.text.encode())
            self._schema_ids[definition.type] = schema_id
        details = {
            "offered_qos_profiles": offers_as_text(offers),
            "topic_type_hash": definition.type_hash,
        }
        channel_id = self._mcap.register_channel(topic, "cdr", schema_id, details)
        self._channels.append(_Channel(topic=topic, definition=definition, offers=tuple(offers)))
        self._metadata_is_old = True
        return channel_id

    def write(self, channel: int, *, log_time_ns: int, publish_time_ns: int, data: bytes) -> None:
        """Add a message, serialized as CDR with its four-byte header, to a channel from `add_topic`."""
        self._mcap.add_message(
            channel_id=channel, log_time=log_time_ns, publish_time=publish_time_ns, data=data
        )
        self._channels[channel - 1].message_count += 1
        self._first_ns = log_time_ns if self._first_ns is None else min(self._first_ns, log_time_ns)
        self._last_ns = max(self._last_ns, log_time_ns)

    def join_earlier_files(self) -> EarlierFiles:
        """Repair the files before this one that were cut, and count all; the second call only tells again."""
        if self._earlier is None:
            self._earlier = repair_earlier_files(self._earlier_paths)
            self.metadata().write(self.folder)
        return self._earlier

    def flush(self) -> None:
        """Hand everything written so far to the operating system; now and then renew metadata.yaml."""
        self._mcap.flush()
        self._flushes += 1
        if self._earlier is None:  # until these are joined, metadata.yaml stays the killed recorder's
            return
        if self._metadata_is_old or self._flushes % FLUSHES_PER_METADATA == 0:
            self.metadata().write(self.folder)
            self._metadata_is_old = False

    def update_manifest(self, manifest: Manifest) -> None:
        """Store a manifest that knows more than the last one."""
        if manifest != self._manifest:
            self._manifest = manifest
            self._store_manifest()
            self._metadata_is_old = True

    def close(self) -> None:
        """Write the index and the final metadata.yaml; further calls do nothing."""
        if self._file.closed:
            return
        try:
            self.join_earlier_files()
            self._mcap.add_metadata("rosbag2", {"serialized_metadata": self.metadata().as_text()})
            self._mcap.finish()
        finally:
            self._file.close()
        self.metadata(closed=True).write(self.folder)

    def metadata(self, *, closed: bool = False) -> BagMetadata:
        """What metadata.yaml says of the bag as it is now."""
        first_ns = self._manifest.wall_start_ns if self._first_ns is None else self._first_ns
        row = FileRow(
            name=self._file_name,
            start_ns=first_ns,
            duration_ns=max(0, self._last_ns - first_ns),
            message_count=sum(channel.message_count for channel in self._channels),
        )
        own = (
            TopicRow(
                name=channel.topic,
                type=channel.definition.type,
                offers=channel.offers,
                type_hash=channel.definition.type_hash,
                message_count=channel.message_count,
            )
            for channel in self._channels
        )
        earlier = self._earlier or EarlierFiles()
        return BagMetadata(
            files=(*earlier.files, row),
            topics=joined((*earlier.topics, *own)),
            custom=_essentials(self._manifest, closed=closed),
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _store_manifest(self) -> None:
        text = self._manifest.as_json()
        if len(text.encode()) <= LARGEST_MANIFEST_RECORD:
            self._mcap.add_metadata(MANIFEST_RECORD, {"json": text})
            return
        now_ns = time.time_ns()
        self._mcap.add_attachment(now_ns, now_ns, MANIFEST_ATTACHMENT, "application/json", text.encode())
        self._mcap.add_metadata(MANIFEST_RECORD, {"attachment": MANIFEST_ATTACHMENT})


def _essentials(manifest: Manifest, *, closed: bool) -> tuple[CustomEntry, ...]:
    """What a person who opens metadata.yaml wants to know of the run."""
    told = {
        "robustnav_version": manifest.version,
        "robustnav_commit": manifest.commit,
        "robustnav_seed": "" if manifest.seed is None else str(manifest.seed),
        "robustnav_scene": manifest.scene,
        "robustnav_back_ends": ", ".join(
            f"{row.node} {row.parameter}={row.choice}" for row in manifest.back_ends
        ),
        CLOSED_ENTRY: "yes" if closed else "no",
    }
    return tuple(CustomEntry(name=name, text=text) for name, text in told.items() if text)


def _create(folder: Path, file_name: str, *, folder_may_exist: bool) -> BinaryIO:
    try:
        folder.mkdir(parents=True, exist_ok=folder_may_exist)
        stream = (folder / file_name).open("xb")
    except FileExistsError as error:
        raise BadFileError(
            f"{folder} exists already and is not overwritten; choose another name or move it away"
        ) from error
    except OSError as error:
        raise BadFileError(f"a bag cannot be written to {folder}: {error.strerror or error}") from error
    lock(stream)
    return stream
