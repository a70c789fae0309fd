"""Bags that other tools wrote: rosbags, other compressions, files without chunks or without an index."""

from pathlib import Path

import pytest
from mcap.writer import CompressionType, IndexType, Writer
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as RosbagsWriter
from rosbags.typesys import Stores, get_typestore

from bags.definitions import message_definition
from bags.reader import open_bag
from robustnav_msgs_py.errors import BadFileError

COUNT = 100
DEFINITION = message_definition("std_msgs/msg/UInt64", ())


def number(value: int) -> bytes:
    return b"\0\1\0\0" + value.to_bytes(8, "little")


def write_mcap(path: Path, encoding: str = "cdr", **options: object) -> None:
    with path.open("wb") as stream:
        writer = Writer(stream, chunk_size=500, **options)
        writer.start(profile="ros2")
        schema = writer.register_schema(DEFINITION.type, "ros2msg", DEFINITION.text.encode())
        channel = writer.register_channel("/a", encoding, schema)
        for value in range(COUNT):
            writer.add_message(channel, log_time=value + 1, data=number(value), publish_time=value)
        writer.finish()


def numbers(path: Path) -> list[int]:
    with open_bag(path) as bag:
        return [recorded.message.data for recorded in bag.messages(["/a"])]


def test_a_bag_of_rosbags_is_read_with_its_qos(tmp_path: Path) -> None:
    types = get_typestore(Stores.ROS2_JAZZY)
    with RosbagsWriter(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        channel = writer.add_connection("/a", DEFINITION.type, typestore=types)
        for value in range(COUNT):
            writer.write(channel, value + 1, number(value))
    assert numbers(tmp_path / "bag") == list(range(COUNT))
    with open_bag(tmp_path / "bag") as bag:
        assert bag.cut == ""
        assert bag.manifest is None
        assert [(row.name, row.message_count) for row in bag.topics] == [("/a", COUNT)]


@pytest.mark.parametrize("compression", list(CompressionType))
def test_every_compression_is_read(tmp_path: Path, compression: CompressionType) -> None:
    write_mcap(tmp_path / "a.mcap", compression=compression)
    assert numbers(tmp_path / "a.mcap") == list(range(COUNT))


@pytest.mark.parametrize(
    "options",
    [
        {"use_chunking": False},
        {"index_types": IndexType.NONE},
        {"use_statistics": False},
        {"repeat_channels": False, "repeat_schemas": False},
        {
            "use_statistics": False,
            "repeat_channels": False,
            "repeat_schemas": False,
            "index_types": IndexType.NONE,
        },
        {"enable_crcs": False},
    ],
)
def test_a_file_with_less_in_it_is_read_and_is_not_called_cut(
    tmp_path: Path, options: dict[str, object]
) -> None:
    write_mcap(tmp_path / "a.mcap", **options)
    assert numbers(tmp_path / "a.mcap") == list(range(COUNT))
    with open_bag(tmp_path / "a.mcap") as bag:
        assert bag.cut == ""
        assert bag.span_ns == (1, COUNT)
        assert [row.message_count for row in bag.topics] == [COUNT]
        assert [raw.log_time_ns for raw in bag.raw_messages(start_ns=10, stop_ns=13)] == [10, 11, 12]


def test_a_file_without_chunks_can_be_cut(tmp_path: Path) -> None:
    write_mcap(tmp_path / "a.mcap", use_chunking=False)
    content = (tmp_path / "a.mcap").read_bytes()
    (tmp_path / "a.mcap").write_bytes(content[: len(content) // 3])
    kept = numbers(tmp_path / "a.mcap")
    assert kept == list(range(len(kept)))
    assert 10 < len(kept) < COUNT


def test_what_is_not_of_ros_2_is_refused(tmp_path: Path) -> None:
    write_mcap(tmp_path / "a.mcap", encoding="json")
    with pytest.raises(BadFileError, match="holds '/a' as 'json', not as cdr"):
        open_bag(tmp_path / "a.mcap")
