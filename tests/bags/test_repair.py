"""A repaired file holds all that was whole before, and every reader takes it."""

import errno
import io
import os
import random
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from rosbags.rosbag2 import Reader

from bags.definitions import message_definition
from bags.file_writer import LARGEST_MANIFEST_RECORD
from bags.manifest import Manifest, NamedParameter, NodeParameters
from bags.mcap_scan import MAGIC, whole_records
from bags.reader import RawMessage, open_bag
from bags.repair import repair_file
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError

PREFIXES = (Path(sys.prefix),)
COUNT = 200
TOPICS = ("/a", "/b", "/c")


def number(value: int) -> bytes:
    return b"\0\1\0\0" + value.to_bytes(8, "little")


@pytest.fixture(scope="module")
def large_manifest(manifest: Manifest) -> Manifest:
    """So large that it is stored as an attachment."""
    value = "x" * LARGEST_MANIFEST_RECORD
    return manifest.with_node(NodeParameters(node="/a", parameters=(NamedParameter(name="a", value=value),)))


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory, large_manifest: Manifest) -> bytes:
    """A closed file of many chunks, whose topics appear one after the other."""
    folder = tmp_path_factory.mktemp("whole") / "numbers"
    with BagWriter(folder, manifest=large_manifest, chunk_bytes=1024) as writer:
        channels = []
        for value in range(COUNT):
            if value % 50 == 0 and len(channels) < len(TOPICS):
                kind = message_definition("std_msgs/msg/UInt64", PREFIXES)
                channels.append(writer.add_topic(TOPICS[len(channels)], kind))
            writer.write(
                channels[value % len(channels)],
                log_time_ns=value + 1,
                publish_time_ns=value,
                data=number(value),
            )
    return writer.path.read_bytes()


def positions(content: bytes, ends: list[int]) -> Iterator[int]:
    """Lengths at which to cut: near the begin and the end, at the end of each chunk, and some between."""
    size = len(content)
    yield from range(len(MAGIC), 60)
    yield from (end + offset for end in ends for offset in (-1, 0, 1))
    yield from sorted(random.Random(5).sample(range(60, size - 60), 60))
    yield from range(size - 60, size)


def messages(path: Path) -> list[RawMessage]:
    with open_bag(path) as bag:
        return list(bag.raw_messages())


def chunk_starts(path: Path) -> list[int]:
    with path.open("rb") as stream:
        return [whole.start for whole in whole_records(stream) if whole.contents is not None]


def chunk_ends(content: bytes) -> list[tuple[int, int]]:
    """Where each chunk ends, and the number of messages until then, as mcap tells it."""
    summary = make_reader(io.BytesIO(content)).get_summary()
    assert summary is not None
    return [
        (index.chunk_start_offset + index.chunk_length, index.message_end_time)
        for index in summary.chunk_indexes
    ]


def assert_every_reader_agrees(path: Path) -> None:
    told = messages(path)
    with Reader(path) as reader:
        assert reader.message_count == len(told)
        read = [(connection.topic, time, data) for connection, time, data in reader.messages()]
    assert sorted(read) == sorted((raw.topic, raw.log_time_ns, raw.data) for raw in told)
    with path.open("rb") as stream:
        found = [(channel.topic, item.data) for _, channel, item in make_reader(stream).iter_messages()]
    assert found == [(raw.topic, raw.data) for raw in told]


def test_a_file_cut_anywhere_is_repaired_and_loses_nothing_that_was_whole(
    content: bytes, tmp_path: Path, large_manifest: Manifest
) -> None:
    path = tmp_path / "cut.mcap"
    ends = chunk_ends(content)
    for size in positions(content, [end for end, _ in ends]):
        path.write_bytes(content[:size])
        with open_bag(path) as bag:
            assert bag.cut
            topics, manifest = bag.topics, bag.manifest
        before = messages(path)
        assert len(before) == max((count for end, count in ends if end <= size), default=0)
        report = repair_file(path)
        assert messages(path) == before
        with open_bag(path) as bag:
            assert (bag.cut, bag.topics, bag.manifest) == ("", topics, manifest)
        assert (report.messages, report.topics, report.damaged_chunks) == (len(before), len(topics), 0)
        assert_every_reader_agrees(path)
        repaired = path.read_bytes()
        assert repair_file(path).lost_bytes == 0
        assert path.read_bytes() == repaired
    assert len(before) == COUNT
    assert manifest == large_manifest
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("size", range(len(MAGIC)))
def test_a_file_cut_before_its_first_record_becomes_an_empty_one(
    content: bytes, tmp_path: Path, size: int
) -> None:
    path = tmp_path / "cut.mcap"
    path.write_bytes(content[:size])
    assert repair_file(path).messages == 0
    with open_bag(path) as bag:
        assert (bag.cut, bag.span_ns) == ("", None)


def test_a_damaged_chunk_is_left_out_and_the_others_are_kept(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "damaged.mcap"
    path.write_bytes(content)
    whole = messages(path)
    starts = chunk_starts(path)
    for start in (starts[0], starts[len(starts) // 2]):  # the first holds the definitions
        path.write_bytes(content[: start + 60] + bytes([content[start + 60] ^ 0xFF]) + content[start + 61 :])
        report = repair_file(path)
        assert (report.damaged_chunks, report.lost_messages) == (1, 0)
        kept = messages(path)
        assert kept == [raw for raw in whole if raw in kept]
        assert 0.8 * COUNT < len(kept) == report.messages < COUNT
        assert_every_reader_agrees(path)


def test_messages_that_nothing_defines_are_left_out(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "damaged.mcap"
    path.write_bytes(content)
    second = next(
        whole.start
        for whole in whole_records(path.open("rb"))
        if whole.contents is not None and any(channel.topic == "/b" for channel in whole.contents.channels)
    )
    wrong = bytes([content[second + 60] ^ 0xFF])
    path.write_bytes(content[: second + 60] + wrong + content[second + 61 : -100])
    report = repair_file(path)
    assert report.lost_messages > 0
    assert {raw.topic for raw in messages(path)} == {"/a", "/c"}
    assert len(messages(path)) == report.messages
    assert_every_reader_agrees(path)
    assert "of topics that nothing defines" in report.sentence


def test_a_file_without_chunks_is_repaired(tmp_path: Path) -> None:
    path = tmp_path / "loose.mcap"
    with path.open("wb") as stream:
        writer = Writer(stream, use_chunking=False)
        writer.start(profile="ros2")
        kind = message_definition("std_msgs/msg/UInt64", PREFIXES)
        channel = writer.register_channel(
            "/a", "cdr", writer.register_schema(kind.type, "ros2msg", b"uint64 data\n")
        )
        for value in range(COUNT):
            writer.add_message(channel, log_time=value + 1, data=number(value), publish_time=value)
        writer.flush()
        stream.truncate(stream.tell() - 5)
    repair_file(path)
    assert [raw.data for raw in messages(path)] == [number(value) for value in range(COUNT - 1)]
    assert_every_reader_agrees(path)


def test_what_is_no_mcap_file_is_refused_and_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    path.write_bytes(b"SQLite format 3\0")
    with pytest.raises(BadFileError, match="not an MCAP file"):
        repair_file(path)
    assert [file.read_bytes() for file in tmp_path.iterdir()] == [b"SQLite format 3\0"]
    with pytest.raises(BadFileError, match="cannot be opened"):
        repair_file(tmp_path / "nowhere.mcap")


def test_a_disk_that_fails_leaves_the_file_as_it_was(
    content: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    path = tmp_path / "cut.mcap"
    path.write_bytes(content[:-50])
    monkeypatch.setattr(os, "fsync", fail)
    with pytest.raises(OSError, match="No space left"):
        repair_file(path)
    assert [file.read_bytes() for file in tmp_path.iterdir()] == [content[:-50]]
