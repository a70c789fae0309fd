"""The benchmark of the recorder counts each message of its load, and finds those that are missing."""

import sys
from pathlib import Path

import pytest
from nav_msgs.msg import Odometry
from rclpy.serialization import serialize_message

from bags.definitions import message_definition
from bags.manifest import Manifest
from bags.reader import open_bag
from bags.recorder_bench import _missing, measure_load
from bags.recorder_load import NUMBER, NUMBER_AT, number_of
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError


def numbered(value: int) -> bytes:
    data = bytearray(serialize_message(Odometry()))
    NUMBER.pack_into(data, NUMBER_AT, 0, value)
    return bytes(data)


def test_a_small_load_is_recorded_whole(tmp_path: Path) -> None:
    row = measure_load(tmp_path / "load", mb_per_s=10.0, messages_per_s=500.0, seconds=1.0)
    assert (row.missing, row.dropped) == (0, 0)
    assert 5.0 < row.mb_per_s < 20.0
    assert 400.0 < row.messages_per_s < 700.0
    assert row.cpu_share > 0.0
    assert 30.0 < row.rss_mb < 300.0


def test_what_is_missing_or_there_twice_is_counted(tmp_path: Path, manifest: Manifest) -> None:
    kind = message_definition("nav_msgs/msg/Odometry", (Path(sys.prefix),))
    with BagWriter(tmp_path / "bag", manifest=manifest) as writer:
        channels = [writer.add_topic(topic, kind) for topic in ("/a", "/b")]
        for at, (channel, value) in enumerate([(0, 0), (0, 2), (1, 0), (1, 1), (1, 1)]):
            writer.write(channels[channel], log_time_ns=at + 1, publish_time_ns=at + 1, data=numbered(value))
    with open_bag(tmp_path / "bag") as bag:
        assert [number_of(raw.data) for raw in bag.raw_messages(["/a"])] == [0, 2]
        assert _missing(bag, {"/a": 3, "/b": 2}) == 2
        assert _missing(bag, {"/a": 5, "/b": 2, "/c": 7}) == 11


def test_a_bag_in_the_way_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "load").mkdir()
    with pytest.raises(BadFileError, match="exists already and is not overwritten"):
        measure_load(tmp_path / "load", mb_per_s=1.0, messages_per_s=1.0, seconds=1.0)
