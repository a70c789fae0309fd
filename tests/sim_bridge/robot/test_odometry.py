"""Odometry without drift is the truth, and with drift its error grows as its docstring says."""

import itertools
import math

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.homes.obstacles import Obstacles
from sim_bridge.homes.rect import Rect
from sim_bridge.robot.drive import STANDSTILL, Drive, DriveLimits
from sim_bridge.robot.odometry import SYSTEMATIC, OdometryDrift, WheelOdometry
from sim_bridge.robot.planar import ORIGIN, composed, inverse

DT_S = 0.02
LIMITS = DriveLimits(
    speed_m_s=0.5, turn_rad_s=1.2, acceleration_m_s2=1.0, turn_acceleration_rad_s2=4.0, braking=2.5
)
HALL = Rect(x_min_m=-5.0, y_min_m=-5.0, x_max_m=5.0, y_max_m=5.0)
START = Pose2D(x_m=1.0, y_m=-2.0, yaw_rad=0.7)
DRIFT = OdometryDrift(share_per_m=0.03, rad_per_m=0.02, rad_per_rad=0.05)


def drive_at(start: Pose2D, *rects: Rect) -> Drive:
    drive = Drive(Obstacles(rects, HALL), LIMITS, 0.15, 0.01)
    drive.place(start)
    return drive


def go(
    drive: Drive, odometry: WheelOdometry, linear: float, angular: float, seconds: float, slip: float = 0.0
) -> None:
    for _ in range(round(seconds / DT_S)):
        before = drive.pose
        drive.step(Velocity(linear_m_s=linear, angular_rad_s=angular), DT_S, slip)
        odometry.update(before, drive.pose, drive.velocity, DT_S)


def odometry_at(start: Pose2D, drift: OdometryDrift, seed: int = 0) -> WheelOdometry:
    return WheelOdometry(drift, np.random.default_rng(seed), start)


def test_without_drift_it_is_the_truth_and_no_rounding_adds_up() -> None:
    drive, odometry = drive_at(START), odometry_at(START, OdometryDrift())
    rng = np.random.default_rng(1)
    for _ in range(300):
        go(drive, odometry, rng.uniform(-1e3, 1e3), rng.uniform(-3.0, 3.0), 0.3)
        assert odometry.pose == composed(inverse(START), drive.pose)
        assert odometry.map_from_odom(drive.pose).distance_m(START) < 1e-12
        if not drive.blocked:
            assert odometry.twist.linear_m_s == pytest.approx(drive.velocity.linear_m_s, abs=1e-9)
            assert odometry.twist.angular_rad_s == pytest.approx(drive.velocity.angular_rad_s, abs=1e-9)


@pytest.mark.parametrize(("way_m", "steps"), [(1.0, 3), (1.0, 30), (4.0, 12)])
def test_the_error_of_a_straight_way_grows_as_documented_and_not_with_the_steps(
    way_m: float, steps: int
) -> None:
    drift = OdometryDrift(share_per_m=0.03, rad_per_m=0.02)
    far, turned = [], []
    for seed in range(1500):
        odometry = odometry_at(ORIGIN, drift, seed)
        poses = [Pose2D(x_m=way_m * step / steps, y_m=0.0) for step in range(steps + 1)]
        for before, after in itertools.pairwise(poses):
            speed = (after.x_m - before.x_m) / DT_S
            odometry.update(before, after, Velocity(linear_m_s=speed, angular_rad_s=0.0), DT_S)
        far.append(math.hypot(odometry.pose.x_m, odometry.pose.y_m) - way_m)
        turned.append(odometry.pose.yaw_rad)
    grown = way_m + (SYSTEMATIC * way_m) ** 2
    # The variance of 1500 draws is known to 4 % (one standard deviation).
    assert np.var(far) == pytest.approx(drift.share_per_m**2 * grown, rel=0.15)
    assert np.var(turned) == pytest.approx(drift.rad_per_m**2 * grown, rel=0.15)


@pytest.mark.parametrize("steps", [4, 40])
def test_the_error_of_a_turn_grows_as_documented(steps: int) -> None:
    drift, angle_rad = OdometryDrift(rad_per_rad=0.05), 2.0
    errors = []
    for seed in range(1500):
        odometry = odometry_at(ORIGIN, drift, seed)
        for step in range(steps):
            odometry.update(
                Pose2D(x_m=0.0, y_m=0.0, yaw_rad=angle_rad * step / steps),
                Pose2D(x_m=0.0, y_m=0.0, yaw_rad=angle_rad * (step + 1) / steps),
                Velocity(linear_m_s=0.0, angular_rad_s=angle_rad / steps / DT_S),
                DT_S,
            )
        errors.append(odometry.pose.yaw_rad - angle_rad)
        assert (odometry.pose.x_m, odometry.pose.y_m) == (0.0, 0.0)
    grown = angle_rad + (SYSTEMATIC * angle_rad) ** 2
    assert np.var(errors) == pytest.approx(drift.rad_per_rad**2 * grown, rel=0.15)


def test_the_correction_takes_odometry_to_the_truth() -> None:
    drive, odometry = drive_at(START), odometry_at(START, DRIFT)
    go(drive, odometry, 0.4, 0.3, 8.0)
    assert odometry.pose.distance_m(composed(inverse(START), drive.pose)) > 0.01
    found = composed(odometry.map_from_odom(drive.pose), odometry.pose)
    assert found.distance_m(drive.pose) < 1e-12
    assert abs(found.turn_rad(drive.pose)) < 1e-12


def test_a_robot_that_stands_does_not_drift() -> None:
    drive, odometry = drive_at(START), odometry_at(START, DRIFT)
    go(drive, odometry, 0.4, 0.3, 2.0)
    go(drive, odometry, 0.0, 0.0, 1.0)
    pose = odometry.pose
    go(drive, odometry, 0.0, 0.0, 60.0)
    assert odometry.pose == pose
    assert odometry.twist == STANDSTILL


def test_wheels_that_slip_claim_what_did_not_happen() -> None:
    drive, odometry = drive_at(ORIGIN), odometry_at(ORIGIN, OdometryDrift())
    go(drive, odometry, 0.5, 0.0, 4.0, slip=1.0)
    assert drive.pose == ORIGIN
    # Half a second to speed up, then 3.5 s at 0.5 m/s; the first step already ends faster.
    assert odometry.pose.x_m == pytest.approx(0.13 + 1.75, abs=1e-9)
    drive, odometry = drive_at(ORIGIN), odometry_at(ORIGIN, OdometryDrift())
    go(drive, odometry, 0.5, 0.0, 4.0, slip=0.25)
    assert drive.pose.x_m == pytest.approx(0.75 * odometry.pose.x_m, rel=1e-9)
    go(drive, odometry, 0.0, 0.0, 1.0)
    go(drive, odometry, 0.0, 1.0, 1.0, slip=0.5)
    assert drive.pose.yaw_rad == pytest.approx(0.5 * odometry.pose.yaw_rad, rel=1e-9)


def test_the_wheels_of_a_robot_that_is_stopped_by_a_wall_stand() -> None:
    wall = Rect(x_min_m=1.0, y_min_m=-2.0, x_max_m=1.1, y_max_m=2.0)
    drive, odometry = drive_at(ORIGIN, wall), odometry_at(ORIGIN, OdometryDrift())
    go(drive, odometry, 0.5, 0.0, 10.0)
    assert drive.blocked
    assert odometry.pose == drive.pose
    assert abs(odometry.twist.linear_m_s) < 0.01


def test_a_robot_that_is_carried_keeps_its_odometry() -> None:
    drive, odometry = drive_at(START), odometry_at(START, OdometryDrift())
    go(drive, odometry, 0.4, 0.0, 2.0)
    before = odometry.pose
    drive.place(Pose2D(x_m=-3.0, y_m=3.0, yaw_rad=-2.0))
    go(drive, odometry, 0.0, 0.0, 0.1)
    assert odometry.pose.distance_m(before) < 1e-12
    go(drive, odometry, 0.4, 0.0, 1.0)
    assert odometry.pose.distance_m(before) == pytest.approx(
        drive.pose.distance_m(Pose2D(x_m=-3.0, y_m=3.0)), abs=1e-12
    )
    found = composed(odometry.map_from_odom(drive.pose), odometry.pose)
    assert found.distance_m(drive.pose) < 1e-12


def test_the_same_seed_drifts_the_same_and_another_differently() -> None:
    ends = []
    for seed in (5, 5, 6):
        drive, odometry = drive_at(START), odometry_at(START, DRIFT, seed)
        go(drive, odometry, 0.4, 0.3, 3.0)
        ends.append(odometry.pose)
    assert ends[0] == ends[1] != ends[2]


@pytest.mark.parametrize("wrong", [-0.1, math.nan, math.inf])
def test_a_drift_that_cannot_be_is_refused(wrong: float) -> None:
    for name in ("share_per_m", "rad_per_m", "rad_per_rad"):
        with pytest.raises(BadParameterError, match=f"{name} of an odometry's drift must be 0 or more"):
            OdometryDrift(**{name: wrong})
