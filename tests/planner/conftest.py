"""Small homes, drawn as text, and the search spaces on them."""

from collections.abc import Callable

import numpy as np
import pytest

from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.search_space.space import SearchSpace

CELL_M = 0.3


def draw(*rows: str, resolution_m: float = 0.05) -> tuple[OccupancyMap, OccupancyMap]:
    """Map and candidate mask from text: `#` wall, `o` low furniture, else free; top row is +y."""
    art = np.array([list(row) for row in reversed(rows)])
    occupied = np.where((art == "#") | (art == "o"), 100, 0).astype(np.int8)
    masked = np.where(art == "o", 100, 0).astype(np.int8)
    scale = np.ones((round(CELL_M / resolution_m),) * 2, dtype=np.int8)
    origin = Pose2D(x_m=0.0, y_m=0.0)
    floor_map = OccupancyMap(cells=np.kron(occupied, scale), resolution_m=resolution_m, origin=origin)
    return floor_map, OccupancyMap(cells=np.kron(masked, scale), resolution_m=resolution_m, origin=origin)


@pytest.fixture(scope="session")
def space_of() -> Callable[..., SearchSpace]:
    """space_of(*rows, **parameters): the search space of a drawn home."""

    def build(*rows: str, **changes: float) -> SearchSpace:
        return SearchSpace.build(*draw(*rows), planner_parameters(**changes))

    return build


def planner_parameters(**changes: object) -> PlannerParameters:
    by_hand = {
        "camera_forward_m": 0.0,
        "robot_radius_m": 0.1,
        "candidate_size_m": 0.3,
        "range_min_m": 0.5,
        "range_max_m": 4.0,
        "docking_distance_m": 0.8,
    }
    return PlannerParameters(**(by_hand | changes))  # type: ignore[arg-type]


@pytest.fixture(scope="session")
def parameters_with() -> Callable[..., PlannerParameters]:
    """parameters_with(**changes): the camera at the robot's centre, a small robot, one candidate a cell."""
    return planner_parameters


@pytest.fixture(scope="session")
def home() -> SearchSpace:
    """Three rooms with a door between each two, low furniture, and one tall thing."""
    art = (
        "############################",
        "#.......#.......ooo#.......#",
        "#oo.....#..........#......o#",
        "#oo.....#..........#......o#",
        "#oo.....................oo.#",
        "#..................#....oo.#",
        "#.......#..oo......#.......#",
        "#.......#..oo......#.......#",
        "#..oo...#..oo......#.......#",
        "#..oo............#.#oo.....#",
        "#................#.#oo.....#",
        "#.......#ooo.......#oo.....#",
        "############################",
    )
    return SearchSpace.build(*draw(*art), planner_parameters())
