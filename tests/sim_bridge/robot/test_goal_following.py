"""Goals in a home of two rooms, without a simulator around them: exact ends, and what changes on the way."""

import math

import numpy as np
import pytest

from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.home import Home
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles
from sim_bridge.homes.rect import Rect
from sim_bridge.robot.drive import Drive, DriveLimits
from sim_bridge.robot.goal_follower import GoalFollower, GoalRefusedError, Phase
from sim_bridge.robot.route import RoutePlanner

DT_S = 0.02
LONGEST_S = 200.0
LIMITS = DriveLimits(
    speed_m_s=0.5, turn_rad_s=1.2, acceleration_m_s2=1.0, turn_acceleration_rad_s2=4.0, braking=2.5
)
FLOOR = Rect(x_min_m=0.0, y_min_m=0.0, x_max_m=6.0, y_max_m=4.0)
# A wall with two doors; the lower one is on the short way.
WALL = (
    Rect(x_min_m=2.95, y_min_m=0.0, x_max_m=3.05, y_max_m=0.5),
    Rect(x_min_m=2.95, y_min_m=1.4, x_max_m=3.05, y_max_m=2.6),
    Rect(x_min_m=2.95, y_min_m=3.5, x_max_m=3.05, y_max_m=4.0),
)
LOWER = Rect(x_min_m=2.95, y_min_m=0.5, x_max_m=3.05, y_max_m=1.4)
UPPER = Rect(x_min_m=2.95, y_min_m=2.6, x_max_m=3.05, y_max_m=3.5)
START, GOAL = Pose2D(x_m=1.0, y_m=0.9), Pose2D(x_m=5.0, y_m=0.9, yaw_rad=1.0)


def parts(
    rects: tuple[Rect, ...], bounds: Rect, start: Pose2D, limits: DriveLimits = LIMITS
) -> tuple[Drive, GoalFollower]:
    drive = Drive(Obstacles(rects, bounds), limits, 0.15, 0.01)
    drive.place(start)
    return drive, GoalFollower(drive, planner_for(drive, rects, bounds))


def planner_for(drive: Drive, rects: tuple[Rect, ...], bounds: Rect) -> RoutePlanner:
    return RoutePlanner(Obstacles(rects, bounds), ClearanceGrid(bounds, 0.05).with_rects(rects), drive.keep_m)


def step(drive: Drive, follower: GoalFollower, slip: float = 0.0) -> None:
    drive.step(follower.wanted(DT_S), DT_S, slip)
    clearance_m = drive.obstacles.clearance_m(drive.pose.x_m, drive.pose.y_m)
    assert clearance_m >= drive.keep_m - 1e-9


def finish(drive: Drive, follower: GoalFollower, slip: float = 0.0) -> list[Pose2D]:
    way = [drive.pose]
    while follower.busy:
        step(drive, follower, slip)
        way.append(drive.pose)
        assert len(way) * DT_S < LONGEST_S
    return way


def change(drive: Drive, follower: GoalFollower, rects: tuple[Rect, ...]) -> None:
    """What a simulator does when a door is closed or a thing is put elsewhere."""
    drive.replace_obstacles(Obstacles(rects, FLOOR))
    follower.replan(planner_for(drive, rects, FLOOR))


@pytest.mark.parametrize("seed", range(4))
def test_random_goals_are_reached_exactly_and_nothing_is_touched(homes: list[Home], seed: int) -> None:
    home = homes[seed]
    drive, follower = parts(home.obstacles(), home.bounds, home.start)
    grid = ClearanceGrid(home.bounds, 0.05).with_rects(home.obstacles())
    rows, columns = np.nonzero(grid.cells_m >= 0.165)
    rng = np.random.default_rng(seed)
    for at in rng.integers(len(rows), size=12).tolist():
        goal = Pose2D(
            x_m=float(grid.x_m[columns[at]]), y_m=float(grid.y_m[rows[at]]), yaw_rad=float(rng.uniform(-4, 4))
        )
        follower.accept(goal)
        finish(drive, follower)
        assert follower.problem == ""
        assert (drive.pose.x_m, drive.pose.y_m) == (goal.x_m, goal.y_m)
        assert drive.pose.yaw_rad == math.remainder(goal.yaw_rad, math.tau)


def test_random_goals_anywhere_never_touch_anything(homes: list[Home]) -> None:
    """Many of them are refused; the others follow each other before they are reached."""
    refused = 0
    for seed, home in enumerate(homes[:5]):
        drive, follower = parts(home.obstacles(), home.bounds, home.start)
        bounds, rng = home.bounds, np.random.default_rng(seed)
        for number in range(100):
            reach_m = 1e9 if number % 20 == 0 else 0.5
            goal = Pose2D(
                x_m=float(rng.uniform(bounds.x_min_m - reach_m, bounds.x_max_m + reach_m)),
                y_m=float(rng.uniform(bounds.y_min_m - reach_m, bounds.y_max_m + reach_m)),
                yaw_rad=float(rng.normal() * 3.0),
            )
            try:
                follower.accept(goal)
            except GoalRefusedError:
                refused += 1
            for _ in range(int(rng.integers(1, 60))):
                step(drive, follower)
                assert bounds.holds(drive.pose.x_m, drive.pose.y_m)
    assert 100 < refused < 450


def test_a_lattice_of_poses_is_kept_for_ever() -> None:
    drive, follower = parts((), FLOOR, START)
    start = Pose2D(x_m=3.0, y_m=2.0)
    for number in range(60):
        angle = math.radians(30.0) * (number % 12)
        goal = Pose2D(x_m=start.x_m + 0.3 * (number % 3), y_m=start.y_m - 0.3 * (number % 2), yaw_rad=angle)
        follower.accept(goal)
        finish(drive, follower)
        assert drive.pose.distance_m(goal) == 0.0
        assert drive.pose.yaw_rad == math.remainder(angle, math.tau)


@pytest.mark.parametrize("after_s", [0.2, 1.5, 3.0])
def test_a_door_that_closes_sends_the_robot_through_the_other(after_s: float) -> None:
    drive, follower = parts(WALL, FLOOR, START)
    follower.accept(GOAL)
    for _ in range(round(after_s / DT_S)):
        step(drive, follower)
    change(drive, follower, (*WALL, LOWER))
    assert follower.busy
    way = finish(drive, follower)
    assert follower.problem == ""
    assert drive.pose.distance_m(GOAL) == 0.0
    assert max(pose.y_m for pose in way) > UPPER.y_min_m


def test_the_last_door_that_closes_ends_the_goal_with_a_sentence() -> None:
    drive, follower = parts((*WALL, UPPER), FLOOR, START)
    follower.accept(GOAL)
    for _ in range(75):
        step(drive, follower)
    change(drive, follower, (*WALL, LOWER, UPPER))
    assert not follower.busy
    assert "there is no way from" in follower.problem
    for _ in range(50):
        step(drive, follower)
    assert drive.stands


def test_a_thing_on_the_goal_ends_it_with_a_sentence() -> None:
    drive, follower = parts(WALL, FLOOR, START)
    follower.accept(GOAL)
    change(drive, follower, (*WALL, Rect(x_min_m=4.8, y_min_m=0.7, x_max_m=5.2, y_max_m=1.1)))
    assert not follower.busy
    assert "the robot cannot stand at (5.00, 0.90)" in follower.problem


def test_what_changes_elsewhere_does_not_stop_the_robot() -> None:
    drive, follower = parts(WALL, FLOOR, START)
    follower.accept(GOAL)
    while drive.velocity.linear_m_s < 0.4:
        step(drive, follower)
    change(drive, follower, (*WALL, UPPER))
    step(drive, follower)
    assert drive.velocity.linear_m_s > 0.4
    assert follower.phase is Phase.DRIVING
    finish(drive, follower)
    assert drive.pose.distance_m(GOAL) == 0.0


def test_a_door_that_opens_again_is_used_by_the_next_goal() -> None:
    drive, follower = parts((*WALL, LOWER, UPPER), FLOOR, START)
    with pytest.raises(GoalRefusedError, match="there is no way from"):
        follower.accept(GOAL)
    change(drive, follower, WALL)
    follower.accept(GOAL)
    finish(drive, follower)
    assert drive.pose.distance_m(GOAL) == 0.0


def test_slip_is_made_up_for_but_wheels_that_only_slip_end_the_goal() -> None:
    drive, follower = parts(WALL, FLOOR, START)
    follower.accept(GOAL)
    finish(drive, follower, slip=0.5)
    assert drive.pose.distance_m(GOAL) == 0.0
    follower.accept(START)
    for _ in range(100):
        step(drive, follower)
    finish(drive, follower, slip=1.0)
    assert "its wheels slip" in follower.problem


@pytest.mark.parametrize("braking", [1.0, 10.0])
@pytest.mark.parametrize("speed_m_s", [0.05, 2.0])
def test_slow_and_fast_robots_end_exactly_too(braking: float, speed_m_s: float) -> None:
    limits = DriveLimits(
        speed_m_s=speed_m_s,
        turn_rad_s=0.1 if speed_m_s < 1.0 else 6.0,
        acceleration_m_s2=0.1 if speed_m_s < 1.0 else 10.0,
        turn_acceleration_rad_s2=0.2 if speed_m_s < 1.0 else 40.0,
        braking=braking,
    )
    drive, follower = parts(WALL, FLOOR, START, limits)
    follower.accept(GOAL)
    finish(drive, follower)
    assert follower.problem == ""
    assert drive.pose.distance_m(GOAL) == 0.0
