"""A bag that was cut becomes whole, in its place or in a new folder; nothing else is touched."""

import fcntl
from collections.abc import Callable
from pathlib import Path

import pytest

from bags.bag_metadata import read_metadata
from bags.reader import RawMessage, open_bag
from bags.repair_bag import repair_bag
from robustnav_msgs_py.errors import BadFileError


def raw(path: Path) -> list[RawMessage]:
    with open_bag(path) as bag:
        return list(bag.raw_messages())


@pytest.fixture
def cut_bag(search_bag: Callable[..., Path]) -> Path:
    folder = search_bag(chunk_bytes=4000)
    (file,) = folder.glob("*.mcap")
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
    return folder


def test_a_cut_bag_is_repaired_and_the_second_run_has_nothing_to_do(cut_bag: Path) -> None:
    before = raw(cut_bag)
    done = repair_bag(cut_bag)
    assert f"holds {len(before)} messages" in done.sentences[0]
    assert done.metadata_renewed
    assert raw(cut_bag) == before
    assert read_metadata(cut_bag).message_count == len(before)
    with open_bag(cut_bag) as bag:
        assert bag.cut == ""
    files = {path: path.read_bytes() for path in cut_bag.iterdir()}
    again = repair_bag(cut_bag)
    assert again.sentences == (f"{cut_bag} is whole: there is nothing to do",)
    assert {path: path.read_bytes() for path in cut_bag.iterdir()} == files


def test_with_out_the_cut_bag_stays_as_it_was(cut_bag: Path, tmp_path: Path) -> None:
    before = {path: path.read_bytes() for path in cut_bag.iterdir()}
    kept = raw(cut_bag)
    done = repair_bag(cut_bag, tmp_path / "whole")
    assert str(tmp_path / "whole") in done.sentences[0]
    assert raw(tmp_path / "whole") == kept
    assert {path: path.read_bytes() for path in cut_bag.iterdir()} == before
    with pytest.raises(BadFileError, match="exists already"):
        repair_bag(cut_bag, tmp_path / "whole")
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


def test_a_single_file_is_repaired(cut_bag: Path) -> None:
    (file,) = cut_bag.glob("*.mcap")
    assert not repair_bag(file).metadata_renewed
    with open_bag(file) as bag:
        assert bag.cut == ""


def test_metadata_that_was_lost_is_made_anew(search_bag: Callable[..., Path]) -> None:
    folder = search_bag()
    before = read_metadata(folder)
    (folder / "metadata.yaml").write_text("rosbag2_bagfile_inf", encoding="utf-8")
    assert repair_bag(folder).metadata_renewed
    after = read_metadata(folder)
    assert (after.files, after.message_count) == (before.files, before.message_count)
    assert {(row.name, row.offers) for row in after.topics} == {
        (row.name, row.offers) for row in before.topics
    }


def test_a_chunk_that_is_damaged_in_a_finished_file_is_found(search_bag: Callable[..., Path]) -> None:
    folder = search_bag(chunk_bytes=4000)
    (file,) = folder.glob("*.mcap")
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 0xFF
    file.write_bytes(content)
    assert "1 chunks were damaged" in repair_bag(folder).sentences[0]
    assert raw(folder)


def test_what_is_being_written_is_left_alone(cut_bag: Path) -> None:
    (file,) = cut_bag.glob("*.mcap")
    with file.open("rb") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        with pytest.raises(BadFileError, match="is being written"):
            repair_bag(cut_bag)


def test_two_bags_in_a_folder_are_not_made_one(search_bag: Callable[..., Path], tmp_path: Path) -> None:
    both = tmp_path / "both"
    both.mkdir()
    for folder in (search_bag(), search_bag()):
        (file,) = folder.glob("*.mcap")
        file.rename(both / file.name)
    with pytest.raises(BadFileError, match="files of several bags"):
        repair_bag(both)


def test_a_file_that_is_missing_is_named(cut_bag: Path) -> None:
    (file,) = cut_bag.glob("*.mcap")
    file.unlink()
    with pytest.raises(BadFileError, match="names search_0_0.mcap, which is not there"):
        repair_bag(cut_bag)
