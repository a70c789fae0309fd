import numpy as np
import pytest
from scipy import ndimage

from robustnav_nodes.benchmarks.furnished_floor import CELL_M, FloorStyle, draw_floor

ONE_ROOM = FloorStyle(rooms=(1, 1), area_m2=(9.0, 13.0), filled=0.40, tall=0.14)
FLAT = FloorStyle(rooms=(3, 4), area_m2=(40.0, 50.0), filled=0.44, tall=0.14)
SEEDS = (0, 1, 2, 3, 4, 1000, 2**31, 2**32 - 1)


def drawn(style: FloorStyle, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """bool [height, width]: what is occupied, and what holds objects."""
    floor_map, mask = draw_floor(style, np.random.default_rng(seed))
    return floor_map.cells == 100, mask.cells == 100


@pytest.fixture(scope="module")
def floors() -> list[tuple[FloorStyle, np.ndarray, np.ndarray]]:
    """Style, what is occupied and what holds objects, of a floor of each style and seed."""
    return [(style, *drawn(style, seed)) for style in (ONE_ROOM, FLAT) for seed in SEEDS]


def test_a_floor_depends_on_its_seed_alone(floors):
    for style, occupied, masked in floors[:: len(SEEDS)]:
        again = drawn(style, SEEDS[0])
        np.testing.assert_array_equal(occupied, again[0])
        np.testing.assert_array_equal(masked, again[1])


def test_other_seeds_draw_other_floors():
    floors = [drawn(ONE_ROOM, seed)[0] for seed in range(5)]
    assert len({floor.tobytes() for floor in floors}) == 5


def test_a_robot_comes_from_everywhere_that_it_fits_to_everywhere_else(floors):
    """Where 0.35 m to each side are free: as one piece, going straight along rows and columns."""
    for _, occupied, _ in floors:
        fits = ndimage.distance_transform_cdt(~occupied, metric="chessboard") > 3
        _, parts = ndimage.label(fits)
        assert parts == 1


def test_what_holds_objects_is_occupied_and_walls_close_the_floor(floors):
    for _, occupied, masked in floors:
        assert not (masked & ~occupied).any()
        for edge in (occupied[:2], occupied[-2:], occupied[:, :2], occupied[:, -2:]):
            assert edge.all()
        assert not masked[:2].any()


def test_size_and_furniture_are_those_of_the_style(floors):
    """The area to what rounding to 0.2 m leaves; furniture up to the wanted part and one piece (1.44 m2)."""
    for style, occupied, masked in floors:
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
