"""A redacted bag holds no pixel and no word of what was taken out, and all else as it was."""

import io
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.msg import State, TransitionEvent
from mcap.reader import make_reader
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from PIL import Image
from rcl_interfaces.msg import Log
from rclpy.serialization import serialize_message
from rosbags.rosbag2 import Reader
from sensor_msgs.msg import CompressedImage, PointCloud2, PointField
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

from bags.definitions import MessageDefinition, message_definition
from bags.image_redaction import blurred
from bags.manifest import Manifest
from bags.mcap_scan import whole_records
from bags.metrics import search_metrics
from bags.reader import RawMessage, open_bag
from bags.recorded_values import recorded_values
from bags.redact import redact_bag
from bags.redaction_choices import Chat, Images
from bags.writer import BagWriter
from robustnav_msgs_py import conversions
from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.records import DialogueState

IMAGE_TOPICS = {"/camera/image_raw", "/camera/depth/image_raw"}
SECRET = "my pills lie on the night table"
ANSWER = "I do not know what 'pills of Ms Müller' looks like."


def contents(folder: Path) -> bytes:
    """Every byte of the bag's files, chunks as they are and uncompressed, and of metadata.yaml."""
    found = [path.read_bytes() for path in folder.iterdir()]
    for path in folder.glob("*.mcap"):
        with path.open("rb") as stream:
            found += [whole.contents.data for whole in whole_records(stream) if whole.contents is not None]
    return b"\n".join(found)


def raw(folder: Path) -> list[RawMessage]:
    with open_bag(folder) as bag:
        return list(bag.raw_messages())


def rows_of(folder: Path) -> Iterator[bytes]:
    with open_bag(folder) as bag:
        for recorded in bag.messages(IMAGE_TOPICS):
            data, step = bytes(recorded.message.data), int(recorded.message.step)
            yield from (data[at : at + step] for at in range(0, len(data), step))


def write_bag(folder: Path, manifest: Manifest, *messages: tuple[str, str, Any]) -> Path:
    with BagWriter(folder, manifest=manifest) as writer:
        for number, (topic, kind, message) in enumerate(messages):
            channel = writer.add_topic(topic, message_definition(kind, ()))
            writer.write(
                channel, log_time_ns=number + 1, publish_time_ns=number, data=serialize_message(message)
            )
    return folder


def test_no_row_of_a_picture_is_left_and_all_else_is(
    picture_bag: Callable[..., Path], tmp_path: Path
) -> None:
    source = picture_bag(64, 48, chunk_bytes=20_000)
    before, rows = raw(source), list(rows_of(source))
    assert len(rows) > 100
    whole = contents(source)
    assert all(row in whole for row in rows[:100])
    done = redact_bag(source, tmp_path / "out", images=Images.REMOVE, chat=Chat.REMOVE)
    assert raw(tmp_path / "out") == [item for item in before if item.topic not in IMAGE_TOPICS]
    left = contents(tmp_path / "out")
    assert not any(row in left for row in rows)
    assert set(done.removed) == IMAGE_TOPICS


def test_blurred_pictures_keep_their_size_and_lose_their_rows(
    picture_bag: Callable[..., Path], tmp_path: Path
) -> None:
    source = picture_bag(64, 48)
    before, rows = raw(source), list(rows_of(source))
    redact_bag(source, tmp_path / "out", images=Images.BLUR, chat=Chat.REMOVE)
    after = raw(tmp_path / "out")
    assert [(item.topic, item.log_time_ns, item.publish_time_ns) for item in after] == [
        (item.topic, item.log_time_ns, item.publish_time_ns) for item in before
    ]
    assert [item for item in after if item.topic not in IMAGE_TOPICS] == [
        item for item in before if item.topic not in IMAGE_TOPICS
    ]
    left = contents(tmp_path / "out")
    assert not any(row in left for row in rows)
    with open_bag(tmp_path / "out") as bag:
        for value in recorded_values(bag, ["camera/image_raw"]):
            assert value.value.pixels.shape == (48, 64, 3)
            assert value.value.pixels.std() < 10  # of noise, whose own is 74


def test_a_redacted_search_is_measured_as_before_and_read_by_others(
    picture_bag: Callable[..., Path], tmp_path: Path, manifest: Manifest
) -> None:
    source, out = picture_bag(64, 48), tmp_path / "out"
    redact_bag(source, out, images=Images.REMOVE, chat=Chat.REMOVE)
    with open_bag(source) as old, open_bag(out) as new:
        assert search_metrics(old) == search_metrics(new)
        assert new.cut == ""
        assert [(row.name, row.offers, row.type_hash) for row in new.topics] == [
            (row.name, row.offers, row.type_hash) for row in old.topics
        ]
        told = new.manifest
    assert told is not None
    assert told.nodes == manifest.nodes
    assert told.redacted[0].startswith("removed: /camera/depth/image_raw")
    with Reader(out) as reader:
        assert reader.message_count == len(raw(out))
    with next(out.glob("*.mcap")).open("rb") as stream:
        assert len(list(make_reader(stream).iter_messages())) == len(raw(out))


def test_what_was_said_is_nowhere_in_the_bag(tmp_path: Path, manifest: Manifest) -> None:
    state = conversions.record_to_message(
        DialogueState(target="mug", lines_heard=1, last_heard=SECRET[:20] + "…", last_said=ANSWER),
        summary=ANSWER,
    )
    health = conversions.status_to_message(conversions.status_from_message(state))
    source = write_bag(
        tmp_path / "said",
        manifest,
        ("/detections/labels", "std_msgs/msg/String", String(data="mug, plant")),
        ("/r/chat/from_user", "std_msgs/msg/String", String(data=SECRET)),
        ("/r/chat/to_user", "std_msgs/msg/String", String(data=ANSWER)),
        ("/r/dialogue/state", "diagnostic_msgs/msg/DiagnosticStatus", state),
        ("/search/target", "std_msgs/msg/String", String(data="aunt Ida's urn")),
        ("/rosout", "rcl_interfaces/msg/Log", Log(name="dialogue", msg=f"heard: {SECRET}!")),
        ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", DiagnosticArray(status=[health])),
        ("/other", "std_msgs/msg/String", String(data="a mug")),
    )
    redact_bag(source, tmp_path / "out", images=Images.KEEP, chat=Chat.REMOVE)
    before, left = contents(source), contents(tmp_path / "out")
    for words in (SECRET, SECRET[:20], "Müller", "Ida", "urn"):
        assert words.encode() in before
        assert words.encode() not in left
    with open_bag(tmp_path / "out") as bag:
        told = {item.topic: item.message for item in bag.messages()}
    assert told["/r/chat/from_user"].data == f"[redacted {len(SECRET)} characters]"
    assert told["/rosout"].msg == f"heard: [redacted {len(SECRET)} characters]!"
    assert told["/detections/labels"].data == "mug, plant"
    assert raw(tmp_path / "out")[-1] == raw(source)[-1]
    assert conversions.record_from_message(told["/r/dialogue/state"], DialogueState).target == "mug"


def test_what_nodes_say_of_themselves_is_nobody_s_words(tmp_path: Path, manifest: Manifest) -> None:
    event = TransitionEvent(start_state=State(label="unconfigured"))
    source = write_bag(
        tmp_path / "events",
        manifest,
        ("/dialogue/transition_event", "lifecycle_msgs/msg/TransitionEvent", event),
        ("/rosout", "rcl_interfaces/msg/Log", Log(msg="dialogue is unconfigured")),
        ("/chat", "std_msgs/msg/String", String(data=SECRET)),
    )
    done = redact_bag(source, tmp_path / "out", images=Images.REMOVE, chat=Chat.REMOVE)
    assert raw(tmp_path / "out")[:2] == raw(source)[:2]
    assert set(done.replaced) == {"/chat"}


def test_what_is_to_be_kept_is_kept_byte_by_byte(picture_bag: Callable[..., Path], tmp_path: Path) -> None:
    source = picture_bag(16, 16)
    redact_bag(source, tmp_path / "out", images=Images.KEEP, chat=Chat.REMOVE)
    assert raw(tmp_path / "out") == raw(source)
    with pytest.raises(BadParameterError, match="nothing to redact"):
        redact_bag(source, tmp_path / "more", images=Images.KEEP, chat=Chat.KEEP)


@pytest.mark.parametrize("images", [Images.REMOVE, Images.BLUR])
def test_pictures_in_other_types_do_not_stay(tmp_path: Path, manifest: Manifest, images: Images) -> None:
    pixels = np.random.default_rng(1).integers(0, 256, (64, 64, 3), dtype=np.uint8)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    texture = CompressedImage(format="png", data=file.getvalue())
    cloud = PointCloud2(
        fields=[PointField(name="rgb", datatype=7, count=1)], point_step=4, data=bytes(range(64))
    )
    plain = MarkerArray(markers=[Marker(text="mug")])
    source = write_bag(
        tmp_path / "kinds",
        manifest,
        ("/a/compressed", "sensor_msgs/msg/CompressedImage", texture),
        (
            "/a/depth",
            "sensor_msgs/msg/CompressedImage",
            CompressedImage(format="compressedDepth png", data=b"\0" * 12 + file.getvalue()),
        ),
        ("/marker", "visualization_msgs/msg/Marker", Marker(texture=texture)),
        ("/points", "sensor_msgs/msg/PointCloud2", cloud),
        ("/plain", "visualization_msgs/msg/MarkerArray", plain),
    )
    redact_bag(source, tmp_path / "out", images=images, chat=Chat.KEEP)
    left = contents(tmp_path / "out")
    assert file.getvalue()[50:] not in left
    assert bytes(range(64)) not in left
    kept = {item.topic: item for item in raw(tmp_path / "out")}
    assert kept["/plain"] == raw(source)[-1]
    expected = {"/marker", "/plain"} | ({"/a/compressed"} if images is Images.BLUR else set())
    assert kept.keys() == expected


def test_a_bag_that_was_cut_is_redacted_as_far_as_it_is_whole(
    picture_bag: Callable[..., Path], tmp_path: Path
) -> None:
    source = picture_bag(32, 32, chunk_bytes=8000)
    (file,) = source.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size * 2 // 3])
    rows, before = list(rows_of(source)), raw(source)
    redact_bag(source, tmp_path / "out", images=Images.REMOVE, chat=Chat.REMOVE)
    assert raw(tmp_path / "out") == [item for item in before if item.topic not in IMAGE_TOPICS]
    left = contents(tmp_path / "out")
    assert not any(row in left for row in rows)


def test_every_file_of_a_bag_is_redacted(
    picture_bag: Callable[..., Path], tmp_path: Path, manifest: Manifest
) -> None:
    source = picture_bag(32, 32, chunk_bytes=8000)
    (file,) = source.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size * 2 // 3])
    with BagWriter(source, manifest=manifest, resume=True) as writer:
        channel = writer.add_topic("/chat/from_user", message_definition("std_msgs/msg/String", ()))
        data = serialize_message(String(data=SECRET))
        writer.write(channel, log_time_ns=2**61, publish_time_ns=1, data=data)
    rows = list(rows_of(source))
    redact_bag(source, tmp_path / "out", images=Images.REMOVE, chat=Chat.REMOVE)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "out_0.mcap",
        "out_1.mcap",
        "metadata.yaml",
    }
    before = [item for item in raw(source) if item.topic not in IMAGE_TOPICS]
    assert raw(tmp_path / "out")[:-1] == before[:-1]
    left = contents(tmp_path / "out")
    assert not any(secret in left for secret in (SECRET.encode(), *rows))
    with open_bag(tmp_path / "out") as bag:
        assert bag.manifest is not None
        assert bag.manifest.redacted


@pytest.mark.parametrize("chunked", [True, False])
def test_files_of_others_lose_what_nobody_knows(tmp_path: Path, chunked: bool) -> None:
    path = tmp_path / "other.mcap"
    with path.open("wb") as stream:
        writer = McapWriter(stream, use_chunking=chunked, compression=CompressionType.LZ4)
        writer.start(profile="ros2")
        kind = message_definition("std_msgs/msg/String", ())
        schema = writer.register_schema(kind.type, "ros2msg", kind.text.encode())
        channel = writer.register_channel("/chat/a", "cdr", schema)
        data = serialize_message(String(data=SECRET))
        writer.add_message(channel, log_time=5, data=data, publish_time=4, sequence=9)
        writer.add_attachment(1, 1, "photo.jpg", "image/jpeg", b"photo of the flat")
        writer.add_metadata("note", {"who": "Ms Huber"})
        writer.finish()
    done = redact_bag(path, tmp_path / "out", images=Images.REMOVE, chat=Chat.REMOVE)
    assert done.left_out == 2
    left = contents(tmp_path / "out")
    assert not any(words in left for words in (SECRET.encode(), b"photo", b"Huber"))
    with next((tmp_path / "out").glob("*.mcap")).open("rb") as stream:
        ((_, _, message),) = make_reader(stream).iter_messages()
    assert (message.log_time, message.publish_time, message.sequence) == (5, 4, 9)
    assert "robustnav_redacted" in (tmp_path / "out" / "metadata.yaml").read_text(encoding="utf-8")


def test_nothing_is_written_over_and_nothing_left_behind(
    talk_bag: Callable[..., Path], tmp_path: Path, manifest: Manifest
) -> None:
    source = talk_bag(["hello"])
    there = tmp_path / "there"
    there.mkdir()
    with pytest.raises(BadFileError, match="exists already"):
        redact_bag(source, there, images=Images.REMOVE, chat=Chat.REMOVE)
    with BagWriter(tmp_path / "odd", manifest=manifest) as writer:
        odd = MessageDefinition(type="odd_msgs/msg/Odd", text="", type_hash="")
        writer.write(
            writer.add_topic("/chat/odd", odd), log_time_ns=1, publish_time_ns=1, data=b"\0\1\0\0odd"
        )
    with pytest.raises(BadFileError, match="nothing defines 'odd_msgs/msg/Odd'"):
        redact_bag(tmp_path / "odd", tmp_path / "out", images=Images.REMOVE, chat=Chat.REMOVE)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["odd", "talk", "there"]


def test_blurring_leaves_nothing_but_a_mean() -> None:
    flat = np.full((20, 30, 3), 7, dtype=np.uint8)
    assert np.allclose(blurred(flat), 7.0)
    holes = np.full((33, 17, 1), 2.0, dtype=np.float32)
    holes[::2] = np.nan
    assert np.allclose(blurred(holes), 2.0)
    assert np.isnan(blurred(np.full((9, 9, 1), np.inf, dtype=np.float32))).all()
