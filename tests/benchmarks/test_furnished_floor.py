import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import ndimage

from robustnav_nodes.benchmarks.furnished_floor import CELL_M, FloorStyle, draw_floor

ONE_ROOM = FloorStyle(rooms=(1, 1), area_m2=(9.0, 13.0), filled=0.40, tall=0.14)
FLAT = FloorStyle(rooms=(3, 4), area_m2=(40.0, 50.0), filled=0.44, tall=0.14)
STYLES = st.sampled_from([ONE_ROOM, FLAT])
SEEDS = st.integers(0, 2**32 - 1)


def drawn(style: FloorStyle, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """bool [height, width]: what is occupied, and what holds objects."""
    floor_map, mask = draw_floor(style, np.random.default_rng(seed))
    return floor_map.cells == 100, mask.cells == 100


@given(style=STYLES, seed=SEEDS)
@settings(max_examples=10, deadline=None)
def test_a_floor_depends_on_its_seed_alone(style, seed):
    for one, other in zip(drawn(style, seed), drawn(style, seed), strict=True):
        np.testing.assert_array_equal(one, other)


def test_other_seeds_draw_other_floors():
    floors = [drawn(ONE_ROOM, seed)[0] for seed in range(5)]
    assert len({floor.tobytes() for floor in floors}) == 5


@given(style=STYLES, seed=SEEDS)
@settings(max_examples=15, deadline=None)
def test_a_robot_comes_from_everywhere_that_it_fits_to_everywhere_else(style, seed):
    """Where 0.35 m to each side are free: as one piece, going straight along rows and columns."""
    occupied, _ = drawn(style, seed)
    fits = ndimage.distance_transform_cdt(~occupied, metric="chessboard") > 3
    _, parts = ndimage.label(fits)
    assert parts == 1


@given(style=STYLES, seed=SEEDS)
@settings(max_examples=15, deadline=None)
def test_what_holds_objects_is_occupied_and_walls_close_the_floor(style, seed):
    occupied, masked = drawn(style, seed)
    assert not (masked & ~occupied).any()
    for edge in (occupied[:2], occupied[-2:], occupied[:, :2], occupied[:, -2:]):
        assert edge.all()
    assert not masked[:2].any()


@given(style=STYLES, seed=SEEDS)
@settings(max_examples=15, deadline=None)
def test_size_and_furniture_are_those_of_the_style(style, seed):
    """The area to what rounding to 0.2 m leaves; furniture up to the wanted part and one piece (1.44 m2)."""
    occupied, masked = drawn(style, seed)
    inside = occupied[2:-2, 2:-2]
    area_m2 = inside.size * CELL_M**2
    edge_m2 = 0.2 * (inside.shape[0] + inside.shape[1]) * CELL_M
    assert style.area_m2[0] - edge_m2 <= area_m2 <= style.area_m2[1] + edge_m2
    low_m2 = masked.sum() * CELL_M**2
    assert 0.4 * style.filled * area_m2 <= low_m2 <= style.filled * area_m2 + 1.44


@pytest.mark.parametrize("rooms", [1, 2, 4])
def test_as_many_rooms_as_asked_for(rooms):
    """Doors shut by a broom as wide as they are, an unfurnished floor falls into its rooms."""
    style = FloorStyle(rooms=(rooms, rooms), area_m2=(60.0, 60.0), filled=0.0, tall=0.0)
    for seed in range(5):
        occupied, masked = drawn(style, seed)
        assert not masked.any()
        open_floor = ndimage.binary_opening(~occupied, structure=np.ones((11, 11)))
        assert ndimage.label(open_floor)[1] == rooms
