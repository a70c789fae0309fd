"""A pack appears whole or not at all, and nothing that lay there is touched."""

from pathlib import Path

import pytest

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.pack_writing import PackWriter


def test_nothing_is_left_of_a_pack_that_was_interrupted(tmp_path: Path) -> None:
    def interrupted() -> None:
        with PackWriter(tmp_path / "new" / "pack") as writer:
            writer.rows("errors/a.jsonl.gz", [{"a": 1}])
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []


def test_an_empty_folder_is_filled_and_its_files_are_listed(tmp_path: Path) -> None:
    with PackWriter(tmp_path) as writer:
        writer.meta()
        assert not list(tmp_path.iterdir())
    assert sorted(path.name for path in tmp_path.iterdir()) == ["SHA256SUMS", "meta.json"]
    assert (tmp_path / "SHA256SUMS").read_text().endswith("  meta.json\n")


def test_what_lies_there_stays_even_where_it_came_in_between(tmp_path: Path) -> None:
    out = tmp_path / "pack"

    def late() -> None:
        with PackWriter(out) as writer:
            writer.meta()
            out.mkdir()
            (out / "mine.txt").write_text("mine")

    with pytest.raises(BadFileError, match="cannot move the pack"):
        late()
    assert [path.name for path in tmp_path.rglob("*")] == ["pack", "mine.txt"]
    with pytest.raises(BadFileError, match="holds something already"):
        PackWriter(out)
