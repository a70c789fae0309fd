"""One MCAP file: its channels and messages, from its index or, where a run was killed, from what is whole."""

import io
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap.exceptions import McapError
from mcap.reader import SeekingReader
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader
from mcap.summary import Summary

from bags.bag_metadata import TopicRow
from bags.mcap_scan import DAMAGE, MAGIC, Scan, open_file, scan, summary_at_end
from bags.offered_qos import offers_from_text
from robustnav_msgs_py.errors import BadFileError


class _IndexedReader(SeekingReader):
    """A seeking reader that is told the summary, which for a file without one comes from a scan."""

    def __init__(self, stream: BinaryIO, summary: Summary) -> None:
        super().__init__(stream, validate_crcs=True)
        self._told = summary

    def get_summary(self) -> Summary:
        return self._told


@dataclass(frozen=True, slots=True, kw_only=True)
class FileChannel:
    """A topic in one file, with the definition of its type as the file holds it."""

    topic: str
    type: str
    encoding: str
    definition: str
    definition_encoding: str
    offered_qos: str
    type_hash: str
    message_count: int

    @property
    def row(self) -> TopicRow:
        """The topic as metadata.yaml tells it; raises BadFileError where its QoS cannot be read."""
        try:
            offers = offers_from_text(self.offered_qos)
        except BadFileError as error:
            raise BadFileError(f"what stands in the file about {self.topic!r} is damaged: {error}") from error
        return TopicRow(
            name=self.topic,
            type=self.type,
            offers=offers,
            type_hash=self.type_hash,
            message_count=self.message_count,
        )


class McapFile:
    """One MCAP file, open for reading; close it, or use it in a `with` statement of its owner.

    `cut` is "" for a file that was finished, and otherwise a sentence that says what is left of it.
    Raises BadFileError where the file is missing, empty, no MCAP, or where nothing of it is whole.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.cut = ""
        self._stream = open_file(path)
        self._scan: Scan | None = None
        try:
            self._check_magic()
            self._summary, self._counts = self._indexed() or self._scanned()
        except BaseException:
            self._stream.close()
            raise

    def close(self) -> None:
        """Close the file; it cannot be read any further."""
        self._stream.close()

    @property
    def size_bytes(self) -> int:
        """Size on disk."""
        return self.path.stat().st_size

    @property
    def channels(self) -> tuple[FileChannel, ...]:
        """Topics in the order in which they were added."""
        found = []
        for channel in self._summary.channels.values():
            schema = self._summary.schemas.get(channel.schema_id)
            found.append(
                FileChannel(
                    topic=channel.topic,
                    type=schema.name if schema else "",
                    encoding=channel.message_encoding,
                    definition=schema.data.decode(errors="replace") if schema else "",
                    definition_encoding=schema.encoding if schema else "",
                    offered_qos=channel.metadata.get("offered_qos_profiles", ""),
                    type_hash=channel.metadata.get("topic_type_hash", ""),
                    message_count=self._counts.get(channel.id, 0),
                )
            )
        return tuple(found)

    @property
    def span_ns(self) -> tuple[int, int] | None:
        """First and last log time, None where no message is left."""
        if not sum(self._counts.values()):
            return None
        if self._scan is not None:
            return self._scan.first_ns, self._scan.last_ns
        statistics = self._summary.statistics
        return (statistics.message_start_time, statistics.message_end_time) if statistics else None

    @property
    def compression(self) -> str:
        """How chunks are compressed: "zstd", "lz4" or "" for not at all."""
        return next((index.compression for index in self._summary.chunk_indexes), "")

    def messages(
        self, topics: Collection[str] | None, start_ns: int | None, stop_ns: int | None
    ) -> Iterator[tuple[str, str, Message]]:
        """Topic, type and raw message of each, in order of log time; `stop_ns` is exclusive.

        Raises BadFileError at a chunk that is damaged.
        """
        if self._scan is not None and not self._summary.chunk_indexes:
            found = self._loose_messages(topics, start_ns, stop_ns)
        else:
            found = self._reader().iter_messages(topics, starting_at=start_ns, ending_before=stop_ns)
        try:
            for schema, channel, message in found:
                yield channel.topic, schema.name if schema else "", message
        except DAMAGE as error:
            raise BadFileError(
                f"{self.path} is damaged inside and cannot be read to its end: {error!r}; "
                "`robustnav bag repair` keeps what is whole"
            ) from error

    def metadata_records(self, name: str) -> tuple[dict[str, str], ...]:
        """Contents of the metadata records called `name`, in the order of the file."""
        try:
            records = self._scan.metadata if self._scan else list(self._reader().iter_metadata())
        except DAMAGE as error:
            raise BadFileError(f"the metadata in {self.path} cannot be read: {error!r}") from error
        return tuple(record.metadata for record in records if record.name == name)

    def attachment(self, name: str) -> bytes | None:
        """Contents of the last attachment called `name`, None where there is none."""
        try:
            records = self._scan.attachments if self._scan else list(self._reader().iter_attachments())
        except DAMAGE as error:
            raise BadFileError(f"the attachments of {self.path} cannot be read: {error!r}") from error
        return next((record.data for record in reversed(records) if record.name == name), None)

    def _check_magic(self) -> None:
        start = self._stream.read(len(MAGIC))
        if not start:
            raise BadFileError(f"{self.path} is empty: nothing was recorded, or the disk was full")
        if start != MAGIC:
            cut_at_once = MAGIC.startswith(start)
            raise BadFileError(
                f"{self.path} was cut after {len(start)} bytes; nothing of it is left"
                if cut_at_once
                else f"{self.path} is not an MCAP file: it starts with {start!r}"
            )

    def _indexed(self) -> tuple[Summary, dict[int, int]] | None:
        """Summary and counts as the end of the file tells them, None where it does not."""
        summary = summary_at_end(self._stream)
        if summary is None or summary.statistics is None:
            return None
        complete = summary.statistics.channel_count == len(summary.channels)
        indexed = summary.chunk_indexes or not summary.statistics.message_count
        return (summary, summary.statistics.channel_message_counts) if complete and indexed else None

    def _scanned(self) -> tuple[Summary, dict[int, int]]:
        found = self._scan = scan(self._stream)
        self._stream.seek(found.kept_bytes)
        finished = self._stream.read() == MAGIC
        size = self._stream.tell()
        if not finished or found.damaged_chunks:
            what = "is damaged inside" if finished else "was not closed properly"
            damaged = f", {found.damaged_chunks} chunks are damaged" if found.damaged_chunks else ""
            self.cut = (
                f"{self.path} {what}: {found.kept_bytes} of its {size} bytes are whole{damaged}; "
                f"{sum(found.counts.values())} messages of {len(found.summary.channels)} topics are kept"
            )
        return found.summary, found.counts

    def _reader(self) -> SeekingReader:
        self._stream.seek(0)
        return _IndexedReader(self._stream, self._summary)

    def _loose_messages(
        self, topics: Collection[str] | None, start_ns: int | None, stop_ns: int | None
    ) -> Iterator[tuple[Schema | None, Channel, Message]]:
        """Messages that lie outside chunks, for files written without them; these are read into memory."""
        self._stream.seek(0)
        whole = io.BytesIO(self._stream.read(self._scan.kept_bytes if self._scan else -1))
        found = []
        for record in _records(whole):
            if not isinstance(record, Message):
                continue
            channel = self._summary.channels[record.channel_id]
            wanted = topics is None or channel.topic in topics
            early = start_ns is not None and record.log_time < start_ns
            late = stop_ns is not None and record.log_time >= stop_ns
            if wanted and not early and not late:
                found.append((self._summary.schemas.get(channel.schema_id), channel, record))
        yield from sorted(found, key=lambda item: item[2].log_time)


def _records(stream: BinaryIO) -> Iterator[object]:
    try:
        yield from StreamReader(stream).records
    except McapError:  # the end of what is whole
        return
