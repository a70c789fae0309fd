"""Walk through an MCAP file that has no sound end, and find what in it is whole."""

import io
import struct
from dataclasses import dataclass, field
from typing import BinaryIO

from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, ChunkIndex, Message, Metadata, Schema
from mcap.stream_reader import StreamReader, breakup_chunk
from mcap.summary import Summary
from zstandard import ZstdError

MAGIC = b"\x89MCAP0\r\n"
RECORD_HEADER = struct.Struct("<BQ")  # kind, length
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
    size = stream.seek(0, io.SEEK_END)
    stream.seek(len(MAGIC))
    while True:
        start = stream.tell()
        header = stream.read(RECORD_HEADER.size)
        if len(header) < RECORD_HEADER.size:
            return found
        opcode, length = RECORD_HEADER.unpack(header)
        end = start + RECORD_HEADER.size + length
        if end > size:
            return found
        try:
            _take_record(found, opcode, start, header + stream.read(length))
        except DAMAGE:
            if opcode != Opcode.CHUNK:
                return found
            found.damaged_chunks += 1
        stream.seek(end)
        found.kept_bytes = end


def _take_record(found: Scan, opcode: int, start: int, record_bytes: bytes) -> None:
    if opcode not in list(Opcode):
        if opcode == 0:
            raise ValueError("a record of kind 0")
        return
    reader = StreamReader(io.BytesIO(record_bytes), skip_magic=True, emit_chunks=True)
    record = next(reader.records)
    if isinstance(record, Chunk):
        for inside in breakup_chunk(record, validate_crc=True):
            _take_channel_or_message(found, inside)
        found.summary.chunk_indexes.append(
            ChunkIndex(
                chunk_length=len(record_bytes),
                chunk_start_offset=start,
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
    else:
        _take_channel_or_message(found, record)


def _take_channel_or_message(found: Scan, record: object) -> None:
    if isinstance(record, Schema):
        found.summary.schemas[record.id] = record
    elif isinstance(record, Channel):
        found.summary.channels[record.id] = record
    elif isinstance(record, Message):
        found.counts[record.channel_id] = found.counts.get(record.channel_id, 0) + 1
        found.first_ns = min(found.first_ns, record.log_time)
        found.last_ns = max(found.last_ns, record.log_time)
