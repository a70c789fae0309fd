import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.search_space.candidates import candidates_from_map, candidates_from_mask
from robustnav_nodes.search_space.floor_grid import floor_grid
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

PARAMETERS = SearchSpaceParameters(candidate_size_m=0.2)


def grid_map(cells: np.ndarray, resolution_m: float, x_m: float = 0.0, y_m: float = 0.0) -> OccupancyMap:
    return OccupancyMap(
        cells=cells.astype(np.int8), resolution_m=resolution_m, origin=Pose2D(x_m=x_m, y_m=y_m)
    )


FLOOR = floor_grid(grid_map(np.zeros((40, 40)), 0.05), PARAMETERS)


def test_each_cell_of_a_coarse_mask_is_a_candidate_at_its_middle():
    mask = np.zeros((10, 10))
    mask[2, 3] = 51
    mask[7, 0] = 100
    mask[5, 5] = 50
    found = candidates_from_mask(grid_map(mask, 0.2), FLOOR, PARAMETERS)
    assert found.x_m.tolist() == pytest.approx([0.7, 0.1])
    assert found.y_m.tolist() == pytest.approx([0.5, 1.5])
    assert found.size_m == pytest.approx(0.2)
    assert found.position_m.dtype == np.float32
    assert found.position_m[0].tolist() == pytest.approx([0.7, 0.5, 0.0])


def test_a_fine_mask_is_gathered_into_patches():
    """A table of 0.4 m x 0.3 m on a mask of 5 cm: two full patches of 0.2 m, and two half full."""
    mask = np.zeros((40, 40))
    mask[8:14, 4:12] = 100
    found = candidates_from_mask(grid_map(mask, 0.05), FLOOR, PARAMETERS)
    assert found.x_m.tolist() == pytest.approx([0.3, 0.5, 0.3, 0.5])
    assert found.y_m.tolist() == pytest.approx([0.5, 0.5, 0.65, 0.65])


def test_a_sliver_beside_a_patch_is_dropped_and_a_thing_of_its_own_is_kept():
    mask = np.zeros((40, 40))
    mask[8:12, 4:9] = 100  # one cell wider than the patch: 4 of 16 cells would do, this has 4 of 16
    mask[8:11, 8] = 100
    mask[11, 8] = 0
    mask[30, 30] = 100
    found = candidates_from_mask(grid_map(mask, 0.05), FLOOR, PARAMETERS)
    assert list(zip(found.x_m.round(3), found.y_m.round(3), strict=True)) == [(0.3, 0.5), (1.525, 1.525)]


def test_candidates_from_the_map_are_occupied_cells_beside_free_floor():
    cells = np.full((20, 20), -1)
    cells[4:16, 4:16] = 0
    cells[4:16, 16:19] = 100  # a thick wall: only its face can be seen
    found = candidates_from_map(floor_grid(grid_map(cells, 0.05), PARAMETERS), PARAMETERS)
    assert len(found) == 3
    assert found.x_m.tolist() == pytest.approx([16.5 * 0.05] * 3)


def test_a_mask_without_marks_is_refused():
    with pytest.raises(BadMapError, match=r"no cell above 50.*mark the furniture"):
        candidates_from_mask(grid_map(np.full((4, 4), 50), 0.05), FLOOR, PARAMETERS)


def test_a_mask_somewhere_else_is_refused():
    elsewhere = grid_map(np.full((4, 4), 100), 0.05, x_m=50.0)
    with pytest.raises(BadMapError, match=r"x 50.* do not overlap"):
        candidates_from_mask(elsewhere, FLOOR, PARAMETERS)


def test_marks_beside_the_map_are_left_out():
    mask = grid_map(np.full((1, 4), 100), 0.2, x_m=1.6)
    assert candidates_from_mask(mask, FLOOR, PARAMETERS).x_m.tolist() == pytest.approx([1.7, 1.9])


def test_a_map_without_obstacles_is_refused():
    with pytest.raises(BadMapError, match=r"publish a candidate mask"):
        candidates_from_map(FLOOR, PARAMETERS)


def test_too_many_candidates_are_refused_with_the_numbers():
    few = SearchSpaceParameters(max_candidates=3)
    with pytest.raises(BadMapError, match=r"100 candidate locations of 0.2 m, more than max_candidates = 3"):
        candidates_from_mask(grid_map(np.full((40, 40), 100), 0.05), FLOOR, few)
