"""A bag whose recorder was killed is gone on with in its next file, and is one bag to every reader."""

import errno
import os
import shutil
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from rosbags.rosbag2 import Reader

from bags.bag_metadata import read_metadata
from bags.definitions import message_definition
from bags.info import bag_info
from bags.manifest import Manifest
from bags.metrics import search_metrics
from bags.offered_qos import OfferedQos
from bags.picture import draw_search
from bags.reader import open_bag
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError
from tests.bags.conftest import FLAT, MANIFEST, Talk, Told, write_search

NUMBER = message_definition("std_msgs/msg/UInt64", (Path(sys.prefix),))


def number(value: int) -> bytes:
    return b"\0\1\0\0" + value.to_bytes(8, "little")


def write(writer: BagWriter, values: range, topics: tuple[str, ...] = ("/a",)) -> None:
    channels = [writer.add_topic(topic, NUMBER) for topic in topics]
    for value in values:
        now_ns = 1000 + value
        channel = channels[value % len(channels)]
        writer.write(channel, log_time_ns=now_ns, publish_time_ns=now_ns, data=number(value))


def killed(writer: BagWriter, to: Path) -> Path:
    """What a kill after a flush leaves of the bag that is being written; `writer` itself is given up."""
    writer.flush()
    shutil.copytree(writer.folder, to / writer.folder.name)
    writer.close()
    return to / writer.folder.name


@pytest.fixture
def left(tmp_path: Path, manifest: Manifest) -> Path:
    """A bag of 100 numbers that a killed recorder left, the last record of its file cut."""
    writer = BagWriter(tmp_path / "alive" / "bag", manifest=manifest, chunk_bytes=1024)
    write(writer, range(100))
    folder = killed(writer, tmp_path)
    with (folder / "bag_0.mcap").open("ab") as stream:
        stream.write(b"\x06\xff\0\0\0\0\0\0\0begin of a chunk")
    return folder


def numbers(folder: Path) -> list[int]:
    with open_bag(folder) as bag:
        return [recorded.message.data for recorded in bag.messages()]


def test_a_bag_that_was_killed_twice_is_one_bag(left: Path, tmp_path: Path, manifest: Manifest) -> None:
    second = BagWriter(left, manifest=manifest, chunk_bytes=1024, resume=True)
    assert second.path == left / "bag_1.mcap"
    (repair,) = second.join_earlier_files().repairs
    assert (repair.messages, repair.topics, repair.lost_bytes) == (100, 1, 25)
    write(second, range(100, 160), ("/a", "/b"))
    left_again = killed(second, tmp_path / "again")
    later = replace(manifest, seed=8)
    with BagWriter(left_again, manifest=later, resume=True) as third:
        write(third, range(160, 200), ("/b",))
    assert numbers(left_again) == list(range(200))
    with open_bag(left_again) as bag:
        assert (bag.cut, bag.manifest, bag.span_ns) == ("", later, (1000, 1199))
        counts = {row.name: row.message_count for row in bag.topics}
        assert bag_info(bag).message_count == 200
    assert counts == {"/a": 130, "/b": 70}
    metadata = read_metadata(left_again)
    told = [(row.name, row.start_ns, row.duration_ns, row.message_count) for row in metadata.files]
    assert told == [
        ("bag_0.mcap", 1000, 99, 100),
        ("bag_1.mcap", 1100, 59, 60),
        ("bag_2.mcap", 1160, 39, 40),
    ]
    assert {row.name: row.message_count for row in metadata.topics} == counts
    assert (metadata.message_count, metadata.start_ns, metadata.duration_ns) == (200, 1000, 199)
    with Reader(left_again) as reader:
        assert reader.message_count == 200
        assert {topic: info.msgcount for topic, info in reader.topics.items()} == counts
        assert [data for _, _, data in reader.messages()] == [number(value) for value in range(200)]


@pytest.mark.parametrize("joined_first", [True, False])
def test_other_readers_get_all_of_a_topic_whose_publishers_changed(
    tmp_path: Path, manifest: Manifest, joined_first: bool
) -> None:
    """rosbags passes over, without a word, what a file holds of a topic with other QoS than metadata.yaml."""
    first = BagWriter(tmp_path / "alive" / "bag", manifest=manifest)
    channel = first.add_topic("/a", NUMBER, [OfferedQos()])
    first.write(channel, log_time_ns=1, publish_time_ns=1, data=number(0))
    left = killed(first, tmp_path)
    with BagWriter(left, manifest=manifest, resume=True) as second:
        if joined_first:
            second.join_earlier_files()
        channels = [second.add_topic("/a", NUMBER, [OfferedQos(), OfferedQos(depth=7)])]
        channels.append(second.add_topic("/b", NUMBER, [OfferedQos(depth=7)]))
        for value in (1, 2):
            now_ns = value + 1
            second.write(channels[value - 1], log_time_ns=now_ns, publish_time_ns=now_ns, data=number(value))
    assert numbers(left) == [0, 1, 2]
    with Reader(left) as reader:
        assert [data for _, _, data in reader.messages()] == [number(value) for value in range(3)]
    rows = {row.name: row.offers for row in read_metadata(left).topics}
    assert rows == {"/a": (OfferedQos(),), "/b": (OfferedQos(depth=7),)}


def test_a_recorder_killed_before_it_repaired_leaves_that_to_the_next(
    left: Path, tmp_path: Path, manifest: Manifest
) -> None:
    second = BagWriter(left, manifest=manifest, resume=True)
    write(second, range(100, 110))
    left_again = killed(second, tmp_path / "again")
    assert numbers(left_again) == list(range(100))  # metadata.yaml is still the first recorder's
    with BagWriter(left_again, manifest=manifest, resume=True) as third:
        assert len(third.join_earlier_files().repairs) == 2
        write(third, range(110, 120))
    assert numbers(left_again) == list(range(120))


@pytest.mark.parametrize("left_over", ["", "\x89MCA"])
def test_a_file_in_which_nothing_was_written_yet_is_no_hindrance(
    left: Path, manifest: Manifest, left_over: str
) -> None:
    (left / "bag_1.mcap").write_text(left_over, encoding="latin-1")
    with BagWriter(left, manifest=manifest, resume=True) as writer:
        write(writer, range(100, 110))
    assert numbers(left) == list(range(110))
    assert [row.message_count for row in read_metadata(left).files] == [100, 0, 10]
    assert read_metadata(left).start_ns == 1000
    with Reader(left) as reader:
        assert (reader.message_count, reader.start_time) == (110, 1000)


def test_a_recorder_killed_at_its_very_end_or_very_beginning_is_followed(
    left: Path, tmp_path: Path, manifest: Manifest
) -> None:
    with BagWriter(left, manifest=manifest, resume=True) as writer:
        write(writer, range(100, 110))
    unclosed = (
        (left / "metadata.yaml").read_text().replace("robustnav_closed: 'yes'", "robustnav_closed: 'no'")
    )
    (left / "metadata.yaml").write_text(unclosed)
    with BagWriter(left, manifest=manifest, resume=True) as writer:
        assert writer.join_earlier_files().repairs == ()
        write(writer, range(110, 120))
    assert numbers(left) == list(range(120))
    (tmp_path / "empty").mkdir()
    with BagWriter(tmp_path / "empty", manifest=manifest, resume=True) as writer:
        write(writer, range(5))
    assert writer.path == tmp_path / "empty" / "empty_0.mcap"
    assert numbers(tmp_path / "empty") == list(range(5))


def test_a_bag_that_was_closed_is_not_gone_on_with(left: Path, manifest: Manifest) -> None:
    BagWriter(left, manifest=manifest, resume=True).close()
    before = {path: path.read_bytes() for path in left.iterdir()}
    for resume, sentence in (
        (True, "was closed properly and is not overwritten"),
        (False, "is not overwritten"),
    ):
        with pytest.raises(BadFileError, match=sentence):
            BagWriter(left, manifest=manifest, resume=resume)
    assert {path: path.read_bytes() for path in left.iterdir()} == before


def test_a_cut_bag_is_refused_where_nobody_said_to_resume(left: Path, manifest: Manifest) -> None:
    before = {path: path.read_bytes() for path in left.iterdir()}
    with pytest.raises(BadFileError, match="exists already and is not overwritten"):
        BagWriter(left, manifest=manifest)
    assert {path: path.read_bytes() for path in left.iterdir()} == before


def test_a_bag_that_another_recorder_is_writing_is_refused(tmp_path: Path, manifest: Manifest) -> None:
    with BagWriter(tmp_path / "bag", manifest=manifest) as writer:
        write(writer, range(10))
        writer.flush()
        with pytest.raises(BadFileError, match="is being written by another recorder"):
            BagWriter(tmp_path / "bag", manifest=manifest, resume=True)
    assert numbers(tmp_path / "bag") == list(range(10))


def test_a_folder_of_something_else_is_refused(tmp_path: Path, manifest: Manifest) -> None:
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "thesis.tex").write_text("precious")
    with pytest.raises(BadFileError, match="is no bag"):
        BagWriter(tmp_path / "bag", manifest=manifest, resume=True)
    assert [path.name for path in (tmp_path / "bag").iterdir()] == ["thesis.tex"]


def test_a_file_that_cannot_be_repaired_is_kept_and_counted(
    left: Path, manifest: Manifest, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", fail)
    with BagWriter(left, manifest=manifest, resume=True) as writer:
        (problem,) = writer.join_earlier_files().problems
        write(writer, range(100, 110))
    assert "bag_0.mcap was cut and cannot be repaired: " in problem
    assert numbers(left) == list(range(110))
    assert read_metadata(left).message_count == 110


def test_a_search_that_was_cut_in_two_is_measured_and_drawn_as_one(
    search_bag: Callable[..., Path], tmp_path: Path
) -> None:
    class KilledInTheMiddle(Talk):
        """Talk whose recorder is killed and started again after some messages."""

        said = 0

        def say(self, topic: str, message: object) -> None:
            self.said += 1
            if self.said == 150:
                left = killed(self.writer, tmp_path / "left")
                self.writer = BagWriter(left, manifest=MANIFEST, resume=True)
                self.channels = {}
            super().say(topic, message)

    talk = KilledInTheMiddle(BagWriter(tmp_path / "alive" / "run", manifest=MANIFEST))
    write_search(talk, FLAT, Told())
    talk.writer.close()
    with open_bag(search_bag()) as whole, open_bag(talk.writer.folder) as joined:
        assert talk.writer.path.name == "run_1.mcap"
        assert min(row.message_count for row in read_metadata(joined.path).files) > 50
        assert joined.topics == whole.topics
        said = [[(raw.topic, raw.log_time_ns) for raw in bag.raw_messages()] for bag in (joined, whole)]
        assert said[0] == said[1]
        assert search_metrics(joined) == search_metrics(whole)
        draw_search(joined, tmp_path / "run.png")
    assert (tmp_path / "run.png").stat().st_size > 10_000
