"""Walk through an MCAP file record by record, and find what in it is whole where it has no sound end."""

import io
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import Attachment, Channel, Chunk, ChunkIndex, McapRecord, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, get_chunk_data_stream
from mcap.summary import Summary
from zstandard import ZstdError

from robustnav_msgs_py.errors import BadFileError

MAGIC = b"\x89MCAP0\r\n"
PROFILE = "ros2"  # in the header of a file that holds ROS 2 messages
RECORD_HEADER = struct.Struct("<BQ")  # kind, length
MESSAGE_HEADER = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
FOOTER = struct.Struct("<BQQQI")  # kind, length, begin of the summary, of its offsets, checksum of all before
# What is shorter than this has no end to read an index from.
SMALLEST_FILE = 2 * len(MAGIC) + FOOTER.size
KNOWN_KINDS = frozenset(Opcode)
# Everything that reading bytes which are not what they should be has been seen to raise.
DAMAGE = (
    McapError,
    ZstdError,
    struct.error,
    ValueError,
    KeyError,
    IndexError,
    OverflowError,
    MemoryError,
    RuntimeError,
    OSError,  # a seek to where no file reaches
    StopIteration,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChunkContents:
    """What is in a chunk: `data` uncompressed, the definitions in it, and where its messages lie in `data`.

    messages: (log time, offset) of each message, by channel, as a message index holds them.
    """

    data: bytes
    schemas: tuple[Schema, ...]
    channels: tuple[Channel, ...]
    messages: dict[int, list[tuple[int, int]]]


@dataclass(frozen=True, slots=True, kw_only=True)
class WholeRecord:
    """A record that lies wholly in a file: where it begins, its bytes with their header, and what it says.

    `record` is None for kinds that only index others, or that this version does not know, and for a chunk
    that is damaged; `contents` is what a chunk holds.
    """

    kind: int
    start: int
    raw: bytes
    record: McapRecord | None = None
    contents: ChunkContents | None = None

    @property
    def end(self) -> int:
        """Where the next record begins."""
        return self.start + len(self.raw)

    @property
    def is_damaged(self) -> bool:
        """Whether it is a chunk that cannot be read."""
        return self.kind == Opcode.CHUNK and self.record is None


def open_file(path: Path) -> BinaryIO:
    """Open a file for reading; raises BadFileError."""
    try:
        return path.open("rb")
    except OSError as error:
        raise BadFileError(f"{path} cannot be opened: {error.strerror or error}") from error


def whole_records(stream: BinaryIO) -> Iterator[WholeRecord]:
    """The records of a file that begins with the magic, up to the first that is not whole or makes no sense.

    Holds one record in memory at a time.
    """
    size = stream.seek(0, io.SEEK_END)
    start = len(MAGIC)
    while True:
        stream.seek(start)
        header = stream.read(RECORD_HEADER.size)
        if len(header) < RECORD_HEADER.size:
            return
        kind, length = RECORD_HEADER.unpack(header)
        if kind == 0 or start + RECORD_HEADER.size + length > size:
            return
        raw = header + stream.read(length)
        try:
            found = _whole_record(kind, start, raw)
        except DAMAGE:
            if kind != Opcode.CHUNK:
                return
            found = WholeRecord(kind=kind, start=start, raw=raw)
        yield found
        start = found.end


def chunk_contents(chunk: Chunk) -> ChunkContents:
    """Definitions in a chunk, and where its messages lie; raises one of DAMAGE where it is damaged.

    Walks over messages without reading them: files of small messages hold millions.
    """
    stream, size = get_chunk_data_stream(chunk, validate_crc=True)
    data = stream.read(size)
    definitions: list[McapRecord] = []
    messages: dict[int, list[tuple[int, int]]] = {}
    start = 0
    while start < size:
        kind, length = RECORD_HEADER.unpack_from(data, start)
        end = start + RECORD_HEADER.size + length
        if end > size:
            raise ValueError(f"a record of {length} bytes does not fit into its chunk")
        if kind == Opcode.MESSAGE:
            channel, _, log_time_ns, _ = MESSAGE_HEADER.unpack_from(data, start + RECORD_HEADER.size)
            messages.setdefault(channel, []).append((log_time_ns, start))
        elif kind in (Opcode.SCHEMA, Opcode.CHANNEL):
            definitions.append(_parse(data[start:end]))
        start = end
    return ChunkContents(
        data=data,
        schemas=tuple(record for record in definitions if isinstance(record, Schema)),
        channels=tuple(record for record in definitions if isinstance(record, Channel)),
        messages=messages,
    )


def summary_at_end(stream: BinaryIO) -> Summary | None:
    """The summary of a file that was finished; None where the file has no sound end."""
    try:
        if not _end_is_sound(stream):
            return None
        stream.seek(0)
        return SeekingReader(stream).get_summary()
    except DAMAGE:
        return None


@dataclass(slots=True)
class Scan:
    """What is whole in a file.

    summary: its schemas, channels and whole chunks; counts: messages by channel; first_ns, last_ns: their log
    times; kept_bytes: where the last whole record ends.
    """

    summary: Summary = field(default_factory=Summary)
    counts: dict[int, int] = field(default_factory=dict)
    metadata: list[Metadata] = field(default_factory=list)
    attachments: list[Attachment] = field(default_factory=list)
    first_ns: int = 2**63 - 1
    last_ns: int = 0
    damaged_chunks: int = 0
    kept_bytes: int = len(MAGIC)


def scan(stream: BinaryIO) -> Scan:
    """Walk through the records of a file that begins with the magic; chunks that are damaged are left out."""
    found = Scan()
    for whole in whole_records(stream):
        _take(found, whole)
        found.kept_bytes = whole.end
    return found


def _take(found: Scan, whole: WholeRecord) -> None:
    record, contents = whole.record, whole.contents
    if whole.is_damaged:
        found.damaged_chunks += 1
    elif isinstance(record, Chunk) and contents is not None:
        found.summary.schemas.update({schema.id: schema for schema in contents.schemas})
        found.summary.channels.update({channel.id: channel for channel in contents.channels})
        for channel, places in contents.messages.items():
            _count(found, channel, [log_time_ns for log_time_ns, _ in places])
        found.summary.chunk_indexes.append(
            ChunkIndex(
                chunk_length=len(whole.raw),
                chunk_start_offset=whole.start,
                compression=record.compression,
                compressed_size=len(record.data),
                message_end_time=record.message_end_time,
                message_index_length=0,
                message_index_offsets={},
                message_start_time=record.message_start_time,
                uncompressed_size=record.uncompressed_size,
            )
        )
    elif isinstance(record, Metadata):
        found.metadata.append(record)
    elif isinstance(record, Attachment):
        found.attachments.append(record)
    elif isinstance(record, Schema):
        found.summary.schemas[record.id] = record
    elif isinstance(record, Channel):
        found.summary.channels[record.id] = record
    elif isinstance(record, Message):
        _count(found, record.channel_id, [record.log_time])


def _count(found: Scan, channel: int, log_times_ns: list[int]) -> None:
    found.counts[channel] = found.counts.get(channel, 0) + len(log_times_ns)
    found.first_ns = min(found.first_ns, min(log_times_ns))
    found.last_ns = max(found.last_ns, max(log_times_ns))


def _whole_record(kind: int, start: int, raw: bytes) -> WholeRecord:
    if kind not in KNOWN_KINDS or kind == Opcode.MESSAGE_INDEX:
        return WholeRecord(kind=kind, start=start, raw=raw)
    record = _parse(raw)
    contents = chunk_contents(record) if isinstance(record, Chunk) else None
    return WholeRecord(kind=kind, start=start, raw=raw, record=record, contents=contents)


def _parse(raw: bytes) -> McapRecord:
    return next(StreamReader(io.BytesIO(raw), skip_magic=True, emit_chunks=True).records)


def _end_is_sound(stream: BinaryIO) -> bool:
    """Whether footer and magic stand at the end, and the summary is what its checksum says."""
    size = stream.seek(0, io.SEEK_END)
    if size < SMALLEST_FILE:
        return False
    footer_at = stream.seek(size - len(MAGIC) - FOOTER.size)
    footer = stream.read(FOOTER.size)
    kind, _, summary_at, _, checksum = FOOTER.unpack(footer)
    if kind != Opcode.FOOTER or stream.read() != MAGIC or not 0 < summary_at <= footer_at:
        return False
    stream.seek(summary_at)
    covered = stream.read(footer_at - summary_at) + footer[:-4]
    return checksum in (0, zlib.crc32(covered))
