import time
import tracemalloc

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.space import SearchSpace

ORIGIN = Pose2D(x_m=0.0, y_m=0.0)


def test_observability_is_what_the_camera_sees_from_each_pose(two_rooms, parameters):
    space = SearchSpace.build(*two_rooms, parameters)
    rows = np.array([space.visible(space.graph.pose(i)) for i in range(len(space.graph))])
    assert rows.shape == (len(space.graph), len(space.candidates))
    assert 0.0 < rows.mean() < 0.5
    for pose in range(0, len(rows), 7):
        np.testing.assert_array_equal(space.observability.row(pose), rows[pose])
    for candidate in range(rows.shape[1]):
        np.testing.assert_array_equal(space.observability.column(candidate), rows[:, candidate])
    np.testing.assert_array_equal(space.observability.seen_from_somewhere(), rows.any(axis=0))


def test_a_map_without_free_floor_is_refused(parameters):
    unknown = OccupancyMap(cells=np.full((5, 6), -1, dtype=np.int8), resolution_m=0.05, origin=ORIGIN)
    with pytest.raises(BadMapError, match=r"6 x 5 cells has no free floor \(100% of it is unknown\)"):
        SearchSpace.build(unknown, None, parameters)


def test_crossed_thresholds_are_refused(two_rooms):
    with pytest.raises(BadMapError, match=r"free_threshold is 70 and occupied_threshold is 65"):
        SearchSpace.build(*two_rooms, SearchSpaceParameters(free_threshold=70))


def test_a_mask_in_another_frame_is_refused(two_rooms, parameters):
    floor_map, mask = two_rooms
    elsewhere = OccupancyMap(
        cells=mask.cells, resolution_m=mask.resolution_m, origin=mask.origin, frame_id="odom"
    )
    with pytest.raises(BadMapError, match=r"mask is in frame 'odom', the map in 'map'"):
        SearchSpace.build(floor_map, elsewhere, parameters)


def test_candidates_that_no_pose_sees_are_refused(drawn, parameters):
    floor_map, mask = drawn(".....#...o", ".....#...o", ".....#...o")
    with pytest.raises(BadMapError, match=r"none of the .* candidate locations can be seen"):
        SearchSpace.build(floor_map, mask, parameters, Pose2D(x_m=0.5, y_m=0.5))


def test_too_large_a_table_is_refused(two_rooms):
    cells = np.zeros((400, 400), dtype=np.int8)
    floor_map = OccupancyMap(cells=cells, resolution_m=0.1, origin=ORIGIN)
    mask = OccupancyMap(cells=cells + np.int8(100), resolution_m=0.5, origin=ORIGIN)
    limits = SearchSpaceParameters(max_observability_mb=1, max_poses=10**6)
    with pytest.raises(BadMapError, match=r"hold more than \d+ sights, more than max_observability_mb = 1"):
        SearchSpace.build(floor_map, mask, limits)


@pytest.mark.parametrize(
    ("floor", "masked", "sentence"),
    [
        (np.array([0]), True, r"283024 places x 12 headings = 3396288 poses, more than max_poses"),
        (np.array([0, 100]), False, r"candidate locations of 0.2 m, more than max_candidates"),
    ],
)
def test_ten_million_cells_are_refused_quickly(floor, masked, sentence, two_rooms, parameters):
    """Under 5 s and 2 GB, with a sentence that holds the numbers."""
    SearchSpace.build(*two_rooms, parameters)  # compiled beforehand
    cells = np.random.default_rng(0).choice(floor.astype(np.int8), size=(3200, 3200))
    floor_map = OccupancyMap(cells=cells, resolution_m=0.05, origin=ORIGIN)
    marks = np.zeros((3200, 3200), dtype=np.int8)
    marks[100:110, 100:110] = 100
    mask = OccupancyMap(cells=marks, resolution_m=0.05, origin=ORIGIN) if masked else None
    tracemalloc.start()
    began = time.process_time()
    with pytest.raises(BadMapError, match=sentence):
        SearchSpace.build(floor_map, mask, parameters, ORIGIN)
    took_s = time.process_time() - began
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert took_s < 5.0
    assert peak < 2e9


def test_a_hundred_thousand_poses_and_candidates(two_rooms, parameters):
    """A hall of 200 m x 200 m with a pillar and a low shelf every 2 m; 100 s where each pose looks at all."""
    SearchSpace.build(*two_rooms, parameters)  # compiled beforehand
    tile, marks = np.zeros((40, 40), dtype=np.int8), np.zeros((40, 40), dtype=np.int8)
    tile[0:8, 0:8] = 100  # the pillar
    tile[12:32, 12:20] = marks[12:32, 12:20] = 100  # the shelf, ten patches
    floor_map, mask = (
        OccupancyMap(cells=np.tile(cells, (100, 100)), resolution_m=0.05, origin=ORIGIN)
        for cells in (tile, marks)
    )
    began = time.process_time()
    space = SearchSpace.build(floor_map, mask, SearchSpaceParameters(spacing_m=1.65))
    took_s = time.process_time() - began
    assert len(space.graph) > 90_000
    assert len(space.candidates) == 100_000
    assert took_s < 20.0
