import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from typer.testing import CliRunner, Result

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.benchmarks.data_commands import data_app
from robustnav_nodes.benchmarks.scene_file import read_scene
from robustnav_nodes.search_space.nav2_map import write_nav2_map

POMP = {
    "ListView.txt": "a.jpg\nb.jpg\n",
    "MatrixG.txt": "1 1 -1 -1\n0 0 -1 -1\n",
    "MatrixL_gt.txt": "1 0\n0 0\n",
    "MatrixL_dt.txt": "1 0\n1 0\n",
    "ObservMatrix.txt": "10\n11\n",
    "GaussObsvMatrix.txt": "1 0\n0.5 0.5\n",
    "particles_that_are_inside_home.txt": "1 1\n",
    "detector_stat.json": '{"0": {"precision": 0.5, "recall": 1}}',
    "instance_id_map.txt": "[b]mug[/b] 0\n",
}


@pytest.fixture
def pomp(tmp_path) -> Path:
    folder = tmp_path / "home"
    folder.mkdir()
    for name, text in POMP.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.fixture
def avd(tmp_path) -> Path:
    folder = tmp_path / "Home_001_1"
    folder.mkdir()
    annotations = {"a.jpg": {"bounding_boxes": [[900, 0, 1000, 9, 5, 1]]}}
    (folder / "annotations.json").write_text(json.dumps(annotations), encoding="utf-8")
    struct = {"image_name": "a.jpg", "world_pos": np.zeros((3, 1)), "direction": np.array([[1.0], [0], [0]])}
    savemat(folder / "image_structs.mat", {"image_structs": struct, "scale": 1000.0})
    return folder


@pytest.fixture
def robustnav_data() -> Callable[..., Result]:
    """Runs `robustnav data ...`; errors come through, as they do to the command line's own handler."""

    def run(*arguments: object) -> Result:
        result = CliRunner().invoke(data_app, [str(argument) for argument in arguments])
        if result.exception is not None and not isinstance(result.exception, SystemExit):
            raise result.exception
        return result

    return run


def test_pomp_comes_in_and_goes_out(robustnav_data, pomp, tmp_path):
    """One line each, whatever marks a label holds; what came in goes out and comes in again the same."""
    scene, back = tmp_path / "scene.npz", tmp_path / "back"
    result = robustnav_data("import", "pomp", pomp, "--target-id", 0, "--out", scene)
    line = "scene home, 2 poses, 2 candidates, 1 target ([b]mug[/b])"
    assert (result.exit_code, result.output) == (0, f"{scene}: {line}\n")
    result = robustnav_data("export", "pomp", scene, "--target", "[b]mug[/b]", "--out", back)
    assert (result.exit_code, result.output) == (0, f"{back}: {line}; [b]mug[/b] is --target_id=0\n")
    assert (back / "ObservMatrix.txt").read_text() == POMP["ObservMatrix.txt"]
    assert (back / "MatrixL_dt.txt").read_text() == "1\n1\n"


def test_avd_comes_in(robustnav_data, avd, tmp_path):
    scene = tmp_path / "scene.npz"
    result = robustnav_data("import", "avd", avd, "--out", scene)
    candidates = len(read_scene(scene).space.candidates)
    assert candidates > 100
    assert (
        result.output == f"{scene}: scene Home_001_1, 1 pose, {candidates} candidates, 1 target (object 5)\n"
    )


def test_what_fails_is_a_sentence_and_writes_nothing(robustnav_data, pomp, tmp_path):
    scene = tmp_path / "scene.npz"
    with pytest.raises(BadFileError, match="object 1 cannot be looked for"):
        robustnav_data("import", "pomp", pomp, "--target-id", 1, "--out", scene)
    with pytest.raises(BadFileError, match=r"cannot read .*annotations\.json"):
        robustnav_data("import", "avd", pomp, "--out", scene)
    assert not scene.exists()
    robustnav_data("import", "pomp", pomp, "--target-id", 0, "--out", scene)
    with pytest.raises(BadFileError, match="exists already"):
        robustnav_data("import", "pomp", pomp, "--target-id", 0, "--out", scene)
    with pytest.raises(BadParameterError, match="no target 'cup'"):
        robustnav_data("export", "pomp", scene, "--target", "cup", "--out", tmp_path / "out")
    with pytest.raises(BadParameterError, match="no detector 'yolo'"):
        robustnav_data(
            "export", "pomp", scene, "--target", "[b]mug[/b]", "--detector", "yolo", "--out", tmp_path / "out"
        )
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("arguments", [("import", "pomp", "x"), ("import", "avd"), ("export", "pomp", "x")])
def test_wrong_usage_exits_with_2(robustnav_data, arguments):
    assert robustnav_data(*arguments).exit_code == 2


def test_a_nav2_map_becomes_a_scene_to_search_in(tmp_path):
    """A room with a table in it, saved as Nav2 saves maps; what borders the floor can hold the targets."""
    cells = np.full((60, 80), 100, dtype=np.int8)
    cells[2:-2, 2:-2] = 0
    cells[25:35, 30:50] = 100
    floor_map = OccupancyMap(cells=cells, resolution_m=0.05, origin=Pose2D(x_m=-1.0, y_m=-1.0))
    write_nav2_map(floor_map, tmp_path / "office.yaml")
    done = CliRunner().invoke(
        data_app, ["import", "nav2-map", str(tmp_path / "office.yaml"), "--out", str(tmp_path / "office.npz")]
    )
    assert done.exit_code == 0, done.output
    scene = read_scene(tmp_path / "office.npz")
    assert (scene.name, scene.difficulty, len(scene.targets)) == ("office", "nav2-map", 33)
    assert len(scene.space.graph) > 100
