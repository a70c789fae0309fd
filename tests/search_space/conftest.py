"""Small maps, drawn as text."""

from collections.abc import Callable

import numpy as np
import pytest

from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

Drawn = tuple[OccupancyMap, OccupancyMap]


def draw(*rows: str, cell_m: float = 0.3, resolution_m: float = 0.05) -> Drawn:
    """Map and candidate mask from text: `#` wall, `o` low furniture, `?` unknown, else free; top row: +y."""
    art = np.array([list(row) for row in reversed(rows)])
    occupied = np.where((art == "#") | (art == "o"), 100, np.where(art == "?", -1, 0)).astype(np.int8)
    masked = np.where(art == "o", 100, 0).astype(np.int8)
    scale = np.ones((round(cell_m / resolution_m),) * 2, dtype=np.int8)
    origin = Pose2D(x_m=0.0, y_m=0.0)
    floor_map = OccupancyMap(cells=np.kron(occupied, scale), resolution_m=resolution_m, origin=origin)
    return floor_map, OccupancyMap(cells=np.kron(masked, scale), resolution_m=resolution_m, origin=origin)


@pytest.fixture(scope="session")
def drawn() -> Callable[..., Drawn]:
    return draw


@pytest.fixture(scope="session")
def parameters() -> SearchSpaceParameters:
    """What the maps drawn here are worked out for by hand: the camera at the robot's centre, near and far."""
    return SearchSpaceParameters(camera_forward_m=0.0, range_min_m=0.5, range_max_m=4.0)


@pytest.fixture(scope="session")
def two_rooms() -> Drawn:
    return draw(
        "####################",
        "#........#.........#",
        "#........#.....ooo.#",
        "#..................#",
        "#..................#",
        "#.oo.....#.........#",
        "#.oo.....#.........#",
        "#........#....##...#",
        "####################",
    )
