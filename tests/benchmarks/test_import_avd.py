import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.import_avd import CENTRE_PX, FOCAL_PX, import_avd, where_bearings_meet
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action

HEADINGS = 12
PLACES = [(0.0, 0.0), (0.6, 0.0), (1.2, 0.0), (0.0, 0.6), (0.6, 0.6)]  # x, y on the floor, metres
MUG, SHOE = 7, 3
OBJECTS = {MUG: (0.7, 2.6), SHOE: (3.1, 0.2)}
MM_PER_UNIT = 400.0


def name_of(place: int, heading: int) -> str:
    return f"{place * HEADINGS + heading:06d}.jpg"


def box_of(place: int, heading: int, instance: int) -> list[float] | None:
    """What a camera sees that has the dataset's intrinsics; a mug is 10 cm wide."""
    (x_m, y_m), yaw_rad = PLACES[place], heading * math.tau / HEADINGS
    dx, dy = OBJECTS[instance][0] - x_m, OBJECTS[instance][1] - y_m
    ahead, left = (
        dx * math.cos(yaw_rad) + dy * math.sin(yaw_rad),
        dy * math.cos(yaw_rad) - dx * math.sin(yaw_rad),
    )
    if ahead <= 0.3:
        return None
    middle, half = CENTRE_PX - FOCAL_PX * left / ahead, 0.05 * FOCAL_PX / ahead
    return [middle - half, 500.0, middle + half, 600.0, instance, 1] if 0 < middle < 1920 else None


def annotations() -> dict[str, dict]:
    content = {}
    for place, (x_m, y_m) in enumerate(PLACES):
        for heading in range(HEADINGS):
            boxes = [box_of(place, heading, instance) for instance in OBJECTS]
            content[name_of(place, heading)] = {
                "bounding_boxes": [box for box in boxes if box is not None],
                "rotate_ccw": name_of(place, (heading + 1) % HEADINGS),
                "rotate_cw": name_of(place, (heading - 1) % HEADINGS),
                "forward": "",
                "backward": "",
                "left": "",
                "right": "",
            }
        for other, ahead in enumerate(PLACES):
            if ahead == (x_m + 0.6, y_m):
                content[name_of(place, 0)]["forward"] = name_of(other, 0)
    for name, entry in content.items():
        if entry["forward"]:
            content[entry["forward"]]["backward"] = name
    return content


def cameras(up: float = 1.0) -> list[tuple]:
    """Positions and directions, y pointing up (1) or down (-1); millimetres of jitter about each place."""
    rng = np.random.default_rng(0)
    rows = []
    for place, (x_m, y_m) in enumerate(PLACES):
        for heading in range(HEADINGS):
            yaw_rad = heading * math.tau / HEADINGS
            jitter_x_m, jitter_y_m = rng.normal(0.0, 0.002, size=2)
            world = np.array([x_m + jitter_x_m, 0.0, -up * (y_m + jitter_y_m)]) * 1000.0 / MM_PER_UNIT
            direction = np.array([math.cos(yaw_rad), 0.02, -up * math.sin(yaw_rad)])
            rows.append((name_of(place, heading), world.reshape(3, 1), direction.reshape(3, 1)))
    return rows


def write_cameras(
    folder: Path, rows: list[tuple], scale: object = MM_PER_UNIT, *, is_compressed: bool = True
) -> None:
    fields = [("image_name", object), ("world_pos", object), ("direction", object)]
    structs = np.array(rows, dtype=fields).reshape(1, -1)
    content = {"image_structs": structs, "scale": scale}
    savemat(folder / "image_structs.mat", content, do_compression=is_compressed)


def write(folder: Path, name: str, content: object) -> None:
    (folder / name).write_text(json.dumps(content), encoding="utf-8")


@pytest.fixture
def folder(tmp_path) -> Path:
    made = tmp_path / "Home_001_1"
    made.mkdir()
    write(made, "annotations.json", annotations())
    write_cameras(made, cameras())
    (tmp_path / "instance_id_map.txt").write_text("blue_mug 7 \nshoe 3 \n", encoding="utf-8")
    return made


@pytest.fixture(params=[1.0, -1.0], ids=["y_up", "y_down"])
def scene(folder, request):
    write_cameras(folder, cameras(up=request.param))
    return import_avd(folder)


def test_poses_stand_where_the_images_were_taken(scene):
    """Whichever way y points: the turns tell which side is above. The origin stays the dataset's."""
    graph = scene.space.graph
    assert (scene.name, scene.difficulty, len(graph), graph.headings) == ("Home_001_1", "avd", 60, 12)
    np.testing.assert_allclose(graph.x_m[::HEADINGS], [x_m for x_m, _ in PLACES], atol=0.003)
    np.testing.assert_allclose(graph.y_m[::HEADINGS], [y_m for _, y_m in PLACES], atol=0.003)
    np.testing.assert_allclose(graph.yaw_rad[:HEADINGS], np.arange(HEADINGS) * math.tau / HEADINGS, atol=1e-9)
    assert graph.successors[0].tolist() == [12, NOWHERE, 1, 11]
    assert graph.successors[12, Action.BACKWARD] == 0


def test_a_pose_is_found_again_by_its_coordinates(scene):
    graph = scene.space.graph
    assert [graph.nearest(graph.pose(pose)) for pose in range(len(graph))] == list(range(len(graph)))


def test_candidates_are_what_could_be_seen_and_is_no_floor(scene):
    space = scene.space
    assert space.observability.seen_from_somewhere().all()
    for x_m, y_m in PLACES:
        nearest = np.maximum(np.abs(space.candidates.x_m - x_m), np.abs(space.candidates.y_m - y_m)).min()
        assert nearest >= 0.1 - 0.01
    for pose in range(0, len(space.graph), 7):
        seen = space.observability.seen_by(pose)
        here = space.graph.pose(pose)
        dx, dy = space.candidates.x_m[seen] - here.x_m, space.candidates.y_m[seen] - here.y_m
        off_rad = np.angle(np.exp(1j * (np.arctan2(dy, dx) - here.yaw_rad)))
        assert np.degrees(np.abs(off_rad)).max() <= 30.0 + 1e-6
        assert np.hypot(dx, dy).min() >= 0.5
        assert np.hypot(dx, dy).max() <= 4.0
        assert np.array_equal(np.nonzero(space.visible(here))[0], seen)


def test_targets_are_in_view_where_they_have_a_box(scene):
    assert [target.label for target in scene.targets] == ["shoe", "blue_mug"]
    for target, instance in zip(scene.targets, (SHOE, MUG), strict=True):
        boxes = [box_of(pose // HEADINGS, pose % HEADINGS, instance) for pose in range(60)]
        assert target.in_view.tolist() == [box is not None for box in boxes]


def test_destinations_are_the_nearest_that_see_it(scene):
    """0.5 m farther than the nearest at most, give or take the candidate's 20 cm."""
    for target, instance in zip(scene.targets, (SHOE, MUG), strict=True):
        distance_m = np.array([math.dist(PLACES[pose // HEADINGS], OBJECTS[instance]) for pose in range(60)])
        nearest_m = distance_m[target.in_view].min()
        assert target.destination[target.in_view & (distance_m < nearest_m + 0.3)].all()
        assert not target.destination[~target.in_view | (distance_m > nearest_m + 0.7)].any()


def test_detections_point_at_the_target_and_together_find_it(scene):
    candidates = scene.space.candidates
    for target, (x_m, y_m) in zip(scene.targets, (OBJECTS[SHOE], OBJECTS[MUG]), strict=True):
        record = target.detections["perfect"]
        assert list(target.detections) == ["perfect"]
        assert set(record.pose.tolist()) <= set(np.nonzero(target.in_view)[0].tolist())
        assert record.weight.max() == 1.0
        log_belief = np.zeros(len(candidates))
        for pose in record.pose.tolist():
            density = record.at(pose, len(candidates))[0]
            assert np.all(density[~scene.space.observability.row(pose)] == 0.0)
            log_belief += np.log(np.maximum(density, 1e-6))
        best = int(np.argmax(log_belief))
        assert math.dist((candidates.x_m[best], candidates.y_m[best]), (x_m, y_m)) < 0.45


def test_a_box_beside_the_view_says_nothing(folder):
    """The camera sees 84 degrees, the view has 60: a box at the rim of the image is about no candidate."""
    content = annotations()
    for entry in content.values():
        entry["bounding_boxes"] = []
    content[name_of(0, 0)]["bounding_boxes"] = [[1850, 0, 1860, 9, MUG, 1]]
    write(folder, "annotations.json", content)
    target = import_avd(folder).targets[0]
    assert np.nonzero(target.in_view)[0].tolist() == [0]
    assert len(target.detections["perfect"].pose) == 0


def test_another_detector_is_measured_on_the_scene(folder):
    """It sees the mug in two of the images that show it and in one that does not."""
    right = [pose for pose in range(60) if box_of(pose // HEADINGS, pose % HEADINGS, MUG) is not None]
    wrong = next(pose for pose in range(60) if pose not in right)
    content = {
        name_of(pose // HEADINGS, pose % HEADINGS): {"bounding_boxes": [[900, 0, 1000, 9, MUG]]}
        for pose in (*right[:2], wrong)
    }
    write(folder, "detections.json", content)
    shoe, mug = import_avd(folder).targets
    statistics = mug.detections["noisy"].statistics
    assert (statistics.precision, statistics.recall) == pytest.approx((2 / 3, 2 / len(right)))
    assert mug.detections["noisy"].pose.tolist() == sorted([*right[:2], wrong])
    assert len(shoe.detections["noisy"].pose) == 0
    assert shoe.detections["noisy"].statistics.f1 == 0.0


def test_names_may_be_missing(folder):
    (folder.parent / "instance_id_map.txt").unlink()
    assert [target.label for target in import_avd(folder).targets] == ["object 3", "object 7"]


def test_one_image_is_a_scene(folder):
    image, *_ = cameras()[0]
    write(folder, "annotations.json", {image: {"bounding_boxes": [[900, 0, 1000, 9, MUG, 1]]}})
    write_cameras(folder, cameras()[:1])
    scene = import_avd(folder)
    assert (len(scene.space.graph), scene.space.graph.headings) == (1, 12)
    assert scene.targets[0].destination.tolist() == [True]


@given(
    point=st.tuples(st.floats(-5.0, 5.0), st.floats(-5.0, 5.0)),
    bearing_rad=st.lists(st.floats(-3.1, 3.1), min_size=2, max_size=9),
    away_m=st.floats(0.5, 4.0),
)
@settings(max_examples=200, deadline=None)
def test_bearings_of_a_point_meet_in_it(point, bearing_rad, away_m):
    bearing = np.array(bearing_rad)
    x_m, y_m = point[0] - away_m * np.cos(bearing), point[1] - away_m * np.sin(bearing)
    met = where_bearings_meet(x_m, y_m, bearing)
    if np.ptp(np.abs(np.sin(bearing - bearing[0]))) > 0.2:
        assert met == pytest.approx(point, abs=1e-6)


def test_a_single_bearing_ends_two_metres_ahead():
    met = where_bearings_meet(np.array([1.0]), np.array([1.0]), np.array([math.pi / 2]))
    assert met == pytest.approx((1.0, 3.0))


def entry(image: str, **changes: object) -> dict[str, dict]:
    content = annotations()
    content[image] |= changes
    return content


FIRST = name_of(0, 0)
BAD_ANNOTATIONS = [
    ({}, "names no image"),
    ([], "must hold a JSON object"),
    ({FIRST: 3}, "'forward' of image '000000.jpg' .* is None: it must name an image"),
    (entry(FIRST, forward="nowhere.jpg"), "'forward' of image '000000.jpg' .* is 'nowhere.jpg'"),
    (entry(FIRST, rotate_cw=4), "'rotate_cw' of image .* is 4"),
    (entry(FIRST, bounding_boxes=None), "must hold a list of 'bounding_boxes'"),
    (entry(FIRST, bounding_boxes=[[1, 2, 3, 4]]), r"a box of image .* is \[1, 2, 3, 4\]: it must be xmin"),
    (entry(FIRST, bounding_boxes=[[5, 2, 3, 4, 1]]), "a box of image"),
    (entry(FIRST, bounding_boxes=[[1, 2, 3, 4, 1.5]]), "a box of image"),
    (entry(FIRST, bounding_boxes=[[1, 2, math.nan, 4, 1]]), "a box of image"),
    ({image: row | {"bounding_boxes": []} for image, row in annotations().items()}, "holds no bounding box"),
    (annotations() | {"late.jpg": {"bounding_boxes": []}}, "lacks image 'late.jpg'"),
]


@pytest.mark.parametrize(("content", "sentence"), BAD_ANNOTATIONS)
def test_wrong_annotations_are_refused(folder, content, sentence):
    write(folder, "annotations.json", content)
    with pytest.raises(BadFileError, match=sentence):
        import_avd(folder)


def test_wrong_detections_are_refused(folder):
    write(folder, "detections.json", {"other.jpg": {"bounding_boxes": []}})
    with pytest.raises(BadFileError, match=r"'other\.jpg' .* not among those of annotations\.json"):
        import_avd(folder)


@pytest.mark.parametrize(
    ("first", "scale", "sentence"),
    [
        (cameras()[0], 0.0, r"'scale' .* is 0\.0 mm"),
        (cameras()[0], 1e9, "m apart, more than 200 m: check 'scale'"),
        (cameras()[0], [1.0, 2.0], "does not hold the dataset's 'image_structs' and 'scale'"),
        ((FIRST, np.zeros(2), np.ones(3)), 400.0, r"'world_pos' of image .* is \[0\.0, 0\.0\]|is \[0, 0\]"),
        ((FIRST, np.full(3, np.nan), np.ones(3)), 400.0, "'world_pos' of image .* must be x, y and z"),
        ((FIRST, np.zeros(3), "north"), 400.0, "'direction' of image .* is no vector"),
        ((FIRST, np.zeros(3), np.array([0.0, 1.0, 0.0])), 400.0, "'direction' of image .* is upright"),
    ],
)
def test_wrong_cameras_are_refused(folder, first, scale, sentence):
    write_cameras(folder, [first, *cameras()[1:]], scale)
    with pytest.raises(BadFileError, match=sentence):
        import_avd(folder)


def test_other_mat_files_are_refused(folder):
    path = folder / "image_structs.mat"
    savemat(path, {"x": 1.0})
    with pytest.raises(BadFileError, match=r"does not hold the dataset's .*image_structs"):
        import_avd(folder)
    savemat(path, {"image_structs": np.zeros(3), "scale": 1.0})
    with pytest.raises(BadFileError, match="does not hold the dataset's"):
        import_avd(folder)
    path.unlink()
    with pytest.raises(BadFileError, match=r"cannot read .*image_structs\.mat"):
        import_avd(folder)


@given(share=st.floats(0.0, 1.0, exclude_max=True), is_compressed=st.booleans())
@settings(max_examples=60, deadline=None)
def test_cut_mat_files_are_refused(tmp_path_factory, share, is_compressed):
    folder = tmp_path_factory.mktemp("cut")
    write(folder, "annotations.json", {FIRST: {"bounding_boxes": [[900, 0, 1000, 9, MUG, 1]]}})
    write_cameras(folder, cameras()[:1], is_compressed=is_compressed)
    path = folder / "image_structs.mat"
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(BadFileError):
        import_avd(folder)
