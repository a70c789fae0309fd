"""`robustnav data homes` writes homes that it reads again, and tells what is wrong with others."""

from pathlib import Path

import pytest
from PIL import Image
from typer.testing import CliRunner

from robustnav_msgs_py.errors import BadFileError, BadParameterError, BadSceneError
from robustnav_nodes.benchmarks.data_commands import data_app

pytest.importorskip("pybullet")
RUN = CliRunner()


def run(*arguments: str | Path) -> str:
    result = RUN.invoke(data_app, ["homes", *map(str, arguments)], catch_exceptions=False)
    assert result.exit_code == 0
    return result.output


def test_homes_are_written_drawn_and_found_sound(tmp_path: Path) -> None:
    out = run("--seed", "5", "--count", "2", "--difficulty", "easy", "--out", tmp_path)
    scenes = sorted(tmp_path.glob("*.yaml"))
    assert [scene.name for scene in scenes] == ["home-5.yaml", "home-6.yaml"]
    assert out.count("1 rooms") == 2
    for scene in scenes:
        with Image.open(scene.with_suffix(".jpg")) as picture:
            assert picture.width == 1200
    checked = run(*(part for scene in scenes for part in ("--check", scene)), "--out", tmp_path / "drawn")
    assert checked.count(": sound") == 2
    assert len(list((tmp_path / "drawn").glob("*.jpg"))) == 2


def test_what_is_there_is_not_overwritten(tmp_path: Path) -> None:
    run("--seed", "5", "--difficulty", "easy", "--out", tmp_path)
    before = (tmp_path / "home-5.yaml").read_bytes()
    with pytest.raises(BadFileError, match=r"home-5\.yaml"):
        run("--seed", "5", "--rooms", "2", "--out", tmp_path)
    assert (tmp_path / "home-5.yaml").read_bytes() == before


def test_a_home_that_does_not_hold_together_is_named_with_its_file(tmp_path: Path) -> None:
    run("--seed", "5", "--difficulty", "easy", "--out", tmp_path)
    scene = tmp_path / "home-5.yaml"
    lines = scene.read_text(encoding="utf-8").splitlines()
    start = next(at for at, line in enumerate(lines) if line.startswith("start:"))
    lines[start] = "start: [0.0, 0.0, 0]"
    scene.write_text("\n".join(lines), encoding="utf-8")
    with pytest.raises(BadSceneError, match=r"home-5\.yaml.*cannot start"):
        run("--check", scene)


def test_wrong_usage_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(BadParameterError, match="--out FOLDER"):
        run("--seed", "5")
    with pytest.raises(BadFileError, match="nowhere"):
        run("--check", tmp_path / "nowhere.yaml")
    with pytest.raises(BadSceneError, match="unicorn"):
        run("--look-alikes", "unicorn", "--out", tmp_path)
