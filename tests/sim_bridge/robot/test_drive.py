"""The drive keeps its limits, goes where its odometry says, and touches nothing."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.homes.home import Home
from sim_bridge.homes.obstacles import Obstacles
from sim_bridge.homes.rect import Rect
from sim_bridge.robot.drive import STANDSTILL, Drive, DriveLimits

RADIUS_M, STOP_M, DT_S = 0.15, 0.01, 0.02
LIMITS = DriveLimits(
    speed_m_s=0.5, turn_rad_s=1.2, acceleration_m_s2=1.0, turn_acceleration_rad_s2=4.0, braking=2.5
)
HALL = Rect(x_min_m=-5.0, y_min_m=-5.0, x_max_m=5.0, y_max_m=5.0)


def drive_in(obstacles: Obstacles, pose: Pose2D) -> Drive:
    drive = Drive(obstacles, LIMITS, RADIUS_M, STOP_M)
    drive.place(pose)
    return drive


def go(drive: Drive, linear: float, angular: float, seconds: float) -> None:
    for _ in range(round(seconds / DT_S)):
        drive.step(Velocity(linear_m_s=linear, angular_rad_s=angular), DT_S)


def test_a_square_closes() -> None:
    drive = drive_in(Obstacles([], HALL), Pose2D(x_m=0.0, y_m=0.0))
    for _ in range(4):
        go(drive, 0.4, 0.0, 3.0)
        go(drive, 0.0, 0.0, 1.0)
        # A quarter turn: speeding up, turning and braking sweep pi / 2.
        ramps_rad = 1.0 / (2 * 4.0) + 1.0 / (2 * 4.0 * 2.5)
        go(drive, 0.0, 1.0, 0.25)
        go(drive, 0.0, 1.0, round((math.pi / 2 - ramps_rad) / DT_S) * DT_S)
        go(drive, 0.0, 0.0, 1.0)
    assert drive.pose.distance_m(Pose2D(x_m=0.0, y_m=0.0)) < 0.1
    assert abs(drive.pose.yaw_rad) < 0.1


def test_an_arc_ends_where_geometry_says() -> None:
    drive = drive_in(Obstacles([], HALL), Pose2D(x_m=0.0, y_m=0.0))
    drive.velocity = Velocity(linear_m_s=0.5, angular_rad_s=0.5)
    go(drive, 0.5, 0.5, 2 * math.pi)
    # A circle of radius 1 m, half of it.
    turned = round(2 * math.pi / DT_S) * DT_S * 0.5
    assert drive.pose.x_m == pytest.approx(math.sin(turned), abs=1e-9)
    assert drive.pose.y_m == pytest.approx(1.0 - math.cos(turned), abs=1e-9)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.tuples(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)), min_size=1, max_size=60))
def test_speeds_and_accelerations_stay_within_the_limits(commands: list[tuple[float, float]]) -> None:
    drive = drive_in(Obstacles([], HALL), Pose2D(x_m=0.0, y_m=0.0))
    for linear, angular in commands:
        before = drive.velocity
        drive.step(Velocity(linear_m_s=linear, angular_rad_s=angular), DT_S)
        after = drive.velocity
        assert abs(after.linear_m_s) <= 0.5
        assert abs(after.angular_rad_s) <= 1.2
        if not drive.blocked:
            assert abs(after.linear_m_s - before.linear_m_s) <= 2.5 * 1.0 * DT_S + 1e-12
        assert abs(after.angular_rad_s - before.angular_rad_s) <= 2.5 * 4.0 * DT_S + 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_random_commands_never_touch_anything(homes: list[Home], seed: int) -> None:
    home = homes[seed]
    obstacles = Obstacles(home.obstacles(), home.bounds)
    drive = drive_in(obstacles, home.start)
    rng = np.random.default_rng(seed)
    blocked, travelled_m = 0, 0.0
    for _ in range(150):
        linear, angular = rng.uniform(-0.2, 0.8), rng.uniform(-1.5, 1.5)
        for _ in range(25):
            before = drive.pose
            drive.step(Velocity(linear_m_s=linear, angular_rad_s=angular), DT_S)
            assert obstacles.clearance_m(drive.pose.x_m, drive.pose.y_m) >= RADIUS_M + STOP_M - 1e-9
            blocked += drive.blocked
            travelled_m += before.distance_m(drive.pose)
    assert blocked > 10
    assert travelled_m > 3.0


def test_a_thousand_wild_velocities_never_touch_anything(homes: list[Home]) -> None:
    blocked = 0
    for seed, home in enumerate(homes[:10]):
        obstacles = Obstacles(home.obstacles(), home.bounds)
        drive = drive_in(obstacles, home.start)
        rng = np.random.default_rng(seed)
        for number in range(100):
            # Huge ones, tiny ones, and from one extreme to the other.
            size = 10.0 ** rng.uniform(-3.0, 300.0) if number % 3 == 0 else rng.uniform(0.1, 2.0)
            wanted = Velocity(
                linear_m_s=float(size * rng.choice((-1.0, 1.0))),
                angular_rad_s=float(size * rng.normal() / 3.0),
            )
            slip, dt_s = float(rng.choice((0.0, 0.0, 0.4, 1.0))), float(rng.choice((0.002, 0.02)))
            for _ in range(20):
                drive.step(wanted, dt_s, slip)
                clearance_m = obstacles.clearance_m(drive.pose.x_m, drive.pose.y_m)
                assert clearance_m >= RADIUS_M + STOP_M - 1e-9
                assert home.bounds.holds(drive.pose.x_m, drive.pose.y_m)
                blocked += drive.blocked
    assert blocked > 50


@given(st.floats(), st.floats(), st.floats())
def test_no_velocity_and_no_pose_is_made_of_what_is_no_number(a: float, b: float, c: float) -> None:
    for make in (lambda: Velocity(linear_m_s=a, angular_rad_s=b), lambda: Pose2D(x_m=a, y_m=b, yaw_rad=c)):
        try:
            value = make()
        except BadMessageError:
            assert not all(map(math.isfinite, (a, b, c)))
            continue
        drive = drive_in(Obstacles([], HALL), Pose2D(x_m=0.0, y_m=0.0))
        drive.step(value if isinstance(value, Velocity) else STANDSTILL, DT_S)
        assert all(map(math.isfinite, (drive.pose.x_m, drive.pose.y_m, drive.pose.yaw_rad)))


def test_a_standing_robot_is_set_right_by_a_hair_and_by_no_more() -> None:
    wall = Rect(x_min_m=0.1605, y_min_m=-2.0, x_max_m=0.3, y_max_m=2.0)
    here = Pose2D(x_m=0.0, y_m=0.0)
    for pose, settles in (
        (Pose2D(x_m=-0.0015, y_m=0.001, yaw_rad=0.003), True),
        (Pose2D(x_m=-0.0015, y_m=0.0, yaw_rad=math.tau), True),
        (Pose2D(x_m=-0.0025, y_m=0.0), False),
        (Pose2D(x_m=0.0, y_m=0.0, yaw_rad=0.004), False),
        (Pose2D(x_m=0.001, y_m=0.0), False),
    ):
        drive = drive_in(Obstacles([wall], HALL), here)
        assert drive.settle(pose) is settles
        assert drive.pose.distance_m(pose if settles else here) == 0.0
        assert abs(drive.pose.yaw_rad) < math.pi
    drive = drive_in(Obstacles([], HALL), here)
    go(drive, 0.5, 0.0, 0.02)
    assert not drive.settle(drive.pose)


def test_slip_loses_its_share_of_the_motion_and_the_wheels_do_not_notice() -> None:
    held, free = (drive_in(Obstacles([], HALL), Pose2D(x_m=0.0, y_m=0.0)) for _ in range(2))
    for _ in range(100):
        free.step(Velocity(linear_m_s=0.5, angular_rad_s=0.0), DT_S)
        held.step(Velocity(linear_m_s=0.5, angular_rad_s=0.0), DT_S, 0.75)
    assert held.velocity == free.velocity
    assert held.pose.x_m == pytest.approx(0.25 * free.pose.x_m)


def test_new_obstacles_stop_the_robot_but_are_not_put_onto_it() -> None:
    drive = drive_in(Obstacles([], HALL), Pose2D(x_m=0.0, y_m=0.0))
    before = drive.obstacles
    for low_m in (-0.1, 0.1, 0.155):
        onto = Rect(x_min_m=low_m, y_min_m=-1.0, x_max_m=1.0, y_max_m=1.0)
        with pytest.raises(
            BadMessageError, match=r"the robot is in the way at \(0.00, 0.00\): .* drive it away"
        ):
            drive.replace_obstacles(Obstacles([onto], HALL))
        assert drive.obstacles is before
    go(drive, 0.5, 0.0, 2.0)
    ahead = Rect(x_min_m=drive.pose.x_m + 0.17, y_min_m=-1.0, x_max_m=3.0, y_max_m=1.0)
    drive.replace_obstacles(Obstacles([ahead], HALL))
    go(drive, 0.5, 0.0, 1.0)
    assert drive.blocked
    assert ahead.x_min_m - drive.pose.x_m >= drive.keep_m
    drive.replace_obstacles(before)
    go(drive, 0.5, 0.0, 1.0)
    assert not drive.blocked


def test_a_blocked_robot_turns_and_drives_away() -> None:
    wall = Rect(x_min_m=1.0, y_min_m=-2.0, x_max_m=1.1, y_max_m=2.0)
    drive = drive_in(Obstacles([wall], HALL), Pose2D(x_m=0.0, y_m=0.0))
    go(drive, 0.5, 0.0, 4.0)
    assert drive.blocked
    assert drive.pose.x_m == pytest.approx(1.0 - RADIUS_M - STOP_M, abs=1e-3)
    go(drive, 0.5, 1.2, math.pi / 1.2)
    go(drive, 0.5, 0.0, 2.0)
    assert drive.pose.x_m < 0.5


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_a_velocity_that_is_no_number_is_refused(wrong: float) -> None:
    for pair in ((wrong, 0.0), (0.0, wrong)):
        with pytest.raises(BadMessageError, match="must be finite"):
            Velocity(linear_m_s=pair[0], angular_rad_s=pair[1])


def test_a_place_in_a_wall_is_refused(homes: list[Home]) -> None:
    home = homes[0]
    drive = drive_in(Obstacles(home.obstacles(), home.bounds), home.start)
    for x_m, y_m in ((0.0, 0.0), (-3.0, 1.0), (home.furniture[0].x_m, home.furniture[0].y_m)):
        with pytest.raises(
            BadMessageError, match="does not fit at .* inside a wall or furniture, or outside"
        ):
            drive.place(Pose2D(x_m=x_m, y_m=y_m))
    assert drive.pose == home.start


@settings(max_examples=200, deadline=None)
@given(st.floats(-2.0, 14.0), st.floats(-2.0, 12.0))
def test_clearance_is_the_distance_to_the_nearest_rectangle(x_m: float, y_m: float) -> None:
    rects = [
        Rect(x_min_m=1.0, y_min_m=1.0, x_max_m=3.0, y_max_m=2.0),
        Rect(x_min_m=4.0, y_min_m=0.5, x_max_m=5, y_max_m=6),
    ]
    bounds = Rect(x_min_m=-1.0, y_min_m=-1.0, x_max_m=12.0, y_max_m=10.0)
    clearance_m = Obstacles(rects, bounds).clearance_m(x_m, y_m)
    nearest = [
        math.hypot(x_m - min(max(x_m, r.x_min_m), r.x_max_m), y_m - min(max(y_m, r.y_min_m), r.y_max_m))
        for r in rects
    ]
    if min(nearest) > 0.0 and bounds.holds(x_m, y_m):
        edge = min(x_m + 1.0, 12.0 - x_m, y_m + 1.0, 10.0 - y_m)
        assert clearance_m == pytest.approx(min(*nearest, edge), abs=1e-12)
    else:
        assert clearance_m <= 0.0
