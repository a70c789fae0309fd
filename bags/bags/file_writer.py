"""One MCAP file of a bag while it is written."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import BinaryIO

from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

from bags.bag_metadata import BagMetadata, FileRow, TopicRow, joined
from bags.definitions import MessageDefinition
from bags.manifest import Manifest
from bags.mcap_scan import PROFILE
from bags.offered_qos import OfferedQos, offers_as_text

MANIFEST_RECORD = "robustnav_manifest"
MANIFEST_ATTACHMENT = "robustnav_manifest.json"
# Tools hold metadata records in memory as soon as they open a file; attachments are read when asked for.
LARGEST_MANIFEST_RECORD = 64 * 1024


@dataclass(slots=True)
class _Channel:
    topic: str
    definition: MessageDefinition
    offers: tuple[OfferedQos, ...]
    message_count: int = field(default=0)


class FileWriter:
    """Writes one MCAP file into `stream`, which it owns; it is readable without the others of its bag.

    Channels are numbered from 1 in the order in which they are added. Every method but the properties raises
    OSError where the disk fails.
    """

    def __init__(self, stream: BinaryIO, name: str, *, manifest: Manifest, chunk_bytes: int) -> None:
        self.name = name
        self.first_ns: int | None = None
        self.last_ns = 0
        self._begun_ns = manifest.wall_start_ns
        self._channels: list[_Channel] = []
        self._schema_ids: dict[str, int] = {}
        self._stream = stream
        self._mcap = McapWriter(stream, chunk_size=chunk_bytes, compression=CompressionType.ZSTD)
        self._mcap.start(profile=PROFILE, library=f"robustnav {manifest.version}".rstrip())
        self.store_manifest(manifest)

    @property
    def size_bytes(self) -> int:
        """Size so far; a chunk that is still being gathered is not in it."""
        return self._stream.tell()

    @property
    def is_closed(self) -> bool:
        """Whether it was closed, properly or not."""
        return self._stream.closed

    @property
    def row(self) -> FileRow:
        """What metadata.yaml says of this file as it is now."""
        first_ns = self._begun_ns if self.first_ns is None else self.first_ns
        return FileRow(
            name=self.name,
            start_ns=first_ns,
            duration_ns=max(0, self.last_ns - first_ns),
            message_count=sum(channel.message_count for channel in self._channels),
        )

    @property
    def topics(self) -> tuple[TopicRow, ...]:
        """What metadata.yaml says of the topics in this file as it is now."""
        return joined(
            TopicRow(
                name=channel.topic,
                type=channel.definition.type,
                offers=channel.offers,
                type_hash=channel.definition.type_hash,
                message_count=channel.message_count,
            )
            for channel in self._channels
        )

    def add_topic(self, topic: str, definition: MessageDefinition, offers: Sequence[OfferedQos]) -> int:
        """Add a topic and return its channel; the definition of its type is stored once."""
        schema_id = self._schema_ids.get(definition.type)
        if schema_id is None:
            encoding = "ros2msg" if definition.text else ""
            schema_id = self._mcap.register_schema(definition.type, encoding, definition.text.encode())
            self._schema_ids[definition.type] = schema_id
        details = {
            "offered_qos_profiles": offers_as_text(offers),
            "topic_type_hash": definition.type_hash,
        }
        self._channels.append(_Channel(topic=topic, definition=definition, offers=tuple(offers)))
        return self._mcap.register_channel(topic, "cdr", schema_id, details)

    def write(self, channel: int, *, log_time_ns: int, publish_time_ns: int, data: bytes) -> None:
        """Add a message to a channel from `add_topic`."""
        self._mcap.add_message(
            channel_id=channel, log_time=log_time_ns, publish_time=publish_time_ns, data=data
        )
        self._channels[channel - 1].message_count += 1
        self.first_ns = log_time_ns if self.first_ns is None else min(self.first_ns, log_time_ns)
        self.last_ns = max(self.last_ns, log_time_ns)

    def store_manifest(self, manifest: Manifest) -> None:
        """Store a manifest; readers take the last."""
        text = manifest.as_json()
        if len(text.encode()) <= LARGEST_MANIFEST_RECORD:
            self._mcap.add_metadata(MANIFEST_RECORD, {"json": text})
            return
        now_ns = time.time_ns()
        self._mcap.add_attachment(now_ns, now_ns, MANIFEST_ATTACHMENT, "application/json", text.encode())
        self._mcap.add_metadata(MANIFEST_RECORD, {"attachment": MANIFEST_ATTACHMENT})

    def flush(self) -> None:
        """Hand everything written so far to the operating system."""
        self._mcap.flush()

    def close(self, metadata: BagMetadata) -> None:
        """Write `metadata`, the index and the end; further calls do nothing."""
        if self._stream.closed:
            return
        try:
            self._mcap.add_metadata("rosbag2", {"serialized_metadata": metadata.as_text()})
            self._mcap.finish()
        finally:
            self._stream.close()
