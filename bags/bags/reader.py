"""Read a bag: a folder that a recorder made, or any MCAP file with ROS 2 messages; needs no ROS to run."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from bags.bag_metadata import BagMetadata, TopicRow, joined, read_metadata
from bags.decoding import MessageDecoder
from bags.file_writer import MANIFEST_RECORD
from bags.manifest import Manifest, manifest_from_json
from bags.mcap_file import FileChannel, McapFile
from robustnav_msgs_py.errors import BadFileError


@dataclass(frozen=True, slots=True, kw_only=True)
class RawMessage:
    """One message as it was recorded: `data` is CDR. Times are nanoseconds of wall-clock time."""

    topic: str
    type: str
    log_time_ns: int
    publish_time_ns: int
    data: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordedMessage:
    """One message, decoded: `message` has the fields of its ROS type, arrays as numpy arrays."""

    topic: str
    type: str
    log_time_ns: int
    publish_time_ns: int
    message: Any


class Bag:
    """An open bag. Iterating is repeatable and holds one chunk of a file in memory at a time.

    `cut` is "" where every file was closed properly, and otherwise a sentence that says what is left;
    what is left is read like any other bag. Use it in a `with` statement or call `close()`.
    """

    def __init__(self, path: Path, files: tuple[McapFile, ...], metadata: BagMetadata | None) -> None:
        self.path = path
        self.metadata = metadata
        self._files = files
        self._decoder = MessageDecoder()
        for channel in self._channels():
            if channel.encoding != "cdr":
                raise BadFileError(
                    f"{path} holds {channel.topic!r} as {channel.encoding!r}, not as cdr: it is no ROS 2 bag"
                )

    @property
    def cut(self) -> str:
        """What is left of the files that were not closed properly, "" where all were."""
        return "; ".join(file.cut for file in self._files if file.cut)

    @property
    def size_bytes(self) -> int:
        """Size of the files on disk."""
        return sum(file.size_bytes for file in self._files)

    @property
    def span_ns(self) -> tuple[int, int] | None:
        """First and last log time, None where the bag holds no message."""
        spans = [span for file in self._files if (span := file.span_ns)]
        return (min(span[0] for span in spans), max(span[1] for span in spans)) if spans else None

    @property
    def compression(self) -> str:
        """How chunks are compressed: "zstd", "lz4", or "" for not at all."""
        return next((file.compression for file in self._files if file.compression), "")

    @property
    def topics(self) -> tuple[TopicRow, ...]:
        """Topics by name, with types, publishers' QoS and the counts that the files themselves tell."""
        rows = joined(channel.row for channel in self._channels())
        return tuple(sorted(rows, key=lambda row: (row.name, row.type)))

    @property
    def manifest(self) -> Manifest | None:
        """What made the run; None where the recorder was not ours."""
        for file in reversed(self._files):
            for record in reversed(file.metadata_records(MANIFEST_RECORD)):
                text = record.get("json") or (file.attachment(record.get("attachment", "")) or b"").decode()
                if text:
                    return manifest_from_json(text)
        return None

    def raw_messages(
        self,
        topics: Collection[str] | None = None,
        *,
        start_ns: int | None = None,
        stop_ns: int | None = None,
    ) -> Iterator[RawMessage]:
        """Messages of `topics` (all where None) in order of log time, from `start_ns` until before `stop_ns`.

        Raises BadFileError where a file is damaged inside.
        """
        for file in self._files:
            for topic, message_type, message in file.messages(topics, start_ns, stop_ns):
                yield RawMessage(
                    topic=topic,
                    type=message_type,
                    log_time_ns=message.log_time,
                    publish_time_ns=message.publish_time,
                    data=message.data,
                )

    def messages(
        self,
        topics: Collection[str] | None = None,
        *,
        start_ns: int | None = None,
        stop_ns: int | None = None,
    ) -> Iterator[RecordedMessage]:
        """Like `raw_messages`, decoded; raises BadFileError also where a message is not of its type."""
        for channel in self._channels():
            if topics is None or channel.topic in topics:
                try:
                    self._decoder.add(channel.type, channel.definition, channel.definition_encoding)
                except BadFileError as error:
                    raise BadFileError(f"{channel.topic!r} in {self.path}: {error}") from error
        for raw in self.raw_messages(topics, start_ns=start_ns, stop_ns=stop_ns):
            try:
                message = self._decoder.decode(raw.type, raw.data)
            except BadFileError as error:
                raise BadFileError(f"{raw.topic!r} in {self.path}: {error}") from error
            yield RecordedMessage(
                topic=raw.topic,
                type=raw.type,
                log_time_ns=raw.log_time_ns,
                publish_time_ns=raw.publish_time_ns,
                message=message,
            )

    def close(self) -> None:
        """Close its files."""
        for file in self._files:
            file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _channels(self) -> Iterator[FileChannel]:
        for file in self._files:
            yield from file.channels


def open_bag(path: Path) -> Bag:
    """Open the bag folder or the .mcap file at `path`.

    Raises BadFileError where there is no bag, or nothing of it is left; a bag of a run that was killed opens
    with a sentence in `Bag.cut`.
    """
    if not path.exists():
        raise BadFileError(f"there is no bag at {path}")
    metadata = read_metadata(path) if path.is_dir() else None
    if metadata and metadata.storage != "mcap":
        raise BadFileError(
            f"{path} is stored as {metadata.storage!r}; convert it to MCAP first, with `ros2 bag convert`"
        )
    paths = [path / row.name for row in metadata.files] if metadata else [path]
    files: list[McapFile] = []
    try:
        files.extend(McapFile(file_path) for file_path in paths)
        return Bag(path, tuple(files), metadata)
    except BaseException:
        for file in files:
            file.close()
        raise
