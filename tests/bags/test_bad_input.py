"""Whatever a reader is given, it answers with a value or with one sentence that says what is wrong."""

import random
from pathlib import Path

import numpy as np
import pytest
from mcap.writer import Writer
from rclpy.serialization import serialize_message

from bags.decoding import MessageDecoder
from bags.definitions import ament_prefixes, message_definition
from bags.info import bag_info
from bags.reader import open_bag
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.graph.message_class import message_class
from tests.bags.filled_messages import TYPES, filled

NUMBER = b"\0\1\0\0" + (7).to_bytes(8, "little")


def write_file(
    path: Path,
    *,
    kind: str = "std_msgs/msg/UInt64",
    definition: bytes = b"uint64 data\n",
    definition_encoding: str = "ros2msg",
    encoding: str = "cdr",
    data: bytes = NUMBER,
    qos: str = "",
) -> Path:
    """A file with one message on /a, as another tool might have written it."""
    with path.open("wb") as stream:
        writer = Writer(stream)
        writer.start(profile="ros2")
        schema = writer.register_schema(kind, definition_encoding, definition)
        channel = writer.register_channel("/a", encoding, schema, {"offered_qos_profiles": qos})
        writer.add_message(channel, 1, data, 1)
        writer.finish()
    return path


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        (
            {"kind": "my_msgs/msg/Odd", "definition": b"\0\1", "definition_encoding": "protobuf"},
            "nothing defines",
        ),
        (
            {"kind": "my_msgs/msg/Odd", "definition": b"their_msgs/Thing a\n"},
            "nothing defines 'their_msgs/msg",
        ),
        ({"definition": b"this is { no definition"}, "nothing defines 'std_msgs/msg/this', which 'std_msgs"),
        ({"definition": b"\xff\xfe\0"}, "the bag's definition of std_msgs/msg/UInt64 cannot be used"),
        ({"data": b""}, "0 bytes are no message of type std_msgs/msg/UInt64"),
        ({"data": b"\1"}, "1 bytes are no message of type"),
        ({"data": NUMBER[:-3]}, "9 bytes are no message of type"),
        ({"data": b"\xff" * 12}, "12 bytes are no message of type"),
        (
            {
                "kind": "std_msgs/msg/String",
                "definition": b"string data\n",
                "data": b"\0\1\0\0\xff\xff\xff\x7fno",
            },
            "10 bytes are no message of type std_msgs/msg/String",
        ),
    ],
)
def test_what_cannot_be_decoded_is_named_and_its_file_can_still_be_looked_at(
    tmp_path: Path, given: dict[str, object], sentence: str
) -> None:
    path = write_file(tmp_path / "a.mcap", **given)  # type: ignore[arg-type]
    with open_bag(path) as bag:
        assert bag_info(bag).message_count == 1
        assert [raw.data for raw in bag.raw_messages()] == [given.get("data", NUMBER)]
        with pytest.raises(BadFileError, match=sentence) as refused:
            list(bag.messages())
    assert str(refused.value).startswith(f"'/a' in {path}: ")


@pytest.mark.parametrize("qos", ["- {: [", "- 7"])
def test_damaged_qos_is_refused_with_its_topic(tmp_path: Path, qos: str) -> None:
    with open_bag(write_file(tmp_path / "a.mcap", qos=qos)) as bag:
        assert len(list(bag.messages())) == 1
        with pytest.raises(BadFileError, match="about '/a' is damaged"):
            bag_info(bag)


@pytest.mark.parametrize("kind", TYPES)
def test_bytes_that_are_no_message_give_a_value_or_a_sentence(kind: str) -> None:
    rng, chance = np.random.default_rng(3), random.Random(3)
    decoder = MessageDecoder()
    decoder.add(kind, message_definition(kind, ament_prefixes()).text, "ros2msg")
    sentences = 0
    for _ in range(40):
        data = bytearray(serialize_message(filled(message_class(kind), rng)))
        for _ in range(3):
            data[chance.randrange(len(data))] = chance.randrange(256)
        for wrong in (
            bytes(data),
            bytes(data[: chance.randrange(len(data))]),
            bytes(data[:4]) + chance.randbytes(99),
        ):
            try:
                decoder.decode(kind, wrong)
            except BadFileError:
                sentences += 1
    assert sentences > 30


def test_a_folder_of_several_bags_says_which_it_holds(tmp_path: Path) -> None:
    for name in "dabc":
        write_file(tmp_path / f"{name}.mcap")
    with pytest.raises(
        BadFileError, match=r"so it is no bag; it holds a\.mcap, b\.mcap, c\.mcap and 1 more: open"
    ):
        open_bag(tmp_path)
    for path in tmp_path.glob("*.mcap"):
        path.unlink()
    with pytest.raises(BadFileError, match=r"so it is no bag, and it holds none$"):
        open_bag(tmp_path)
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "metadata.yaml").touch()
    with pytest.raises(BadFileError, match=r"it holds run: open one of these itself"):
        open_bag(tmp_path)
