"""Write an MCAP file from the records of another, with an index and an end of its own."""

import struct
import zlib
from collections.abc import Iterable, Sequence
from typing import BinaryIO

import zstandard
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from bags.mcap_scan import (
    FOOTER,
    MAGIC,
    PROFILE,
    RECORD_HEADER,
    ChunkContents,
    WholeRecord,
    chunk_contents,
)

FOOTER_BEFORE_CHECKSUM = struct.Struct("<BQQQ")


class McapRewriter:
    """Writes a file from whole records: chunks, metadata and attachments are copied as they are.

    mcap's own writer takes messages only one by one, and compresses them again: seven times as slow. Owned by
    one thread; `take` the records of a data section in their order, then `finish`.
    `lost_messages` are those that nothing defines the topic of.
    """

    def __init__(self, output: BinaryIO) -> None:
        self.lost_messages = 0
        self.damaged_chunks = 0
        self._output = output
        self._schemas: dict[int, Schema] = {}
        self._channels: dict[int, Channel] = {}
        self._counts: dict[int, int] = {}
        self._first_ns: int | None = None
        self._last_ns = 0
        self._has_header = False
        self._chunks: list[ChunkIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._attachments: list[AttachmentIndex] = []
        output.write(MAGIC)

    @property
    def channel_count(self) -> int:
        """Topics of the file."""
        return len(self._channels)

    @property
    def message_count(self) -> int:
        """Messages written so far."""
        return sum(self._counts.values())

    def define(self, schemas: Iterable[Schema], channels: Iterable[Channel]) -> None:
        """Know these from here on; a channel whose schema is unknown is not known either."""
        self._schemas.update({schema.id: schema for schema in schemas})
        for channel in channels:
            if channel.schema_id == 0 or channel.schema_id in self._schemas:
                self._channels[channel.id] = channel

    def take(self, whole: WholeRecord) -> None:
        """Write the next record; a damaged chunk is left out."""
        record = whole.record
        if not isinstance(record, Header):
            self._write_missing_header()
        self._has_header = True
        if whole.is_damaged:
            self.damaged_chunks += 1
        elif isinstance(record, Chunk) and whole.contents is not None:
            self._take_chunk(whole.raw, record, whole.contents)
        elif isinstance(record, Message) and record.channel_id not in self._channels:
            self.lost_messages += 1
        elif whole.kind != Opcode.MESSAGE_INDEX:  # these are made anew: the last chunk's may be missing
            self._note(record, len(whole.raw))
            self._output.write(whole.raw)

    def finish(self) -> None:
        """Write the summary and the end of the file."""
        self._write_missing_header()
        self._output.write(record_bytes(DataEnd(data_section_crc=0)))
        summary_at = self._output.tell()
        summary, offsets = RecordBuilder(), RecordBuilder()
        for kind, records in self._summary_groups():
            group_at = summary.count
            for record in records:
                record.write(summary)
            if summary.count > group_at:
                SummaryOffset(
                    group_opcode=kind,
                    group_start=summary_at + group_at,
                    group_length=summary.count - group_at,
                ).write(offsets)
        offsets_at = summary_at + summary.count
        covered = summary.end() + offsets.end()
        begin_of_footer = FOOTER_BEFORE_CHECKSUM.pack(
            Opcode.FOOTER, FOOTER.size - RECORD_HEADER.size, summary_at, offsets_at
        )
        checksum = zlib.crc32(covered + begin_of_footer)
        footer = Footer(summary_start=summary_at, summary_offset_start=offsets_at, summary_crc=checksum)
        self._output.write(covered + record_bytes(footer) + MAGIC)

    def _write_missing_header(self) -> None:
        if not self._has_header:
            self._output.write(record_bytes(Header(profile=PROFILE, library="")))
            self._has_header = True

    def _take_chunk(self, raw: bytes, chunk: Chunk, contents: ChunkContents) -> None:
        self.define(contents.schemas, contents.channels)
        unknown = contents.messages.keys() - self._channels.keys()
        if unknown:
            starts = sorted(start for channel in unknown for _, start in contents.messages[channel])
            self.lost_messages += len(starts)
            chunk = _without(chunk, contents.data, starts)
            raw, contents = record_bytes(chunk), chunk_contents(chunk)
        for channel, places in contents.messages.items():
            self._count(channel, [log_time_ns for log_time_ns, _ in places])
        chunk_at = self._output.tell()
        indexes, index_at = RecordBuilder(), dict[int, int]()
        for channel, places in contents.messages.items():
            index_at[channel] = chunk_at + len(raw) + indexes.count
            MessageIndex(channel_id=channel, records=places).write(indexes)
        self._chunks.append(
            ChunkIndex(
                chunk_length=len(raw),
                chunk_start_offset=chunk_at,
                compression=chunk.compression,
                compressed_size=len(chunk.data),
                message_end_time=chunk.message_end_time,
                message_index_length=indexes.count,
                message_index_offsets=index_at,
                message_start_time=chunk.message_start_time,
                uncompressed_size=chunk.uncompressed_size,
            )
        )
        self._output.write(raw)
        self._output.write(indexes.end())

    def _note(self, record: McapRecord | None, length: int) -> None:
        """Remember for the summary what is about to be written as it is."""
        if isinstance(record, Schema):
            self.define([record], [])
        elif isinstance(record, Channel):
            self.define([], [record])
        elif isinstance(record, Message):
            self._count(record.channel_id, [record.log_time])
        elif isinstance(record, Metadata):
            self._metadata.append(MetadataIndex(offset=self._output.tell(), length=length, name=record.name))
        elif isinstance(record, Attachment):
            self._attachments.append(
                AttachmentIndex(
                    offset=self._output.tell(),
                    length=length,
                    create_time=record.create_time,
                    log_time=record.log_time,
                    data_size=len(record.data),
                    name=record.name,
                    media_type=record.media_type,
                )
            )

    def _count(self, channel: int, log_times_ns: list[int]) -> None:
        self._counts[channel] = self._counts.get(channel, 0) + len(log_times_ns)
        first_ns = min(log_times_ns)
        self._first_ns = first_ns if self._first_ns is None else min(self._first_ns, first_ns)
        self._last_ns = max(self._last_ns, max(log_times_ns))

    def _summary_groups(self) -> list[tuple[Opcode, Sequence[McapRecord]]]:
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=self._counts,
            chunk_count=len(self._chunks),
            message_count=self.message_count,
            message_end_time=self._last_ns,
            message_start_time=self._first_ns or 0,
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )
        return [
            (Opcode.SCHEMA, list(self._schemas.values())),
            (Opcode.CHANNEL, list(self._channels.values())),
            (Opcode.STATISTICS, [statistics]),
            (Opcode.CHUNK_INDEX, self._chunks),
            (Opcode.ATTACHMENT_INDEX, self._attachments),
            (Opcode.METADATA_INDEX, self._metadata),
        ]


def _without(chunk: Chunk, data: bytes, starts: list[int]) -> Chunk:
    """`chunk`, whose contents are `data`, without the records that start at `starts`, in ascending order."""
    kept, at = bytearray(), 0
    for start in starts:
        kept += data[at:start]
        _, length = RECORD_HEADER.unpack_from(data, start)
        at = start + RECORD_HEADER.size + length
    kept += data[at:]
    return new_chunk(bytes(kept), chunk.message_start_time, chunk.message_end_time)


def new_chunk(data: bytes, start_ns: int, end_ns: int) -> Chunk:
    """A chunk of the records in `data`, whose messages have log times from `start_ns` to `end_ns`."""
    return Chunk(
        compression="zstd",
        data=zstandard.compress(data),
        message_end_time=end_ns,
        message_start_time=start_ns,
        uncompressed_crc=zlib.crc32(data),
        uncompressed_size=len(data),
    )


def record_bytes(record: McapRecord) -> bytes:
    """A record as it stands in a file, its header included."""
    builder = RecordBuilder()
    record.write(builder)
    return bytes(builder.end())
