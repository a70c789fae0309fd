"""Bags of runs that were killed, files that were cut or damaged, and files that are no bags."""

import random
import re
import signal
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from bags.bag_metadata import read_metadata
from bags.definitions import message_definition
from bags.info import bag_info
from bags.manifest import Manifest
from bags.mcap_scan import MAGIC, whole_records
from bags.reader import open_bag
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError
from tests.bags.conftest import Corridor

PREFIXES = (Path(sys.prefix),)
COUNT = 200

KILLED = textwrap.dedent(
    """
    import sys
    from pathlib import Path
    from bags.definitions import message_definition
    from bags.manifest import Manifest
    from bags.recording import Recording
    from bags.writer import BagWriter

    writer = BagWriter(Path(sys.argv[1]), manifest=Manifest(version="0", wall_start_ns=1))
    recording = Recording(writer, queue_bytes=10**9, flush_period_s=0.1)
    channel = recording.add_topic("/a", message_definition("std_msgs/msg/UInt64", (Path(sys.prefix),)))
    number = 0
    while True:
        recording.put(channel, number + 1, b"\\0\\1\\0\\0" + number.to_bytes(8, "little"))
        number += 1
        while recording.waiting_bytes > 10_000:
            recording.wait(0.01)
        if number % 100 == 0:
            print(number, flush=True)
    """
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory, manifest: Manifest) -> Path:
    """A bag of numbers in many chunks."""
    folder = tmp_path_factory.mktemp("whole") / "numbers"
    with BagWriter(folder, manifest=manifest, chunk_bytes=1024) as writer:
        channel = writer.add_topic("/a", message_definition("std_msgs/msg/UInt64", PREFIXES))
        for number in range(COUNT):
            data = b"\0\1\0\0" + number.to_bytes(8, "little")
            writer.write(channel, log_time_ns=number + 1, publish_time_ns=number + 1, data=data)
    return folder


def numbers(path: Path) -> list[int]:
    with open_bag(path) as bag:
        return [recorded.message.data for recorded in bag.messages()]


def positions(size: int) -> Iterator[int]:
    """Every position near the ends, where the structure is, and some between."""
    yield from range(120)
    yield from sorted(random.Random(3).sample(range(120, size - 120), 50))
    yield from range(size - 120, size)


def test_a_file_cut_anywhere_gives_what_is_whole_or_a_sentence(whole: Path, tmp_path: Path) -> None:
    content = (whole / "numbers_0.mcap").read_bytes()
    path = tmp_path / "cut.mcap"
    kept_before = 0
    for size in positions(len(content)):
        path.write_bytes(content[:size])
        try:
            kept = numbers(path)
        except BadFileError:
            kept = None
        if kept is None:
            assert size < 8
            continue
        assert kept == list(range(len(kept)))
        assert len(kept) >= kept_before
        kept_before = len(kept)
        with open_bag(path) as bag:
            assert f"{len(kept)} messages of" in bag.cut
    assert kept_before == COUNT


def test_a_bag_cut_at_random_gives_what_was_whole_or_a_sentence(
    search_bag: Callable[..., Path], corridor: Corridor
) -> None:
    folder = search_bag(corridor.flat, corridor.told, chunk_bytes=4096)
    (path,) = folder.glob("*.mcap")
    content = path.read_bytes()
    with open_bag(folder) as bag:
        everything, manifest = list(bag.raw_messages()), bag.manifest
    with path.open("rb") as stream:
        ends = [
            (whole.end, sum(map(len, whole.contents.messages.values())))
            for whole in whole_records(stream)
            if whole.contents is not None
        ]
    assert len(ends) > 10
    for size in random.Random(7).sample(range(len(content)), 60):
        path.write_bytes(content[:size])
        expected = sum(count for end, count in ends if end <= size)
        if size < len(MAGIC):
            with pytest.raises(BadFileError, match=re.escape(str(path))):
                open_bag(folder)
            continue
        with open_bag(folder) as bag:
            assert list(bag.raw_messages()) == everything[:expected]
            info = bag_info(bag)
        assert info.message_count == expected
        assert str(path) in info.cut
        assert info.manifest == manifest or expected == 0


def test_a_file_with_any_byte_wrong_gives_numbers_or_a_sentence(whole: Path, tmp_path: Path) -> None:
    content = (whole / "numbers_0.mcap").read_bytes()
    path = tmp_path / "wrong.mcap"
    for position in positions(len(content)):
        path.write_bytes(content[:position] + bytes([content[position] ^ 0xFF]) + content[position + 1 :])
        try:
            found, sentence = numbers(path), ""
        except BadFileError as error:
            found, sentence = [], str(error)
        assert set(found) <= set(range(COUNT))
        assert not sentence or str(path) in sentence or "UInt64" in sentence


def test_what_was_flushed_before_a_kill_is_there(tmp_path: Path) -> None:
    folder = tmp_path / "killed"
    command = [sys.executable, "-c", KILLED, str(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as writer:
        assert writer.stdout is not None
        try:
            told = [int(writer.stdout.readline()) for _ in range(100)][-1]
            size = read_size(folder)
            for _ in range(2):  # two flushes later, all that was said by then is in the file
                while read_size(folder) == size:
                    writer.stdout.readline()
                size = read_size(folder)
        finally:
            writer.kill()
    assert writer.returncode == -signal.SIGKILL
    kept = numbers(folder)
    assert kept == list(range(len(kept)))
    assert len(kept) >= told
    with open_bag(folder) as bag:
        assert "not closed properly" in bag.cut
        assert bag.manifest is not None
    assert [row.name for row in read_metadata(folder).topics] == ["/a"]


def read_size(folder: Path) -> int:
    return (folder / "killed_0.mcap").stat().st_size


def test_an_empty_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_bytes(b"")
    with pytest.raises(BadFileError, match="is empty"):
        open_bag(tmp_path / "a.mcap")


def test_another_kind_of_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").write_bytes(b"SQLite format 3\0" * 100)
    with pytest.raises(BadFileError, match="not an MCAP file: it starts with b'SQLite f'"):
        open_bag(tmp_path / "a.mcap")


def test_a_missing_bag_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match="there is no bag at"):
        open_bag(tmp_path / "nowhere")


def test_a_folder_without_metadata_is_refused(whole: Path, tmp_path: Path) -> None:
    (tmp_path / "b_0.mcap").write_bytes((whole / "numbers_0.mcap").read_bytes())
    with pytest.raises(BadFileError, match=r"has no metadata\.yaml.*it holds b_0\.mcap: open one of these"):
        open_bag(tmp_path)


@pytest.mark.parametrize(
    "text", ["", "a: [", "3", "rosbag2_bagfile_information: {version: 9}", "rosbag2_bagfile_information: [1]"]
)
def test_bad_metadata_is_refused(whole: Path, tmp_path: Path, text: str) -> None:
    (tmp_path / "metadata.yaml").write_text(text)
    with pytest.raises(BadFileError, match=r"metadata\.yaml"):
        open_bag(tmp_path)


def test_a_bag_whose_file_is_gone_is_refused(whole: Path, tmp_path: Path) -> None:
    (tmp_path / "metadata.yaml").write_text((whole / "metadata.yaml").read_text())
    with pytest.raises(BadFileError, match=r"numbers_0\.mcap cannot be opened: No such file"):
        open_bag(tmp_path)


def test_a_bag_in_another_storage_is_refused(whole: Path, tmp_path: Path) -> None:
    text = (
        (whole / "metadata.yaml")
        .read_text()
        .replace("storage_identifier: mcap", "storage_identifier: sqlite3")
    )
    (tmp_path / "metadata.yaml").write_text(text)
    with pytest.raises(BadFileError, match="stored as 'sqlite3'; convert it"):
        open_bag(tmp_path)
