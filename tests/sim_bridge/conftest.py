"""Homes and simulations that several tests share; they are built once and not changed."""

from collections.abc import Callable, Iterator
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np
import pytest

from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.generator import generate_home
from sim_bridge.homes.home import Home
from sim_bridge.homes.obstacles import ClearanceGrid
from sim_bridge.homes.rooms.room_programmes import Difficulty
from sim_bridge.parameters import SimParameters

if TYPE_CHECKING:
    from sim_bridge.simulation import Simulation

# Of each difficulty so many homes, from the seeds 0, 1, ...
HOMES = {Difficulty.EASY: 6, Difficulty.MEDIUM: 8, Difficulty.HARD: 3}
# Homes, maps and driving are tested without PyBullet, all but the node without ROS.
collect_ignore = [] if find_spec("rclpy") else ["test_node.py"]
if not find_spec("pybullet"):
    collect_ignore += [
        "homes/test_shapes.py",
        "robot/test_goal_follower.py",
        "sensors",
        "test_node.py",
        "test_simulated_faults.py",
        "test_simulated_motion.py",
        "test_simulation.py",
    ]


@pytest.fixture(scope="session")
def homes() -> list[Home]:
    """Homes of all difficulties, the small ones first."""
    return [
        generate_home(seed, difficulty=difficulty)
        for difficulty, count in HOMES.items()
        for seed in range(count)
    ]


@pytest.fixture(scope="module")
def simulation() -> Iterator["Simulation"]:
    from sim_bridge.simulation import Simulation

    with Simulation(SimParameters(seed=3)) as made:
        yield made


@pytest.fixture
def fresh() -> Iterator["Simulation"]:
    """A simulation of its own, for tests that count its steps."""
    from sim_bridge.simulation import Simulation

    with Simulation(SimParameters(seed=1)) as made:
        yield made


def _free_poses(home: Home, count: int, seed: int, clearance_m: float = 0.2) -> list[Pose2D]:
    rng = np.random.default_rng(seed)
    grid = ClearanceGrid(home.bounds, 0.05).with_rects(home.obstacles())
    rows, columns = np.nonzero(grid.cells_m >= clearance_m)
    return [
        Pose2D(
            x_m=float(grid.x_m[columns[at]]),
            y_m=float(grid.y_m[rows[at]]),
            yaw_rad=float(rng.uniform(-3.1, 3.1)),
        )
        for at in rng.integers(len(rows), size=count)
    ]


@pytest.fixture(scope="session")
def free_poses() -> Callable[..., list[Pose2D]]:
    """Random poses of a home on free floor."""
    return _free_poses
