"""Write a bag that `ros2 bag info` and `ros2 bag play` take: a folder with MCAP files and metadata.yaml."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

from bags.bag_metadata import BagMetadata, CustomEntry, FileRow, TopicRow, joined, read_metadata
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
from bags.file_writer import FileWriter
from bags.manifest import Manifest
from bags.offered_qos import OfferedQos
from robustnav_msgs_py.errors import BadFileError

NS_PER_S = 1_000_000_000
# metadata.yaml of a large graph takes 10 ms to write; at two flushes a second that is too much each time.
FLUSHES_PER_METADATA = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class SplitRule:
    """When a bag goes on in its next file: before the message that would make the file larger or longer.

    0 stands for never. A file may be larger than `size_bytes` by a chunk. With `repeat_latched`, each further
    file begins with the last message of every latched topic, so that it can be understood alone; the repeated
    ones are messages of the bag like any other, with the time of the split and their first publish time.
    """

    size_bytes: int = 0
    duration_s: float = 0.0
    repeat_latched: bool = False


@dataclass(slots=True)
class _Topic:
    name: str
    definition: MessageDefinition
    offers: tuple[OfferedQos, ...]
    latched: tuple[int, bytes] | None = None  # publish time and data of what is to be repeated

    @property
    def is_latched(self) -> bool:
        return any(offer.durability == "transient_local" for offer in self.offers)


class BagWriter:
    """Writes one bag: the folder `folder` with NAME_0.mcap, NAME_1.mcap ... and metadata.yaml in it.

    It goes on in a next file as `split` says, or when `split()` is called; each is closed then and readable
    alone. With `resume`, a bag that a killed recorder left in `folder` is gone on with in its next file, too.
    Opening takes no time even then; `join_earlier_files()` repairs what was cut, which takes a second or more
    for a large file, and brings all into metadata.yaml. `close()` does it where nobody did.

    Chunks are compressed with zstd: on rendered images it makes files a quarter smaller than lz4 and still
    takes 1 GB/s. What was written before a `flush()` outlives a SIGKILL. `manifest` is stored at once, and
    again when `update_manifest()` brings a fuller one; readers take the last.

    One thread at a time may use a writer. Raises BadFileError where the folder exists already (with `resume`:
    and its bag was closed, or is being written) or cannot be made; OSError from the other methods says that
    the disk failed (usually: is full).
    """

    def __init__(
        self,
        folder: Path,
        *,
        manifest: Manifest,
        chunk_bytes: int = 1024 * 1024,
        resume: bool = False,
        split: SplitRule | None = None,
    ) -> None:
        self.folder = folder
        self._manifest = manifest
        self._chunk_bytes = chunk_bytes
        self._split = split or SplitRule()
        self._earlier_paths = find_earlier_files(folder) if resume and folder.is_dir() else ()
        self._earlier = None if self._earlier_paths else EarlierFiles()
        self._told_topics = _told_topics(folder) if self._earlier_paths else ()
        self._finished_files: tuple[FileRow, ...] = ()
        self._finished_topics: tuple[TopicRow, ...] = ()
        self._topics: list[_Topic] = []
        self._number = next_number(folder, self._earlier_paths)
        self._flushes = 0
        self._metadata_is_old = True
        _make_folder(folder, may_exist=resume)
        try:
            self._file = self._next_file()
            self.flush()
        except OSError as error:
            raise _cannot_be_written(folder, error) from error

    @property
    def path(self) -> Path:
        """The file that is written."""
        return self.folder / self._file.name

    @property
    def file_bytes(self) -> int:
        """Size of the MCAP file that is written, so far."""
        return self._file.size_bytes

    def add_topic(self, topic: str, definition: MessageDefinition, offers: Sequence[OfferedQos] = ()) -> int:
        """Add a topic and return the channel to write its messages with.

        A topic that changes its type is added once for each type. What earlier files say of its QoS is said
        again: rosbags passes over what a file holds of a topic with other QoS than metadata.yaml.
        """
        rows = self._told_topics if self._earlier is None else self._earlier.topics
        of_topic = (row.offers for row in rows if (row.name, row.type) == (topic, definition.type))
        offers = next(of_topic, tuple(offers))
        self._topics.append(_Topic(name=topic, definition=definition, offers=tuple(offers)))
        self._metadata_is_old = True
        return self._file.add_topic(topic, definition, offers)

    def write(self, channel: int, *, log_time_ns: int, publish_time_ns: int, data: bytes) -> None:
        """Add a message, serialized as CDR with its four-byte header, to a channel from `add_topic`."""
        if self._is_full(log_time_ns):
            self.split()
        self._file.write(channel, log_time_ns=log_time_ns, publish_time_ns=publish_time_ns, data=data)
        topic = self._topics[channel - 1]
        if self._split.repeat_latched and topic.is_latched:
            topic.latched = (publish_time_ns, data)

    def split(self) -> bool:
        """Close the file and go on in the next one; False where nothing was written to this one yet."""
        if self._file.first_ns is None:
            return False
        self._finish_file()
        split_ns = self._file.last_ns
        self._finished_files += (self._file.row,)
        self._finished_topics = joined((*self._finished_topics, *self._file.topics))
        self._number += 1
        self._file = self._next_file()
        for topic in self._topics:  # in the same order: a topic keeps its channel
            self._file.add_topic(topic.name, topic.definition, topic.offers)
        for channel, topic in enumerate(self._topics, start=1):
            if topic.latched is not None:
                published_ns, data = topic.latched
                self._file.write(channel, log_time_ns=split_ns, publish_time_ns=published_ns, data=data)
        self._metadata_is_old = True
        self.flush()
        return True

    def join_earlier_files(self) -> EarlierFiles:
        """Repair the files before this one that were cut, and count all; the second call only tells again."""
        if self._earlier is None:
            self._earlier = repair_earlier_files(self._earlier_paths)
            self.metadata().write(self.folder)
        return self._earlier

    def flush(self) -> None:
        """Hand everything written so far to the operating system; now and then renew metadata.yaml."""
        self._file.flush()
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
            self._file.store_manifest(manifest)
            self._metadata_is_old = True

    def close(self) -> None:
        """Write the index and the final metadata.yaml; further calls do nothing."""
        if self._file.is_closed:
            return
        self._finish_file()
        self.metadata(closed=True).write(self.folder)

    def metadata(self, *, closed: bool = False) -> BagMetadata:
        """What metadata.yaml says of the bag as it is now."""
        earlier = self._earlier or EarlierFiles()
        return BagMetadata(
            files=(*earlier.files, *self._finished_files, self._file.row),
            topics=joined((*earlier.topics, *self._finished_topics, *self._file.topics)),
            custom=_essentials(self._manifest, closed=closed),
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _is_full(self, now_ns: int) -> bool:
        rule, first_ns = self._split, self._file.first_ns
        if first_ns is None:
            return False
        if rule.size_bytes and self._file.size_bytes >= rule.size_bytes:
            return True
        return rule.duration_s > 0 and now_ns - first_ns >= rule.duration_s * NS_PER_S

    def _next_file(self) -> FileWriter:
        name = file_name(self.folder, self._number)
        stream = _create(self.folder, name)
        return FileWriter(stream, name, manifest=self._manifest, chunk_bytes=self._chunk_bytes)

    def _finish_file(self) -> None:
        """Close the file with what is in it alone, which is what one who opens it alone wants to know."""
        try:
            self.join_earlier_files()
        finally:
            alone = BagMetadata(
                files=(self._file.row,),
                topics=self._file.topics,
                custom=_essentials(self._manifest, closed=False),
            )
            self._file.close(alone)


def _essentials(manifest: Manifest, *, closed: bool) -> tuple[CustomEntry, ...]:
    """What a person who opens metadata.yaml wants to know of the run."""
    told = {
        "robustnav_version": manifest.version,
        "robustnav_commit": manifest.commit,
        "robustnav_seed": "" if manifest.seed is None else str(manifest.seed),
        "robustnav_scene": manifest.scene,
        "robustnav_back_ends": manifest.back_ends_text,
        CLOSED_ENTRY: "yes" if closed else "no",
    }
    return tuple(CustomEntry(name=name, text=text) for name, text in told.items() if text)


def _told_topics(folder: Path) -> tuple[TopicRow, ...]:
    """Topics of a bag as its killed recorder told them; its files may be cut, and take longer to ask."""
    try:
        return read_metadata(folder).topics
    except BadFileError:  # it was killed before it wrote any
        return ()


def _make_folder(folder: Path, *, may_exist: bool) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=may_exist)
    except FileExistsError as error:
        raise _in_the_way(folder) from error
    except OSError as error:
        raise _cannot_be_written(folder, error) from error


def _create(folder: Path, name: str) -> BinaryIO:
    try:
        stream = (folder / name).open("xb")
    except FileExistsError as error:
        raise _in_the_way(folder / name) from error
    except OSError as error:
        raise _cannot_be_written(folder, error) from error
    lock(stream)
    return stream


def _in_the_way(path: Path) -> BadFileError:
    return BadFileError(f"{path} exists already and is not overwritten; choose another name or move it away")


def _cannot_be_written(folder: Path, error: OSError) -> BadFileError:
    return BadFileError(f"a bag cannot be written to {folder}: {error.strerror or error}")
