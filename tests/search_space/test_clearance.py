import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_nodes.search_space.clearance import way_fits
from robustnav_nodes.search_space.floor_grid import FREE, OCCUPIED, UNKNOWN, FloorGrid


def floor(*blocked: tuple[int, int], kind: int = OCCUPIED) -> FloorGrid:
    """Ten by ten cells of 0.1 m whose corner is at (-0.5, 2)."""
    cells = np.full((10, 10), FREE, dtype=np.uint8)
    for row, column in blocked:
        cells[row, column] = kind
    return FloorGrid(kind=cells, resolution_m=0.1, x_m=-0.5, y_m=2.0)


@pytest.mark.parametrize("kind", [OCCUPIED, UNKNOWN])
@pytest.mark.parametrize(("radius_m", "fits"), [(0.14, True), (0.16, False)])
def test_standing_beside_a_cell(kind, radius_m, fits):
    """The cell's middle is at (0.05, 2.55), 0.2 m from the robot; it counts as a disc of 0.05 m."""
    assert way_fits(floor((5, 5), kind=kind), 0.25, 2.55, 0.25, 2.55, radius_m) is fits


@pytest.mark.parametrize(("radius_m", "fits"), [(0.09, True), (0.12, False)])
def test_passing_cells_half_way(radius_m, fits):
    """Both ways pass the middles of two cells at 0.15 m; their ends are far enough from them."""
    above, beside = floor((6, 4), (6, 5)), floor((4, 6), (5, 6))
    for grid, ax, ay, bx, by in ((above, -0.3, 2.5, 0.3, 2.5), (beside, 0.0, 2.2, 0.0, 2.8)):
        assert way_fits(grid, ax, ay, ax, ay, radius_m)
        assert way_fits(grid, bx, by, bx, by, radius_m)
        assert way_fits(grid, ax, ay, bx, by, radius_m) is fits


def test_the_edge_of_the_map_is_a_wall():
    assert way_fits(floor(), -0.3, 2.2, 0.3, 2.8, 0.2)
    assert not way_fits(floor(), -0.3, 2.2, 0.3, 2.8, 0.21)


@given(
    blocked=st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=6),
    ends=st.tuples(*[st.floats(0.0, 1.0)] * 4),
    radius_m=st.floats(0.0, 0.3),
)
@settings(max_examples=200, deadline=None)
def test_where_a_way_fits_so_do_all_places_on_it(blocked, ends, radius_m):
    grid = floor(*blocked)
    ax, ay, bx, by = ends[0] - 0.5, ends[1] + 2.0, ends[2] - 0.5, ends[3] + 2.0
    if way_fits(grid, ax, ay, bx, by, radius_m):
        for share in np.linspace(0.0, 1.0, 21):
            x_m, y_m = ax + share * (bx - ax), ay + share * (by - ay)
            assert way_fits(grid, x_m, y_m, x_m, y_m, radius_m - 1e-9)
