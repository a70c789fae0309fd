import shutil
import sys
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from bags.bag_metadata import read_metadata
from bags.definitions import message_definition
from bags.earlier_files import EarlierFiles
from bags.manifest import Manifest
from bags.reader import open_bag
from bags.recording import Recording
from bags.writer import BagWriter

NUMBER = message_definition("std_msgs/msg/UInt64", (Path(sys.prefix),))
WAIT_S = 20.0


def number(value: int) -> bytes:
    return b"\0\1\0\0" + value.to_bytes(8, "little")


class SlowWriter(BagWriter):
    """A writer whose disk stands still until `go` is set, and fails from message `fails_at` on."""

    def __init__(
        self, folder: Path, *, manifest: Manifest, fails_at: int | None = None, resume: bool = False
    ) -> None:
        super().__init__(folder, manifest=manifest, resume=resume)
        self._resume = resume
        self.go = threading.Event()
        self.began = threading.Event()
        self._fails_at = fails_at
        self._written = 0

    def join_earlier_files(self) -> EarlierFiles:
        if self._resume:
            self.go.wait(WAIT_S)
        return super().join_earlier_files()

    def write(self, channel: int, **message: Any) -> None:
        self.began.set()
        self.go.wait(WAIT_S)
        if self._written == self._fails_at:
            raise OSError(28, "No space left on device")
        super().write(channel, **message)
        self._written += 1


@pytest.fixture
def writer(tmp_path: Path, manifest: Manifest) -> SlowWriter:
    return SlowWriter(tmp_path / "bag", manifest=manifest)


def test_everything_taken_before_the_end_is_in_the_bag(writer: SlowWriter) -> None:
    recording = Recording(writer, queue_bytes=10**6, flush_period_s=1.0)
    channels = [recording.add_topic(f"/{name}", NUMBER) for name in "ab"]
    for value in range(1000):
        assert recording.put(channels[value % 2], value + 1, number(value))
    recording.finish()
    assert not recording.put(channels[0], 2000, number(2000))
    assert not recording.wait(0.0)
    writer.go.set()
    assert recording.wait(WAIT_S)
    with open_bag(writer.folder) as bag:
        assert [recorded.message.data for recorded in bag.messages()] == list(range(1000))
        assert bag.cut == ""
    told = [(count.topic, count.messages, count.size_bytes, count.dropped) for count in recording.counts()]
    assert told == [("/a", 500, 6000, 1), ("/b", 500, 6000, 0)]


def test_what_does_not_fit_the_queue_is_dropped_and_counted(writer: SlowWriter) -> None:
    recording = Recording(writer, queue_bytes=12 * 100, flush_period_s=1.0)
    channel = recording.add_topic("/a", NUMBER)
    taken = [value for value in range(250) if recording.put(channel, value + 1, number(value))]
    assert taken == list(range(100))
    writer.go.set()
    recording.finish()
    assert recording.wait(WAIT_S)
    (count,) = recording.counts()
    assert (count.messages, count.dropped) == (100, 150)
    assert recording.waiting_bytes == 0
    with open_bag(writer.folder) as bag:
        assert [recorded.message.data for recorded in bag.messages()] == taken


def test_what_is_written_is_no_longer_held(tmp_path: Path, manifest: Manifest) -> None:
    """Or a recorder that is behind would hold what it writes beside a queue that is full again."""
    said = [number(value) for value in range(10)]
    unheld = sys.getrefcount(said[0])
    references: list[int] = []

    class Watched(SlowWriter):
        """A writer that looks who holds the first message."""

        def write(self, channel: int, **message: Any) -> None:
            super().write(channel, **message)
            references.append(sys.getrefcount(said[0]))

    writer = Watched(tmp_path / "bag", manifest=manifest)
    recording = Recording(writer, queue_bytes=10**6, flush_period_s=1.0)
    channel = recording.add_topic("/a", NUMBER)
    for at, data in enumerate(said):
        recording.put(channel, at + 1, data)
    writer.go.set()
    recording.finish()
    assert recording.wait(WAIT_S)
    assert references[0] > unheld
    assert references[2:] == [unheld] * 8  # one more is in hand


def test_a_full_disk_is_said_and_all_that_is_missing_is_counted(tmp_path: Path, manifest: Manifest) -> None:
    writer = SlowWriter(tmp_path / "bag", manifest=manifest, fails_at=10)
    writer.go.set()
    recording = Recording(writer, queue_bytes=10**6, flush_period_s=0.1)
    channel = recording.add_topic("/a", NUMBER)
    for value in range(30):
        recording.put(channel, value + 1, number(value))
    recording.finish()
    assert recording.wait(WAIT_S)
    assert "cannot be written any more: No space left on device" in recording.failure
    (count,) = recording.counts()
    assert (count.messages, count.dropped) == (10, 20)
    with open_bag(writer.folder) as bag:
        assert [recorded.message.data for recorded in bag.messages()] == list(range(10))


def test_a_split_stands_where_it_was_asked_for(writer: SlowWriter) -> None:
    recording = Recording(writer, queue_bytes=10**6, flush_period_s=0.1)
    channel = recording.add_topic("/a", NUMBER)
    for value in range(100):
        if value in (30, 80):
            assert recording.split()
        assert recording.put(channel, value + 1, number(value))
    writer.go.set()
    recording.finish()
    assert not recording.split()
    assert recording.wait(WAIT_S)
    assert [row.message_count for row in read_metadata(writer.folder).files] == [30, 50, 20]
    with open_bag(writer.folder) as bag:
        assert [recorded.message.data for recorded in bag.messages()] == list(range(100))


def test_a_topic_without_messages_is_not_lost(writer: SlowWriter) -> None:
    writer.go.set()
    recording = Recording(writer, queue_bytes=10**6, flush_period_s=0.1)
    recording.add_topic("/quiet", NUMBER)
    recording.finish()
    assert recording.wait(WAIT_S)
    with open_bag(writer.folder) as bag:
        assert [(row.name, row.message_count) for row in bag.topics] == [("/quiet", 0)]


def test_the_manifest_of_a_recording_can_grow(writer: SlowWriter, manifest: Manifest) -> None:
    recording = Recording(writer, queue_bytes=10**6, flush_period_s=0.1)
    for seed in (1, 2, 3):
        recording.update_manifest(replace(manifest, seed=seed))
    recording.finish()
    assert recording.wait(WAIT_S)
    with open_bag(writer.folder) as bag:
        assert bag.manifest == replace(manifest, seed=3)


def test_what_is_heard_while_an_earlier_file_is_repaired_is_in_the_bag(
    tmp_path: Path, manifest: Manifest
) -> None:
    killed = BagWriter(tmp_path / "alive" / "bag", manifest=manifest)
    channel = killed.add_topic("/a", NUMBER)
    killed.write(channel, log_time_ns=1, publish_time_ns=1, data=number(0))
    killed.flush()
    shutil.copytree(killed.folder, tmp_path / "bag")
    killed.close()
    writer = SlowWriter(tmp_path / "bag", manifest=manifest, resume=True)
    recording = Recording(writer, queue_bytes=10**6, flush_period_s=0.1)
    channel = recording.add_topic("/a", NUMBER)
    assert all(recording.put(channel, value + 1, number(value)) for value in range(1, 100))
    assert recording.earlier is None
    writer.go.set()
    recording.finish()
    assert recording.wait(WAIT_S)
    assert recording.earlier is not None
    assert len(recording.earlier.repairs) == 1
    with open_bag(tmp_path / "bag") as bag:
        assert [recorded.message.data for recorded in bag.messages()] == list(range(100))
        assert bag.cut == ""
