import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.benchmarks.export_pomp import TARGET_ID, export_pomp
from robustnav_nodes.benchmarks.import_pomp import import_pomp
from robustnav_nodes.benchmarks.pose_layout import lay_out
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene, SearchTarget
from robustnav_nodes.search_space.candidates import Candidates
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action, PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

# Two places with four headings each, their rows mixed; from the first place one moves ahead to the second.
# Heading 0, 90, 180, 270 degrees: rows 0, 3, 4, 7 at the first place, rows 1, 2, 5, 6 at the second.
FILES = {
    "ListView.txt": "".join(f"{row:015d}.jpg\n" for row in range(8)) + "\n",
    "MatrixG.txt": (
        "3 7 1 -1 -1 -1\n2 6 -1 0 -1 -1\n5 1 -1 -1 -1 -1\n4 0 -1 -1 -1 -1\n"
        "7 3 -1 5 -1 -1\n6 2 4 -1 -1 -1\n1 5 -1 -1 -1 -1\n0 4 -1 -1 -1 -1\n"
    ),
    "MatrixL_gt.txt": "0 0 1\n0 1 1\n" + "0 0 0\n" * 6,
    "MatrixL_dt.txt": "0 0 1\n0 0 0\n0 0 1\n0 0 1\n" + "0 0 0\n" * 4,
    # Cell 1 is outside, nobody sees cell 4, pose 3 sees nothing: candidates are cells 0, 2 and 3.
    "ObservMatrix.txt": "1 1 1 0 0\n01110\n00010\n00000\n" + "1 0 0 0 0\n" * 4,
    "GaussObsvMatrix.txt": "0.1 0.5 0.4 0 0\n" + "0.2 0.2 0.2 0.2 0.2\n" + "0 0 0 0 1\n" * 6,
    "particles_that_are_inside_home.txt": "1 0 1\n1 1\n",
    "detector_stat.json": json.dumps(
        {"1": {"precision": None}, "2": {"precision": 0.8, "recall": 0.5, "TP": 4}, "9": {}}
    ),
    "instance_id_map.txt": "background 0\nred mug 2 \n",
}


@pytest.fixture
def folder(tmp_path) -> Path:
    made = tmp_path / "Home_001_1"
    made.mkdir()
    for name, text in FILES.items():
        (made / name).write_text(text, encoding="utf-8")
    return made


def test_a_folder_worked_by_hand(folder):
    scene = import_pomp(folder, 2)
    graph, target = scene.space.graph, scene.targets[0]
    assert (scene.name, scene.difficulty, target.label) == ("Home_001_1", "Home_001_1", "red mug")
    assert (len(graph), len(scene.space.candidates), len(scene.starts)) == (8, 3, 0)
    assert graph.successors[0].tolist() == [1, NOWHERE, 3, 7]
    assert graph.successors[5].tolist() == [4, NOWHERE, 6, 2]
    assert [scene.space.observability.seen_by(pose).tolist() for pose in range(4)] == [
        [0, 1],
        [1, 2],
        [2],
        [],
    ]
    assert np.nonzero(target.in_view)[0].tolist() == [0, 1]
    assert target.destination is None


def test_detections_follow_the_gauss_row_where_it_says_something(folder):
    """Pose 0 follows its row, within what is in view; pose 2's row is 0 there; pose 3 has nothing in view."""
    detections = import_pomp(folder, 2).targets[0].detections
    assert detections["noisy"].pose.tolist() == [0, 2]
    np.testing.assert_allclose(detections["noisy"].at(0, 3), [[0.25, 1.0, 0.0]])
    assert detections["noisy"].at(2, 3).tolist() == [[0.0, 0.0, 1.0]]
    assert detections["noisy"].statistics == ClassStatistics(precision=0.8, recall=0.5)
    assert detections["perfect"].pose.tolist() == [0, 1]
    assert detections["perfect"].at(0, 3).tolist() == [[1.0, 1.0, 0.0]]
    assert detections["perfect"].statistics.f1 == 1.0


def test_a_target_without_a_name_goes_by_its_number(folder):
    (folder / "instance_id_map.txt").unlink()
    assert import_pomp(folder, 2).targets[0].label == "object 2"


def test_coordinates_are_made_up_from_the_moves(folder):
    """Four turns make a circle; the second place lies one step ahead of pose 0."""
    graph = import_pomp(folder, 2).space.graph
    assert graph.headings == 4
    np.testing.assert_allclose(np.degrees(graph.yaw_rad), [0, 0, 90, 90, 180, 180, 270, 270])
    np.testing.assert_allclose(graph.x_m - graph.x_m[0], [0, 0.3, 0.3, 0, 0, 0.3, 0.3, 0], atol=1e-12)
    np.testing.assert_allclose(graph.y_m, 0.0, atol=1e-12)


def test_candidates_are_drawn_ahead_of_who_sees_them(folder):
    """Only pose 2 (second place, heading 90 degrees) and pose 1 (heading 0) see the last cell."""
    space = import_pomp(folder, 2).space
    x_m, y_m = space.graph.x_m[1] + 1.0, space.graph.y_m[1] + 1.0
    assert (space.candidates.x_m[2], space.candidates.y_m[2]) == pytest.approx((x_m, y_m))


def test_a_way_closes_for_all_headings_also_where_rows_are_mixed(folder):
    graph = import_pomp(folder, 2).space.graph
    closed = graph.without_way(1, 0)
    assert np.argwhere(closed.successors != graph.successors).tolist() == [
        [0, Action.FORWARD],
        [1, Action.BACKWARD],
        [4, Action.BACKWARD],
        [5, Action.FORWARD],
    ]


def test_nowhere_to_turn_means_twelve_headings():
    layout = lay_out(np.array([[1, -1, -1, -1], [-1, 0, -1, -1]], dtype=np.int32))
    assert layout.headings == 12
    assert layout.x_m[1] - layout.x_m[0] == pytest.approx(0.3)


@given(poses=st.integers(1, 40), links=st.floats(0.0, 1.0), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=150, deadline=None)
def test_no_two_poses_of_any_graph_lie_on_each_other(poses, links, seed):
    """So a pose is found again by its coordinates, however little the graph makes sense."""
    rng = np.random.default_rng(seed)
    successors = rng.integers(0, poses, size=(poses, 4), dtype=np.int32)
    successors[rng.random((poses, 4)) >= links] = NOWHERE
    graph = PoseGraph(successors=successors, **lay_out(successors)._asdict())
    assert [graph.nearest(graph.pose(pose)) for pose in range(poses)] == list(range(poses))


@given(headings=st.sampled_from([4, 8, 12]), seed=st.integers(0, 2**32 - 1))
@settings(max_examples=40, deadline=None)
def test_turns_stay_in_place_and_moves_follow_the_heading(headings, seed):
    """A corridor of five places, its rows in any order, in which the walk has one way only."""
    rng = np.random.default_rng(seed)
    row = rng.permutation(5 * headings).reshape(5, headings)
    successors = np.full((5 * headings, 4), NOWHERE, dtype=np.int32)
    successors[row, Action.TURN_LEFT] = np.roll(row, -1, axis=1)
    successors[row, Action.TURN_RIGHT] = np.roll(row, 1, axis=1)
    successors[row[:-1, 0], Action.FORWARD] = row[1:, 0]
    successors[row[1:, 0], Action.BACKWARD] = row[:-1, 0]
    layout = lay_out(successors)
    assert layout.headings == headings
    assert np.all(layout.x_m[row] == layout.x_m[row[:, :1]])
    turned = np.exp(1j * (layout.yaw_rad[np.roll(row, -1, axis=1)] - layout.yaw_rad[row]))
    np.testing.assert_allclose(turned, np.exp(2j * np.pi / headings), atol=1e-9)
    place = (layout.x_m + 1j * layout.y_m)[row[:, 0]]
    np.testing.assert_allclose(np.diff(place), 0.3 * np.exp(1j * layout.yaw_rad[row[0, 0]]), atol=1e-9)


def replaced(name: str, line: int, text: str) -> Callable[[Path], None]:
    """A change of one line of one file."""

    def change(folder: Path) -> None:
        lines = FILES[name].splitlines()
        lines[line - 1] = text
        (folder / name).write_text("\n".join(lines), encoding="utf-8")

    return change


def whole(name: str, text: str | bytes | None) -> Callable[[Path], None]:
    """Another content of one file; None: no file."""

    def change(folder: Path) -> None:
        (folder / name).unlink()
        if text is not None:
            (folder / name).write_bytes(text.encode() if isinstance(text, str) else text)

    return change


BAD = [
    *[
        (whole(name, None), f"cannot read .*{name}.*No such file")
        for name in FILES
        if name != "instance_id_map.txt"
    ],
    (whole("ListView.txt", "\n\n"), "names no image"),
    (whole("ListView.txt", b"\xff\xfe"), "is not text"),
    (whole("MatrixG.txt", FILES["MatrixG.txt"] + "0 0 0 0\n"), "MatrixG.txt' has 9 rows, ListView.txt has 8"),
    (replaced("MatrixG.txt", 3, "1 1 1"), "line 3 of .*MatrixG.txt' has 3 columns: it needs 4 to 6"),
    (replaced("MatrixG.txt", 3, "1 8 -1 -1"), "line 3 .* holds '8': a successor is a row, 0 to 7, or -1"),
    (replaced("MatrixG.txt", 3, "1 -2 -1 -1"), "holds '-2'"),
    (replaced("MatrixG.txt", 3, "1 1.0 -1 -1"), r"holds '1\.0'"),
    (whole("MatrixL_gt.txt", "0 0 1\n"), "MatrixL_gt.txt' has 1 rows"),
    (
        replaced("MatrixL_gt.txt", 2, "0 2 1"),
        "line 2 of .*MatrixL_gt.txt' holds '2': it may hold 0 and 1 only",
    ),
    (replaced("MatrixL_dt.txt", 5, "0 0"), "line 5 of .*MatrixL_dt.txt' has 2 columns, not 3"),
    (replaced("ObservMatrix.txt", 2, "0111"), "line 2 of .*ObservMatrix.txt' has 4 columns, not 5"),
    (replaced("ObservMatrix.txt", 1, ""), "line 1 of .*ObservMatrix.txt' is empty"),
    (replaced("GaussObsvMatrix.txt", 4, "0 0 0 -1 0"), "line 4 of .*GaussObsvMatrix.txt' holds '-1'"),
    (replaced("GaussObsvMatrix.txt", 4, "0 0 0 nan 0"), "holds 'nan': factors of a belief are finite"),
    (replaced("GaussObsvMatrix.txt", 4, "0 0 0 much 0"), "line 4 .* holds no number: .*'much'"),
    (replaced("GaussObsvMatrix.txt", 4, "0 0 0 0"), "line 4 .* has 4 columns, not 5"),
    (whole("particles_that_are_inside_home.txt", "1 0 1 1"), "holds 4 values: .* each of the 5 columns"),
    (whole("particles_that_are_inside_home.txt", "1 0 1 1 yes"), "holds 'yes'"),
    (
        whole("particles_that_are_inside_home.txt", "0 0 0 0 1"),
        "no cell of .* is both inside the home and in",
    ),
    (whole("detector_stat.json", "{"), "detector_stat.json' is not JSON"),
    (whole("detector_stat.json", "[1]"), r"must hold a JSON object, not \[1\]"),
    (whole("detector_stat.json", '{"2": {"precision": 1}}'), "object '2' .* must be {'precision': 0..1"),
    (whole("detector_stat.json", '{"2": {"precision": 80, "recall": 60}}'), "precision is 80.0; it must lie"),
    (whole("detector_stat.json", '{"2": {"precision": true, "recall": 1}}'), "must be {'precision': 0..1"),
    (whole("instance_id_map.txt", "mug\n"), "line 1 of .*instance_id_map.txt' is 'mug'"),
]


@pytest.mark.parametrize(("change", "sentence"), BAD, ids=[sentence for _, sentence in BAD])
def test_what_is_wrong_is_said_in_a_sentence(folder, change, sentence):
    change(folder)
    with pytest.raises(BadFileError, match=sentence):
        import_pomp(folder, 2)


@pytest.mark.parametrize("target_id", [0, 3, 9, -1])
def test_an_object_of_which_too_little_is_known_is_refused(folder, target_id):
    """0 is in nobody's view, 3 has no column, 9 statistics only."""
    with pytest.raises(BadFileError, match=rf"object {target_id} cannot be looked for .* choose of \[1, 2\]"):
        import_pomp(folder, target_id)


def scene_of(seed: int) -> SearchScene:
    """Any graph; every candidate is in view somewhere, and the detector fires where something is."""
    rng = np.random.default_rng(seed)
    poses, candidates = int(rng.integers(2, 15)), int(rng.integers(1, 12))
    visible = rng.random((poses, candidates)) < 0.4
    visible[rng.integers(0, poses, size=candidates), np.arange(candidates)] = True
    in_view = visible[:, rng.integers(candidates)]
    fired = np.nonzero(visible.any(axis=1) & (rng.random(poses) < 0.5))[0]
    seen = [np.nonzero(visible[pose])[0] for pose in fired]
    successors = rng.integers(-1, poses, size=(poses, 4), dtype=np.int32)
    space = SearchSpace(
        graph=PoseGraph(successors=successors, **lay_out(successors)._asdict()),
        candidates=Candidates(x_m=np.zeros(candidates), y_m=np.zeros(candidates), size_m=0.2),
        observability=Observability.of_rows(
            np.concatenate([[0], np.cumsum(visible.sum(axis=1))]),
            np.nonzero(visible)[1].astype(np.int32),
            candidates,
        ),
    )
    record = DetectionRecord(
        statistics=ClassStatistics(precision=float(rng.random()), recall=float(rng.random())),
        pose=fired.astype(np.int32),
        start=np.cumsum([0, *map(len, seen)]),
        candidate=np.concatenate([[], *seen]).astype(np.int32),
        weight=np.concatenate([[], *(np.append(1.0, rng.random(len(part) - 1)) for part in seen)]),
    )
    target = SearchTarget(label="red mug", in_view=in_view, destination=in_view, detections={"noisy": record})
    none = np.zeros(0, dtype=np.int32)
    return SearchScene(name="any", difficulty="easy", space=space, targets=(target,), starts=none)


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=60, deadline=None)
def test_what_is_exported_comes_back(tmp_path_factory, seed):
    scene = scene_of(seed)
    folder = tmp_path_factory.mktemp("export") / "scene"
    export_pomp(scene, "red mug", "noisy", folder)
    back = import_pomp(folder, TARGET_ID)
    target, again = scene.targets[0], back.targets[0]
    record, record_again = target.detections["noisy"], again.detections["noisy"]
    np.testing.assert_array_equal(back.space.graph.successors, scene.space.graph.successors)
    np.testing.assert_array_equal(back.space.observability.seen, scene.space.observability.seen)
    np.testing.assert_array_equal(back.space.observability.seen_start, scene.space.observability.seen_start)
    np.testing.assert_array_equal(again.in_view, target.in_view)
    np.testing.assert_array_equal(record_again.pose, record.pose)
    np.testing.assert_array_equal(record_again.candidate, record.candidate)
    np.testing.assert_allclose(record_again.weight, record.weight, rtol=1e-7)
    assert record_again.statistics == record.statistics
    assert again.label == "red mug"


@given(seed=st.integers(0, 2**32 - 1))
@settings(max_examples=30, deadline=None)
def test_every_exported_factor_can_multiply_a_belief(tmp_path_factory, seed):
    """Rows sum to one; where nothing fired, in view and outside stand as 1 - F1 and F1."""
    scene = scene_of(seed)
    folder = tmp_path_factory.mktemp("export") / "scene"
    export_pomp(scene, "red mug", "noisy", folder)
    factors = np.loadtxt(folder / "GaussObsvMatrix.txt", ndmin=2)
    np.testing.assert_allclose(factors.sum(axis=1), 1.0, rtol=1e-7)
    record, observability = scene.targets[0].detections["noisy"], scene.space.observability
    f1 = record.statistics.f1
    for pose in set(range(observability.poses)) - set(record.pose.tolist()):
        in_view = observability.row(pose)
        if in_view.any() and not in_view.all():
            ratio = factors[pose, in_view][0] / factors[pose, ~in_view][0]
            assert ratio == pytest.approx((1.0 - f1) / f1, rel=1e-6)


def test_the_released_planner_can_read_the_export(tmp_path):
    """It counts one pose more for a newline at the end of the list, and stumbles over two blanks in a row."""
    scene = scene_of(3)
    export_pomp(scene, "red mug", "noisy", tmp_path / "out")
    texts = {path.name: path.read_text(encoding="utf-8") for path in (tmp_path / "out").iterdir()}
    assert texts["ListView.txt"].count("\n") + 1 == len(scene.space.graph)
    for name in ("MatrixG.txt", "GaussObsvMatrix.txt", "MatrixL_dt.txt"):
        assert "  " not in texts[name]
        assert " \n" not in texts[name]
    assert all(len(line.split()) == 6 for line in texts["MatrixG.txt"].splitlines())


def test_what_cannot_be_exported_is_refused(tmp_path):
    scene = scene_of(1)
    with pytest.raises(
        BadParameterError, match=r"no target 'cup' in scene 'any': choose one of \['red mug'\]"
    ):
        export_pomp(scene, "cup", "noisy", tmp_path / "out")
    with pytest.raises(BadParameterError, match=r"no detector 'perfect' .* choose one of \['noisy'\]"):
        export_pomp(scene, "red mug", "perfect", tmp_path / "out")
    with pytest.raises(BadFileError, match="exists already"):
        export_pomp(scene, "red mug", "noisy", tmp_path)
    with pytest.raises(BadFileError, match="cannot write the folder"):
        export_pomp(scene, "red mug", "noisy", tmp_path / "missing" / "out")
