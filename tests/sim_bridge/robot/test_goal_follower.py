"""Goals are reached around everything, or refused with a sentence while nothing moves."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.homes.obstacles import Obstacles
from sim_bridge.homes.rect import Rect
from sim_bridge.parameters import SimParameters
from sim_bridge.robot.drive import STANDSTILL
from sim_bridge.robot.goal_follower import GoalRefusedError, Phase
from sim_bridge.simulation import Simulation

FreePoses = Callable[..., list[Pose2D]]

LONGEST_S = 200.0


def drive_to_end(simulation: Simulation) -> float:
    """Step until the goal is reached or given up; seconds of simulated time. Nothing is ever touched."""
    drive = simulation.drive
    began_ns = simulation.now_ns
    while simulation.follower.goal is not None:
        simulation.step()
        assert drive.obstacles.clearance_m(drive.pose.x_m, drive.pose.y_m) >= drive.keep_m - 1e-9
        assert simulation.now_ns - began_ns < LONGEST_S * 1e9
    return (simulation.now_ns - began_ns) / 1e9


@pytest.mark.parametrize("seed", [2, 5, 9])
def test_random_goals_are_reached_precisely(seed: int, free_poses: FreePoses) -> None:
    with Simulation(SimParameters(seed=seed)) as simulation:
        for goal in free_poses(simulation.home, 12, seed, clearance_m=0.18):
            simulation.go_to(goal)
            drive_to_end(simulation)
            assert simulation.follower.problem == ""
            assert simulation.drive.pose.distance_m(goal) < 0.02
            assert abs(simulation.drive.pose.turn_rad(goal)) < math.radians(1.0)


def test_goals_follow_each_other_while_driving(simulation: Simulation, free_poses: FreePoses) -> None:
    rng = np.random.default_rng(0)
    drive = simulation.drive
    for goal in free_poses(simulation.home, 60, seed=7):
        simulation.go_to(goal)
        for _ in range(int(rng.integers(5, 100))):
            simulation.step()
            assert drive.obstacles.clearance_m(drive.pose.x_m, drive.pose.y_m) >= drive.keep_m - 1e-9
    drive_to_end(simulation)
    assert drive.pose.distance_m(goal) < 0.02


def moved(pose: Pose2D, forward_m: float, turn_rad: float = 0.0) -> Pose2D:
    return Pose2D(
        x_m=pose.x_m + forward_m * math.cos(pose.yaw_rad),
        y_m=pose.y_m + forward_m * math.sin(pose.yaw_rad),
        yaw_rad=math.remainder(pose.yaw_rad + turn_rad, math.tau),
    )


@pytest.mark.parametrize("forward_m", [0.3, -0.3])
def test_lattice_moves_do_not_turn_the_robot(fresh: Simulation, forward_m: float) -> None:
    start = fresh.drive.pose
    goal = moved(start, forward_m)
    fresh.go_to(goal)
    while fresh.follower.goal is not None:
        fresh.step()
        assert abs(fresh.drive.pose.turn_rad(start)) < math.radians(1.0)
    assert fresh.drive.pose.distance_m(goal) < 0.005


def test_a_lattice_turn_stays_in_place(fresh: Simulation) -> None:
    start = fresh.drive.pose
    goal = moved(start, 0.0, math.pi / 6)
    fresh.go_to(goal)
    assert drive_to_end(fresh) < 1.5
    assert fresh.drive.pose.distance_m(start) < 1e-6
    assert abs(fresh.drive.pose.turn_rad(goal)) < math.radians(1.0)


def test_goals_in_walls_furniture_and_outside_are_refused(simulation: Simulation) -> None:
    home = simulation.home
    simulation.reset()
    before = simulation.drive.pose
    piece = home.furniture[0]
    for x_m, y_m in (
        (home.walls[0].base.centre_m),
        (-1.0, 2.0),
        (1e9, 0.0),
        (piece.x_m, piece.y_m),
        (home.rooms[0].inside.x_min_m, home.rooms[0].inside.centre_m[1]),
    ):
        with pytest.raises(
            GoalRefusedError, match="the robot cannot stand at .*; choose a place on free floor"
        ):
            simulation.go_to(Pose2D(x_m=x_m, y_m=y_m))
        simulation.step()
    assert simulation.follower.phase is Phase.IDLE
    assert simulation.drive.pose == before
    for wrong in (math.nan, math.inf):
        with pytest.raises(BadMessageError, match="a pose must be finite"):
            Pose2D(x_m=wrong, y_m=0.0)


def test_a_refused_goal_leaves_the_one_before(simulation: Simulation, free_poses: FreePoses) -> None:
    simulation.reset()
    goal = free_poses(simulation.home, 1, seed=8)[0]
    simulation.go_to(goal)
    with pytest.raises(GoalRefusedError):
        simulation.go_to(Pose2D(x_m=0.0, y_m=0.0))
    drive_to_end(simulation)
    assert simulation.drive.pose.distance_m(goal) < 0.02


def test_a_velocity_command_takes_over_at_once(simulation: Simulation, free_poses: FreePoses) -> None:
    simulation.reset()
    simulation.go_to(free_poses(simulation.home, 1, seed=9)[0])
    for _ in range(30):
        simulation.step()
    simulation.command(Velocity(linear_m_s=0.0, angular_rad_s=0.5))
    assert simulation.follower.goal is None
    for _ in range(20):
        simulation.step()
    assert simulation.drive.velocity == Velocity(linear_m_s=0.0, angular_rad_s=0.5)


def test_the_same_goal_again_does_not_stop_the_robot(fresh: Simulation, free_poses: FreePoses) -> None:
    goal = max(free_poses(fresh.home, 20, seed=1), key=fresh.drive.pose.distance_m)
    fresh.go_to(goal)
    while fresh.drive.velocity.linear_m_s < 0.4:
        fresh.step()
    fresh.go_to(goal)
    fresh.step()
    assert fresh.drive.velocity.linear_m_s > 0.3


def test_what_stands_in_the_way_ends_the_goal(fresh: Simulation, free_poses: FreePoses) -> None:
    goal = max(free_poses(fresh.home, 20, seed=1), key=fresh.drive.pose.distance_m)
    fresh.go_to(goal)
    while fresh.drive.velocity.linear_m_s < 0.4:
        fresh.step()
    ahead = moved(fresh.drive.pose, 0.7)
    post = Rect(
        x_min_m=ahead.x_m - 0.3, y_min_m=ahead.y_m - 0.3, x_max_m=ahead.x_m + 0.3, y_max_m=ahead.y_m + 0.3
    )
    # The planner does not know of it.
    fresh.drive.replace_obstacles(Obstacles((*fresh.home.obstacles(), post), fresh.home.bounds))
    drive_to_end(fresh)
    assert "something is in the way" in fresh.follower.problem
    for _ in range(50):
        fresh.step()
    assert fresh.drive.velocity == STANDSTILL
