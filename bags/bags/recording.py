"""A recording in progress: messages go into a bounded queue, a thread of its own writes them to the bag."""

import threading
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

from bags.definitions import MessageDefinition
from bags.earlier_files import EarlierFiles
from bags.manifest import Manifest
from bags.offered_qos import OfferedQos
from bags.writer import BagWriter
from robustnav_msgs_py.errors import RobustnavError

# How long messages are gathered: a thread that wakes for each one costs more than writing it.
GATHER_S = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicCount:
    """What became of a topic's messages: `messages` were taken (`size_bytes` in all), `dropped` were not."""

    topic: str
    type: str
    messages: int
    size_bytes: int
    dropped: int


@dataclass(slots=True)
class _Channel:
    topic: str
    definition: MessageDefinition
    offers: tuple[OfferedQos, ...]
    messages: int = 0
    size_bytes: int = 0
    dropped: int = 0


@dataclass(frozen=True, slots=True)
class _Message:
    channel: int
    log_time_ns: int
    data: bytes


class _Split:
    """Stands in the queue where the bag is to go on in its next file."""


class Recording:
    """Writes one bag from a thread of its own, so that whoever hears messages never waits for the disk.

    `add_topic`, `put`, `split`, `update_manifest` and `finish` belong to the thread that hears; they never
    wait. At most `queue_bytes` wait to be written: what comes while the queue is full is dropped and counted,
    per topic. The bag is flushed every `flush_period_s`. When the disk fails, `failure` holds the sentence
    and everything from then on counts as dropped.

    A bag that is gone on with is repaired first, in that thread: what is heard meanwhile waits in the queue,
    and `earlier` is None until it is done.
    """

    def __init__(self, writer: BagWriter, *, queue_bytes: int, flush_period_s: float) -> None:
        self.folder = writer.folder
        self.failure = ""
        self.earlier: EarlierFiles | None = None
        self._writer = writer
        self._queue_bytes = queue_bytes
        self._flush_period_s = flush_period_s
        self._channels: list[_Channel] = []
        self._written_channels: list[int] = []
        self._waiting: deque[_Message | _Split] = deque()
        self._waiting_bytes = 0
        self._finishing = False
        self._manifest: Manifest | None = None
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name=f"recording {self.folder.name}", daemon=True)
        self._thread.start()

    @property
    def waiting_bytes(self) -> int:
        """Bytes that are heard but not yet written."""
        return self._waiting_bytes

    @property
    def finished(self) -> bool:
        """Whether the bag is closed."""
        return not self._thread.is_alive()

    def add_topic(self, topic: str, definition: MessageDefinition, offers: Sequence[OfferedQos] = ()) -> int:
        """Add a topic and return the channel to `put` its messages in."""
        with self._changed:
            self._channels.append(_Channel(topic=topic, definition=definition, offers=tuple(offers)))
            return len(self._channels) - 1

    def put(self, channel: int, log_time_ns: int, data: bytes) -> bool:
        """Take a message, or return False where it had to be dropped."""
        with self._changed:
            counted = self._channels[channel]
            full = self._waiting_bytes + len(data) > self._queue_bytes
            if full or self._finishing or self.failure:
                counted.dropped += 1
                return False
            counted.messages += 1
            counted.size_bytes += len(data)
            self._waiting.append(_Message(channel, log_time_ns, data))
            self._waiting_bytes += len(data)
            return True

    def split(self) -> bool:
        """Go on in the next file after what was put until now; False where nothing is written any more."""
        with self._changed:
            if self._finishing or self.failure:
                return False
            self._waiting.append(_Split())
            return True

    def update_manifest(self, manifest: Manifest) -> None:
        """Have a manifest stored that knows more than the last one."""
        with self._changed:
            self._manifest = manifest

    def finish(self) -> None:
        """Take no more messages; what is waiting is still written, and the bag is closed."""
        with self._changed:
            self._finishing = True
            self._changed.notify()

    def wait(self, limit_s: float) -> bool:
        """Wait until the bag is closed after `finish()`; False where it is not within `limit_s`."""
        self._thread.join(limit_s)
        return self.finished

    def counts(self) -> tuple[TopicCount, ...]:
        """What became of the messages of each topic so far."""
        with self._changed:
            return tuple(
                TopicCount(
                    topic=channel.topic,
                    type=channel.definition.type,
                    messages=channel.messages,
                    size_bytes=channel.size_bytes,
                    dropped=channel.dropped,
                )
                for channel in self._channels
            )

    def _run(self) -> None:
        try:
            self.earlier = self._writer.join_earlier_files()
        except Exception as error:
            self._fail(error)
        flushed_s = time.monotonic()
        finishing = False
        while not finishing:
            with self._changed:
                if not self._finishing:
                    self._changed.wait(GATHER_S)
                finishing = self._finishing
                batch, self._waiting = self._waiting, deque()
                manifest, self._manifest = self._manifest, None
            try:
                if manifest is not None:
                    self._writer.update_manifest(manifest)
                self._write(batch)
                if not self.failure and time.monotonic() - flushed_s >= self._flush_period_s:
                    self._writer.flush()
                    flushed_s = time.monotonic()
            except Exception as error:  # the run goes on without its bag, and says so
                self._fail(error)
        try:
            self._writer.close()
        except Exception as error:
            self._fail(error)

    def _write(self, batch: deque[_Message | _Split]) -> None:
        """Write `batch` and take from it what is written, so that its memory is free at once."""
        self._add_new_topics()
        while batch:
            if self.failure:
                self._give_up(batch)
                return
            try:
                self._write_one(batch[0])
            except Exception:
                self._give_up(batch)
                raise
            written = batch.popleft()
            if isinstance(written, _Message):
                with self._changed:
                    self._waiting_bytes -= len(written.data)

    def _write_one(self, message: _Message | _Split) -> None:
        if isinstance(message, _Split):
            self._writer.split()
            return
        self._writer.write(
            self._written_channels[message.channel],
            log_time_ns=message.log_time_ns,
            publish_time_ns=message.log_time_ns,
            data=message.data,
        )

    def _add_new_topics(self) -> None:
        while len(self._written_channels) < len(self._channels):
            added = self._channels[len(self._written_channels)]
            self._written_channels.append(self._writer.add_topic(added.topic, added.definition, added.offers))

    def _give_up(self, batch: deque[_Message | _Split]) -> None:
        with self._changed:
            while batch:
                message = batch.popleft()
                if isinstance(message, _Split):
                    continue
                channel = self._channels[message.channel]
                channel.messages -= 1
                channel.size_bytes -= len(message.data)
                channel.dropped += 1
                self._waiting_bytes -= len(message.data)

    def _fail(self, error: Exception) -> None:
        if isinstance(error, OSError):
            reason = error.strerror or repr(error)
        else:
            reason = str(error) if isinstance(error, RobustnavError) else repr(error)
        self.failure = self.failure or (
            f"the bag {self.folder} cannot be written any more: {reason}; what was flushed before is kept"
        )
