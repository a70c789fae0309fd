"""A bag that goes on in further files is one bag to every reader, and each file is one alone."""

import shutil
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from mcap.reader import make_reader
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from bags.bag_metadata import read_metadata
from bags.definitions import message_definition
from bags.manifest import Manifest
from bags.metrics import search_metrics
from bags.offered_qos import OfferedQos
from bags.reader import open_bag
from bags.writer import BagWriter, SplitRule
from robustnav_msgs_py.errors import BadFileError
from tests.bags.conftest import FLAT, MANIFEST, Talk, Told, write_search

NUMBER = message_definition("std_msgs/msg/UInt64", (Path(sys.prefix),))
LATCHED = OfferedQos(durability="transient_local", history="unknown", depth=0)
SECOND_NS = 1_000_000_000


def number(value: int) -> bytes:
    return b"\0\1\0\0" + value.to_bytes(8, "little")


def say(writer: BagWriter, channel: int, values: range) -> None:
    """Numbers, one each second."""
    for value in values:
        now_ns = 1000 * SECOND_NS + value * SECOND_NS
        writer.write(channel, log_time_ns=now_ns, publish_time_ns=now_ns, data=number(value))


def numbers(path: Path, topic: str = "/a") -> list[int]:
    with open_bag(path) as bag:
        return [recorded.message.data for recorded in bag.messages([topic])]


def test_a_bag_is_split_by_time_and_is_one_bag_to_every_reader(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "bag", manifest=manifest, split=SplitRule(duration_s=10.0)) as writer:
        say(writer, writer.add_topic("/a", NUMBER), range(25))
        late = writer.add_topic("/late", NUMBER)
        say(writer, late, range(25, 35))
    metadata = read_metadata(tmp_path / "bag")
    assert [(row.name, row.message_count, row.duration_ns) for row in metadata.files] == [
        ("bag_0.mcap", 10, 9 * SECOND_NS),
        ("bag_1.mcap", 10, 9 * SECOND_NS),
        ("bag_2.mcap", 10, 9 * SECOND_NS),
        ("bag_3.mcap", 5, 4 * SECOND_NS),
    ]
    assert {row.name: row.message_count for row in metadata.topics} == {"/a": 25, "/late": 10}
    assert numbers(tmp_path / "bag") == list(range(25))
    assert numbers(tmp_path / "bag", "/late") == list(range(25, 35))
    with Reader(tmp_path / "bag") as reader:
        assert [data for _, _, data in reader.messages()] == [number(value) for value in range(35)]
        assert reader.message_count == 35


def test_a_bag_is_split_by_size(tmp_path: Path, manifest: Manifest) -> None:
    rule, chunk_bytes = SplitRule(size_bytes=20_000), 1024
    with BagWriter(tmp_path / "bag", manifest=manifest, chunk_bytes=chunk_bytes, split=rule) as writer:
        say(writer, writer.add_topic("/a", NUMBER), range(3000))
    sizes = [(tmp_path / "bag" / row.name).stat().st_size for row in read_metadata(tmp_path / "bag").files]
    assert len(sizes) > 2
    assert all(20_000 <= size < 30_000 for size in sizes[:-1])  # the index comes on top
    assert numbers(tmp_path / "bag") == list(range(3000))


def test_each_file_is_readable_alone(tmp_path: Path, manifest: Manifest) -> None:
    fuller = replace(manifest, scene="a home that was named later")
    with BagWriter(tmp_path / "bag", manifest=manifest, split=SplitRule(duration_s=10.0)) as writer:
        say(writer, writer.add_topic("/a", NUMBER), range(15))
        writer.update_manifest(fuller)
        say(writer, 1, range(15, 25))
    files = sorted((tmp_path / "bag").glob("*.mcap"))
    assert len(files) == 3
    for index, file in enumerate(files):
        alone = tmp_path / "alone" / f"{index}.mcap"
        alone.parent.mkdir(exist_ok=True)
        shutil.copy(file, alone)
        expected = list(range(10 * index, min(10 * index + 10, 25)))
        with open_bag(alone) as bag:
            assert bag.cut == ""
            assert bag.manifest == (fuller if index else manifest)
        assert numbers(alone) == expected
        with AnyReader([alone]) as reader:
            assert reader.message_count == len(expected)
            found = [reader.deserialize(data, row.msgtype).data for row, _, data in reader.messages()]
        assert found == expected
        with alone.open("rb") as stream:
            (inside,) = [row for row in make_reader(stream).iter_metadata() if row.name == "rosbag2"]
        assert f"message_count: {len(expected)}" in inside.metadata["serialized_metadata"]


def test_latched_messages_are_repeated_where_that_is_wanted(tmp_path: Path, manifest: Manifest) -> None:
    rule = SplitRule(duration_s=10.0, repeat_latched=True)
    with BagWriter(tmp_path / "bag", manifest=manifest, split=rule) as writer:
        channel = writer.add_topic("/a", NUMBER)
        latched = writer.add_topic("/map", NUMBER, [LATCHED])
        writer.add_topic("/silent", NUMBER, [LATCHED])
        for version in (7, 8):
            published_ns = 1000 * SECOND_NS + version
            writer.write(
                latched, log_time_ns=published_ns, publish_time_ns=published_ns, data=number(version)
            )
        say(writer, channel, range(1, 25))
    for index in (1, 2):
        file = tmp_path / "bag" / f"bag_{index}.mcap"
        with open_bag(file) as bag:
            (repeated,) = bag.messages(["/map"])
            assert bag.span_ns is not None
            assert repeated.log_time_ns == bag.span_ns[0]  # its time in the file is the split's
        assert (repeated.message.data, repeated.publish_time_ns) == (8, 1000 * SECOND_NS + 8)
    with open_bag(tmp_path / "bag") as bag:
        assert {row.name: row.message_count for row in bag.topics} == {"/a": 24, "/map": 4, "/silent": 0}
        times = [raw.log_time_ns for raw in bag.raw_messages()]
    assert times == sorted(times)


def test_nothing_is_repeated_unless_that_is_wanted(search_bag: Callable[..., Path], tmp_path: Path) -> None:
    with BagWriter(tmp_path / "split", manifest=MANIFEST, split=SplitRule(duration_s=3.0)) as writer:
        write_search(Talk(writer), FLAT, Told())
    assert len(read_metadata(tmp_path / "split").files) > 3
    with open_bag(search_bag()) as whole, open_bag(tmp_path / "split") as split:
        assert split.topics == whole.topics
        said = [[(raw.topic, raw.log_time_ns) for raw in bag.raw_messages()] for bag in (split, whole)]
        assert said[0] == said[1]
        assert search_metrics(split) == search_metrics(whole)


def test_a_file_without_messages_is_not_split_off(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "bag", manifest=manifest) as writer:
        assert not writer.split()
        say(writer, writer.add_topic("/a", NUMBER), range(3))
        assert writer.split()
        assert not writer.split()
        assert writer.path == tmp_path / "bag" / "bag_1.mcap"
    assert [row.message_count for row in read_metadata(tmp_path / "bag").files] == [3, 0]
    assert numbers(tmp_path / "bag") == [0, 1, 2]
    with Reader(tmp_path / "bag") as reader:
        assert (reader.message_count, reader.start_time) == (3, 1000 * SECOND_NS)


@pytest.mark.parametrize("flushed", [True, False])
def test_a_split_bag_that_was_killed_is_gone_on_with(
    tmp_path: Path, manifest: Manifest, flushed: bool
) -> None:
    rule = SplitRule(duration_s=10.0)
    writer = BagWriter(tmp_path / "alive" / "bag", manifest=manifest, split=rule)
    say(writer, writer.add_topic("/a", NUMBER), range(25))
    if flushed:
        writer.flush()
    shutil.copytree(writer.folder, tmp_path / "bag")
    writer.close()
    kept = 25 if flushed else 20
    assert numbers(tmp_path / "bag") == list(range(kept))
    with BagWriter(tmp_path / "bag", manifest=manifest, resume=True, split=rule) as after:
        say(after, after.add_topic("/a", NUMBER), range(kept, 45))
    assert numbers(tmp_path / "bag") == list(range(45))
    files = read_metadata(tmp_path / "bag").files
    assert [row.name for row in files] == [f"bag_{index}.mcap" for index in range(len(files))]
    assert sum(row.message_count for row in files) == 45
    with open_bag(tmp_path / "bag") as bag:
        assert bag.cut == ""


def test_a_file_in_the_way_of_the_next_one_is_not_overwritten(tmp_path: Path, manifest: Manifest) -> None:
    writer = BagWriter(tmp_path / "bag", manifest=manifest)
    say(writer, writer.add_topic("/a", NUMBER), range(3))
    (tmp_path / "bag" / "bag_1.mcap").write_text("precious")
    with pytest.raises(BadFileError, match=r"bag_1\.mcap exists already and is not overwritten"):
        writer.split()
    writer.close()
    assert (tmp_path / "bag" / "bag_1.mcap").read_text() == "precious"
    assert numbers(tmp_path / "bag") == [0, 1, 2]
