"""What the writer writes is read back, value by value, by this reader and by two that others wrote."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from rclpy.serialization import serialize_message
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import Reader

from bags.bag_metadata import read_metadata
from bags.definitions import message_definition
from bags.file_writer import LARGEST_MANIFEST_RECORD
from bags.manifest import Manifest, NamedParameter, NodeParameters
from bags.offered_qos import OfferedQos
from bags.reader import open_bag
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.graph.message_class import message_class
from tests.bags.filled_messages import TYPES, filled

PREFIXES = (Path(sys.prefix),)
LATCHED = OfferedQos(durability="transient_local", history="unknown", depth=0)


def differences(written: Any, read: Any, where: str = "message") -> list[str]:
    """Where `read`, a message that some library decoded, is not `written`, a message of rclpy."""
    if hasattr(written, "get_fields_and_field_types"):
        names = written.get_fields_and_field_types()
        return [
            d
            for name in names
            for d in differences(getattr(written, name), getattr(read, name), f"{where}.{name}")
        ]
    if isinstance(written, bytes):  # of type `byte`, which some libraries read as a signed number
        number = read[0] if isinstance(read, bytes) else int(read) % 256
        return [] if number == written[0] else [f"{where}: {read!r} is not {written!r}"]
    if hasattr(written, "__len__") and not isinstance(written, str):
        if len(written) != len(read):
            return [f"{where}: {len(read)} items are not {len(written)}"]
        pairs = zip(written, read, strict=True)
        return [d for number, pair in enumerate(pairs) for d in differences(*pair, f"{where}[{number}]")]
    return [] if read == written else [f"{where}: {read!r} is not {written!r}"]


def assert_equal(written: list[tuple[str, Any]], read: list[tuple[str, Any]]) -> None:
    assert [kind for kind, _ in read] == [kind for kind, _ in written]
    for (kind, message), (_, decoded) in zip(written, read, strict=True):
        assert differences(message, decoded, kind) == []


def write(folder: Path, manifest: Manifest, messages: Sequence[tuple[str, Any]]) -> None:
    """Write (type, message) pairs, a topic for each type, ten milliseconds apart."""
    with BagWriter(folder, manifest=manifest, chunk_bytes=2000) as writer:
        channels = {
            kind: writer.add_topic(f"/{kind}", message_definition(kind, PREFIXES), [OfferedQos(), LATCHED])
            for kind in dict.fromkeys(kind for kind, _ in messages)
        }
        for number, (kind, message) in enumerate(messages):
            now_ns = manifest.wall_start_ns + number * 10_000_000
            writer.write(
                channels[kind],
                log_time_ns=now_ns,
                publish_time_ns=now_ns - 5,
                data=serialize_message(message),
            )


@pytest.fixture(scope="module")
def written(
    tmp_path_factory: pytest.TempPathFactory, manifest: Manifest
) -> tuple[Path, list[tuple[str, Any]]]:
    rng = np.random.default_rng(1)
    messages = [(kind, filled(message_class(kind), rng)) for _ in range(5) for kind in TYPES]
    folder = tmp_path_factory.mktemp("bags") / "every_type"
    write(folder, manifest, messages)
    return folder, messages


def test_our_reader_gives_back_what_was_written(written: tuple[Path, list[tuple[str, Any]]]) -> None:
    folder, messages = written
    with open_bag(folder) as bag:
        found = [(recorded.type, recorded.message) for recorded in bag.messages()]
        assert bag.cut == ""
    assert_equal(messages, found)


def test_rosbags_gives_back_what_was_written(written: tuple[Path, list[tuple[str, Any]]]) -> None:
    folder, messages = written
    with AnyReader([folder]) as reader:
        found = [
            (connection.msgtype, reader.deserialize(data, connection.msgtype))
            for connection, _, data in reader.messages()
        ]
    assert_equal(messages, found)


def test_mcap_gives_back_what_was_written(written: tuple[Path, list[tuple[str, Any]]]) -> None:
    mcap_ros2 = pytest.importorskip("mcap_ros2.reader")
    folder, messages = written
    found = [
        (item.schema.name, item.ros_msg)
        for item in mcap_ros2.read_ros2_messages(str(folder / "every_type_0.mcap"))
    ]
    assert_equal(messages, found)


def test_rosbags_takes_the_metadata(written: tuple[Path, list[tuple[str, Any]]], manifest: Manifest) -> None:
    folder, messages = written
    with Reader(folder) as reader:
        assert reader.message_count == len(messages)
        assert reader.start_time == manifest.wall_start_ns
        assert reader.duration == (len(messages) - 1) * 10_000_000 + 1
        for connection in reader.connections:
            assert connection.msgcount == 5
            assert connection.digest == message_definition(connection.msgtype, PREFIXES).type_hash
            first, second = connection.ext.offered_qos_profiles
            assert (first.durability.name, second.durability.name) == ("VOLATILE", "TRANSIENT_LOCAL")


def test_the_file_alone_is_a_bag_too(written: tuple[Path, list[tuple[str, Any]]], manifest: Manifest) -> None:
    folder, messages = written
    with open_bag(folder / "every_type_0.mcap") as bag:
        assert sum(1 for _ in bag.raw_messages()) == len(messages)
        assert bag.manifest == manifest
    with Reader(folder / "every_type_0.mcap") as reader:
        assert reader.message_count == len(messages)


def test_the_metadata_inside_the_file_is_what_stands_beside_it(
    written: tuple[Path, list[tuple[str, Any]]],
) -> None:
    """rosbag2 takes it from there when a file is opened without its folder."""
    from mcap.reader import make_reader

    folder, _ = written
    with (folder / "every_type_0.mcap").open("rb") as stream:
        (inside,) = [
            record.metadata["serialized_metadata"]
            for record in make_reader(stream).iter_metadata()
            if record.name == "rosbag2"
        ]
    beside = yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    told = yaml.safe_load(inside)
    assert told.pop("custom_data")["robustnav_closed"] == "no"
    assert beside.pop("custom_data")["robustnav_closed"] == "yes"
    assert told == beside


def test_a_part_of_the_time_and_of_the_topics_can_be_read(
    written: tuple[Path, list[tuple[str, Any]]], manifest: Manifest
) -> None:
    folder, messages = written
    begin, end = manifest.wall_start_ns + 300_000_000, manifest.wall_start_ns + 500_000_000
    topics = {"/std_msgs/msg/String", "/nav_msgs/msg/Odometry"}
    with open_bag(folder) as bag:
        found = [
            (raw.log_time_ns, raw.topic) for raw in bag.raw_messages(topics, start_ns=begin, stop_ns=end)
        ]
    everything = [
        (manifest.wall_start_ns + i * 10_000_000, f"/{kind}") for i, (kind, _) in enumerate(messages)
    ]
    assert found == [item for item in everything if begin <= item[0] < end and item[1] in topics]
    assert found


def test_messages_come_in_order_of_time_whatever_the_order_of_writing(
    tmp_path: Path, manifest: Manifest
) -> None:
    rng = np.random.default_rng(2)
    times = [int(time) for time in rng.integers(10**18, 10**18 + 10**9, 500)]
    with BagWriter(tmp_path / "mixed", manifest=manifest, chunk_bytes=1500) as writer:
        channel = writer.add_topic("/a", message_definition("std_msgs/msg/Empty", PREFIXES))
        for time in times:
            writer.write(channel, log_time_ns=time, publish_time_ns=time, data=b"\x00\x01\x00\x00\x00")
    with open_bag(tmp_path / "mixed") as bag:
        assert [raw.log_time_ns for raw in bag.raw_messages()] == sorted(times)
        assert bag.span_ns == (min(times), max(times))
    metadata = read_metadata(tmp_path / "mixed")
    assert (metadata.start_ns, metadata.duration_ns) == (min(times), max(times) - min(times))


def test_a_topic_that_changes_its_type_is_kept_with_both(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "both", manifest=manifest) as writer:
        for kind, data in (("Bool", b"\x00\x01\x00\x00\x01"), ("UInt8", b"\x00\x01\x00\x00\x07")):
            channel = writer.add_topic("/a", message_definition(f"std_msgs/msg/{kind}", PREFIXES))
            writer.write(channel, log_time_ns=1, publish_time_ns=1, data=data)
    with open_bag(tmp_path / "both") as bag:
        assert [row.type for row in bag.topics] == ["std_msgs/msg/Bool", "std_msgs/msg/UInt8"]
        assert [recorded.message.data for recorded in bag.messages()] == [True, 7]


def test_messages_of_an_unknown_type_are_kept_and_not_decoded(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "unknown", manifest=manifest) as writer:
        channel = writer.add_topic("/a", message_definition("my_msgs/msg/Custom", PREFIXES))
        writer.write(channel, log_time_ns=1, publish_time_ns=1, data=b"\x00\x01\x00\x00\x01")
    with open_bag(tmp_path / "unknown") as bag:
        assert [raw.data for raw in bag.raw_messages()] == [b"\x00\x01\x00\x00\x01"]
        with pytest.raises(BadFileError, match="my_msgs/msg/Custom"):
            list(bag.messages())
    with Reader(tmp_path / "unknown") as reader:
        assert reader.message_count == 1


def test_an_empty_bag_is_a_bag(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "empty", manifest=manifest) as writer:
        writer.add_topic("/a", message_definition("std_msgs/msg/Empty", PREFIXES))
    with open_bag(tmp_path / "empty") as bag:
        assert (bag.cut, bag.span_ns, list(bag.messages())) == ("", None, [])
    with Reader(tmp_path / "empty") as reader:
        assert reader.message_count == 0


def test_the_last_manifest_counts_however_large(tmp_path: Path, manifest: Manifest) -> None:
    many = tuple(NamedParameter(name=f"p{number}", value="x" * 100) for number in range(1000))
    large = manifest.with_node(NodeParameters(node="/large", parameters=many))
    assert len(large.as_json()) > LARGEST_MANIFEST_RECORD
    writer = BagWriter(tmp_path / "large", manifest=manifest)
    writer.update_manifest(large)
    writer.close()
    writer.close()
    with open_bag(tmp_path / "large") as bag:
        assert bag.manifest == large
    with Reader(tmp_path / "large") as reader:
        assert reader.message_count == 0


def test_nothing_is_overwritten(tmp_path: Path, manifest: Manifest) -> None:
    (tmp_path / "there").mkdir()
    with pytest.raises(BadFileError, match="exists already"):
        BagWriter(tmp_path / "there", manifest=manifest)
    assert list((tmp_path / "there").iterdir()) == []


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path, manifest: Manifest) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(BadFileError, match=r"cannot be written to .*file/bag: Not a directory"):
        BagWriter(tmp_path / "file" / "bag", manifest=manifest)
