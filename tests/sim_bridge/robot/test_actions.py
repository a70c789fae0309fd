"""Actions end exactly where geometry says, or say why they do not."""

import contextlib
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.homes.home import Home
from sim_bridge.homes.obstacles import Obstacles
from sim_bridge.homes.rect import Rect
from sim_bridge.robot.actions import (
    LATTICE_STEP_M,
    LATTICE_TURN_RAD,
    MOST_WAITING,
    STOP,
    Action,
    ActionRefusedError,
    ActionRunner,
    parse_action,
)
from sim_bridge.robot.drive import STANDSTILL, Drive, DriveLimits
from sim_bridge.robot.planar import ORIGIN, composed

DT_S = 0.02
LONGEST_S = 120.0
LIMITS = DriveLimits(
    speed_m_s=0.5, turn_rad_s=1.2, acceleration_m_s2=1.0, turn_acceleration_rad_s2=4.0, braking=2.5
)
HALL = Rect(x_min_m=-8.0, y_min_m=-8.0, x_max_m=8.0, y_max_m=8.0)


def drive_at(start: Pose2D, *rects: Rect, limits: DriveLimits = LIMITS, bounds: Rect = HALL) -> Drive:
    drive = Drive(Obstacles(rects, bounds), limits, 0.15, 0.01)
    drive.place(start)
    return drive


def run(drive: Drive, runner: ActionRunner, slip: float = 0.0, dt_s: float = DT_S) -> float:
    """Step until all is done; seconds of simulated time."""
    seconds = 0.0
    while runner.busy:
        before = drive.velocity
        drive.step(runner.wanted(dt_s), dt_s, slip)
        change = abs(drive.velocity.linear_m_s - before.linear_m_s)
        assert drive.blocked or change <= drive.limits.acceleration_m_s2 * drive.limits.braking * dt_s + 1e-3
        seconds += dt_s
        assert seconds < LONGEST_S
    return seconds


def do(drive: Drive, *lines: str, slip: float = 0.0) -> ActionRunner:
    runner = ActionRunner(drive)
    for line in lines:
        runner.accept(parse_action(line))
    run(drive, runner, slip)
    return runner


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("dt_s", [0.02, 0.002])
def test_random_chains_end_on_the_pose_that_geometry_gives(seed: int, dt_s: float) -> None:
    rng = np.random.default_rng(seed)
    limits = DriveLimits(
        speed_m_s=float(rng.uniform(0.05, 2.0)),
        turn_rad_s=float(rng.uniform(0.3, 6.0)),
        acceleration_m_s2=float(rng.uniform(0.1, 10.0)),
        turn_acceleration_rad_s2=float(rng.uniform(0.2, 40.0)),
        braking=float(rng.uniform(1.0, 10.0)),
    )
    drive = drive_at(Pose2D(x_m=0.3, y_m=-0.2, yaw_rad=0.4), limits=limits)
    runner, ideal = ActionRunner(drive), drive.pose
    for _ in range(8):
        if rng.random() < 0.5:
            action = Action(forward_m=float(rng.uniform(-0.8, 0.8)))
        else:
            action = Action(turn_rad=float(rng.uniform(-math.tau, math.tau)))
        runner.accept(action)
        run(drive, runner, dt_s=dt_s)
        ideal = composed(ideal, Pose2D(x_m=action.forward_m, y_m=0.0, yaw_rad=action.turn_rad))
        assert runner.problem == ""
        assert drive.pose == ideal


def test_24_turns_of_15_degrees_end_where_they_began() -> None:
    drive = drive_at(Pose2D(x_m=0.3, y_m=-0.2, yaw_rad=0.4))
    for side in ("left", "right"):
        runner = ActionRunner(drive)
        for _ in range(24):
            runner.accept(parse_action(side))
            run(drive, runner)
        assert abs(drive.pose.yaw_rad - 0.4) < 1e-9
        assert (drive.pose.x_m, drive.pose.y_m) == (0.3, -0.2)


def test_a_square_closes() -> None:
    start = Pose2D(x_m=0.3, y_m=-0.2, yaw_rad=0.4)
    drive = drive_at(start)
    do(drive, *(["forward 0.3", "left 90"] * 4))
    assert drive.pose.distance_m(start) < 1e-9
    assert abs(drive.pose.turn_rad(start)) < 1e-9


def test_the_steps_of_the_lattice_lead_back_to_every_pose() -> None:
    start = Pose2D(x_m=0.0, y_m=0.0)
    drive = drive_at(start)
    runner = ActionRunner(drive)
    for word in ("forward", "left", "left", "left", "forward", "back", "right", "right", "right", "back"):
        runner.accept(parse_action(word, LATTICE_STEP_M, LATTICE_TURN_RAD))
    run(drive, runner)
    assert drive.pose.distance_m(start) < 1e-9


def test_an_action_takes_as_long_as_the_drive_needs() -> None:
    drive = drive_at(ORIGIN)
    runner = ActionRunner(drive)
    runner.accept(Action(forward_m=1.0))
    # 0.5 s to speed up over 0.125 m, 0.625 s to brake at 0.8 m/s2 over 0.156 m, the rest at 0.5 m/s.
    assert run(drive, runner) == pytest.approx(0.5 + 0.625 + 1.438, abs=0.15)
    runner.accept(Action(turn_rad=math.tau))
    # 0.3 s and 0.18 rad to speed up, 0.375 s and 0.225 rad to brake at 3.2 rad/s2.
    assert run(drive, runner) == pytest.approx(0.3 + 0.375 + (math.tau - 0.405) / 1.2, abs=0.15)


def test_what_is_in_the_way_ends_an_action_and_the_next_begins_there() -> None:
    wall = Rect(x_min_m=0.5, y_min_m=-2.0, x_max_m=0.6, y_max_m=2.0)
    drive = drive_at(ORIGIN, wall)
    runner = do(drive, "forward 1", "left 90", "forward 0.25")
    # The sentence stays until another action is accepted.
    assert runner.problem.startswith(
        "'forward 1' ended after 0.34 m and 0 degrees at (0.34, 0.00): something is"
    )
    assert drive.pose.x_m == pytest.approx(0.5 - drive.keep_m, abs=2e-4)
    assert drive.pose.y_m == pytest.approx(0.25, abs=1e-12)
    runner.accept(parse_action("back 0.25"))
    assert runner.problem == ""
    run(drive, runner)
    assert runner.problem == ""
    assert drive.pose.y_m == pytest.approx(0.0, abs=1e-12)


def test_a_robot_at_a_wall_does_not_go_and_says_so_each_time() -> None:
    wall = Rect(x_min_m=0.5, y_min_m=-2.0, x_max_m=0.6, y_max_m=2.0)
    drive = drive_at(ORIGIN, wall)
    do(drive, "forward 1")
    for _ in range(3):
        before = drive.pose
        assert "something is in the way" in do(drive, "forward").problem
        assert drive.pose.distance_m(before) < 2e-4
    assert do(drive, "back").problem == ""


@pytest.mark.parametrize("seed", range(3))
def test_actions_in_homes_touch_nothing(homes: list[Home], seed: int) -> None:
    home = homes[seed]
    drive = drive_at(home.start, *home.obstacles(), bounds=home.bounds)
    runner, rng, stopped = ActionRunner(drive), np.random.default_rng(seed), 0
    for _ in range(120):
        words = ("forward 0.5", "left", "right 40", "back 0.2", "forward 2")
        runner.accept(parse_action(words[rng.integers(len(words))]))
        while runner.busy:
            drive.step(runner.wanted(DT_S), DT_S)
            assert drive.obstacles.clearance_m(drive.pose.x_m, drive.pose.y_m) >= drive.keep_m - 1e-9
        stopped += runner.problem != ""
    assert stopped > 5


def test_slip_is_made_up_for_but_wheels_that_only_slip_end_the_action() -> None:
    drive = drive_at(ORIGIN)
    assert do(drive, "forward 0.5", "left 90", slip=0.3).problem == ""
    assert (drive.pose.x_m, drive.pose.y_m) == (0.5, 0.0)
    for line in ("forward", "left"):
        assert "its wheels slip" in do(drive, line, slip=1.0).problem
    assert (drive.pose.x_m, drive.pose.y_m) == (0.5, 0.0)


def test_stop_ends_everything_and_the_robot_brakes() -> None:
    drive = drive_at(ORIGIN)
    runner = ActionRunner(drive)
    for _ in range(3):
        runner.accept(parse_action("forward 1"))
    for _ in range(50):
        drive.step(runner.wanted(DT_S), DT_S)
    runner.accept(STOP)
    assert not runner.busy
    for _ in range(20):
        drive.step(runner.wanted(DT_S), DT_S)
    assert drive.stands
    assert 0.3 < drive.pose.x_m < 0.6
    x_m = drive.pose.x_m
    runner.accept(parse_action("forward 0.25"))
    run(drive, runner)
    assert drive.pose.x_m == pytest.approx(x_m + 0.25, abs=1e-12)


def test_an_action_after_a_velocity_begins_once_the_robot_stands() -> None:
    drive = drive_at(ORIGIN)
    for _ in range(40):
        drive.step(Velocity(linear_m_s=0.5, angular_rad_s=1.0), DT_S)
    assert not drive.stands
    runner = ActionRunner(drive)
    runner.accept(parse_action("forward 5"))
    while drive.velocity != STANDSTILL:
        drive.step(runner.wanted(DT_S), DT_S)
    begin = drive.pose
    run(drive, runner)
    assert runner.problem == ""
    assert drive.pose == composed(begin, Pose2D(x_m=5.0, y_m=0.0))


def test_more_than_twenty_waiting_actions_are_refused() -> None:
    runner = ActionRunner(drive_at(ORIGIN))
    for _ in range(MOST_WAITING):
        runner.accept(parse_action("left"))
    with pytest.raises(ActionRefusedError, match="20 actions wait already: 'left 15' is not taken; wait"):
        runner.accept(parse_action("left"))
    runner.accept(STOP)
    assert not runner.busy


@pytest.mark.parametrize(
    ("line", "action"),
    [
        ("forward", Action(forward_m=0.25)),
        ("  Forward   0.3 ", Action(forward_m=0.3)),
        ("back 0.25", Action(forward_m=-0.25)),
        ("left", Action(turn_rad=math.radians(15.0))),
        ("left 360", Action(turn_rad=math.tau)),
        ("right 15", Action(turn_rad=-math.radians(15.0))),
        ("stop", STOP),
    ],
)
def test_what_a_person_types_is_understood(line: str, action: Action) -> None:
    assert parse_action(line) == action
    assert parse_action(str(action)) == action


@pytest.mark.parametrize(
    "line",
    [
        "",
        "fly",
        "forward 1 2",
        "stop 3",
        "forwards",
        "left, 3",
        "forward" + " " * 60 + "1",
        "стоп",
        "12",
        "\0",
    ],
)
def test_what_is_no_action_is_refused_with_the_forms(line: str) -> None:
    with pytest.raises(BadMessageError, match=r"there is no action .*; type 'forward \[METRES\]'"):
        parse_action(line)


@pytest.mark.parametrize("amount", ["0", "-1", "nan", "inf", "1e3", "10.1", "1_0", "x", "٣", "9" * 30])
def test_amounts_that_cannot_be_are_refused(amount: str) -> None:
    with pytest.raises(BadMessageError, match="forward takes metres, more than 0 and at most 10, not"):
        parse_action(f"forward {amount}")
    with pytest.raises(BadMessageError, match="left takes degrees, more than 0 and at most 360, not"):
        parse_action("left 360.5")


@given(st.text(max_size=80))
def test_any_line_is_an_action_or_refused(line: str) -> None:
    with contextlib.suppress(BadMessageError):
        assert isinstance(parse_action(line), Action)


def test_an_action_that_cannot_be_is_refused() -> None:
    for forward_m, turn_rad in ((1.0, 1.0), (math.nan, 0.0), (11.0, 0.0), (0.0, math.inf)):
        with pytest.raises(BadMessageError, match="an action"):
            Action(forward_m=forward_m, turn_rad=turn_rad)
