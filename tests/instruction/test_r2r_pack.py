"""The pack's numbers arrive in the project's frames, and a line that is wrong is named."""

import gzip
import json
import math
import os
from pathlib import Path
from typing import Any

import pytest

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.r2r_pack import R2rPack
from tests.instruction.pack_files import write_episodes, write_pack

EPISODE: dict[str, Any] = {
    "id": "0_0_p",
    "label": 1,
    "tokens": ["turn", "left", "at", "the", "couch"],
    "errors": [
        {
            "pos": 1,
            "len": 1,
            "kind": "direction",
            "orig": "right",
            "new": "left",
            "frm": "left/right",
            "to": "left/right",
        }
    ],
    "path_id": 0,
    "instr": 0,
    "scan": "home",
    "type": "direction",
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_pack(tmp_path / "pack")


def change(path: Path, old: str, new: str) -> None:
    text = gzip.decompress(path.read_bytes()).decode()
    assert old in text
    path.write_bytes(gzip.compress(text.replace(old, new).encode()))


def test_frames(folder: Path) -> None:
    """North is +y: a yaw of 90 degrees; then a turn to the right; the bed is ahead, the sofa to the left."""
    walk = R2rPack(folder).paths("train")[0].trajectory
    first, second, third = walk.viewpoints
    assert first.yaw_in_rad == pytest.approx(math.pi / 2.0)
    assert second.turn_rad == pytest.approx(-math.pi / 2.0)
    assert third.turn_rad == 0.0
    bed, sofa = first.objects
    assert (bed.name, bed.bearing_rad, sofa.name) == ("bed", pytest.approx(0.0), "sofa")
    assert sofa.bearing_rad is not None
    assert 0.0 < sofa.bearing_rad < math.pi / 4.0
    assert second.objects[0].bearing_rad is None
    assert sum(third.rooms) == pytest.approx(1.0)


def test_instructions_and_common_sense(folder: Path) -> None:
    pack = R2rPack(folder)
    said = pack.instructions("train")
    assert [one.key for one in said] == ["0_0", "1_0"]
    assert "kitchen" in pack.common_sense().rooms["bedroom"]


def test_episodes(folder: Path) -> None:
    write_episodes(folder, [EPISODE])
    (episode,) = R2rPack(folder).episodes("val_seen", "uniform", "direction")
    assert (episode.label, episode.wrong[0].right, episode.wrong[0].wrong) == (1, "right", "left")


@pytest.mark.parametrize(
    ("field", "value"),
    [("pos", 9), ("pos", "one"), ("kind", "colour"), ("len", 0), ("new", "port")],
)
def test_a_wrong_error_is_named(folder: Path, field: str, value: object) -> None:
    error = {**EPISODE["errors"][0], field: value}
    write_episodes(folder, [{**EPISODE, "errors": [error]}])
    with pytest.raises(BadFileError, match=r"line 1 of .*val_seen_direction"):
        R2rPack(folder).episodes("val_seen", "uniform", "direction")


@pytest.mark.parametrize(("field", "value"), [("label", 0), ("scan", "hut"), ("type", "room")])
def test_an_episode_that_does_not_fit_its_walk_is_named(folder: Path, field: str, value: object) -> None:
    write_episodes(folder, [{**EPISODE, field: value}])
    with pytest.raises(BadFileError, match=rf"line 1 of .*val_seen_direction.* holds '{field}'"):
        R2rPack(folder).episodes("val_seen", "uniform", "direction")


@pytest.mark.parametrize(
    "name", ["meta.json", "viewpoints.jsonl.gz", "objects3d.jsonl.gz", "graph.jsonl.gz", "rooms.jsonl.gz"]
)
def test_a_missing_file_is_named(folder: Path, name: str) -> None:
    (folder / name).unlink()
    with pytest.raises(BadFileError, match=name):
        R2rPack(folder)


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        ("viewpoints.jsonl.gz", '"x": 0.0', '"x": "far"', "line 1"),
        ("viewpoints.jsonl.gz", '"objects"', '"things"', "no field 'objects'"),
        ("viewpoints.jsonl.gz", '["bed", 0.0', '["bed", "north"', "angles"),
        ("rooms.jsonl.gz", "0.89, ", "", "12 numbers"),
        ("graph.jsonl.gz", "[1, 2]]", "[1, 7]]", "numbers below 3"),
        ("r2r_train.jsonl.gz", '"a", "b"', '"a", "z"', "'z'"),
        ("r2r_train.jsonl.gz", "{", "", "not JSON"),
        ("r2r_train.jsonl.gz", '"path_id": 1', '"path_id": 0', "another number than the paths before"),
        ("r2r_train.jsonl.gz", '"scan": "home"', '"scan": "hut"', "the scan of viewpoint 'a', 'home'"),
        ("r2r_train.jsonl.gz", '"heading": 0.0', '"heading": 1' + "0" * 400, "a finite number"),
        ("viewpoints.jsonl.gz", '["bed", 0.0', '["bed", NaN', "finite numbers or null"),
    ],
)
def test_a_wrong_field_is_named(folder: Path, name: str, old: str, new: str, said: str) -> None:
    change(folder / name, old, new)
    with pytest.raises(BadFileError, match=said):
        R2rPack(folder).paths("train")


def test_a_cut_file_is_named(folder: Path) -> None:
    path = folder / "rooms.jsonl.gz"
    path.write_bytes(path.read_bytes()[:-20])
    with pytest.raises(BadFileError, match="unpacked"):
        R2rPack(folder)


def test_a_changed_file_is_named(folder: Path) -> None:
    (folder / "SHA256SUMS").write_text("0" * 64 + "  rooms.jsonl.gz\n")
    with pytest.raises(BadFileError, match="SHA256SUMS"):
        R2rPack(folder)


def test_no_pack_and_no_split(folder: Path) -> None:
    with pytest.raises(BadFileError, match="no pack"):
        R2rPack(folder / "nowhere")
    with pytest.raises(BadFileError, match="it has train, val_seen"):
        R2rPack(folder).paths("val_unseen")
    meta = json.loads((folder / "meta.json").read_text())
    (folder / "meta.json").write_text(json.dumps({**meta, "rooms": ["castle"]}))
    with pytest.raises(BadFileError, match="castle"):
        R2rPack(folder)


@pytest.mark.skipif("ROBUSTNAV_R2R_PACK" not in os.environ, reason="ROBUSTNAV_R2R_PACK names no pack")
def test_the_real_pack() -> None:
    """People's instructions: tokens agree with the pack's, and each error is one of our mentions."""
    from robustnav_nodes.instruction.mentions import find_mentions

    pack = R2rPack(Path(os.environ["ROBUSTNAV_R2R_PACK"]))
    split = pack.splits[-1]
    said = {one.key: one.tokens for one in pack.instructions(split)}
    missed = wrong = 0
    for episode in pack.episodes(split, "uniform", "all"):
        if not episode.wrong:
            assert said[episode.key.rsplit("_", 1)[0]] == episode.tokens
        starts = {mention.start for mention in find_mentions(episode.tokens)}
        missed += sum(span.start not in starts for span in episode.wrong)
        wrong += len(episode.wrong)
    assert wrong > 100
    assert missed <= 0.01 * wrong
