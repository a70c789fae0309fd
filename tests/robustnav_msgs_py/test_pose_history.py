"""Where the robot was at a stamp: interpolated, across the seam of headings, forgotten after a reset."""

import math

import pytest

from robustnav_msgs_py.pose_history import KEEP_NS, PoseHistory
from robustnav_msgs_py.values import Odometry, Pose2D

S = 1_000_000_000


def odometry(stamp_ns: int, x_m: float = 0.0, yaw_rad: float = 0.0) -> Odometry:
    pose = Pose2D(x_m=x_m, y_m=0.0, yaw_rad=yaw_rad)
    return Odometry(pose=pose, linear_m_s=0.0, angular_rad_s=0.0, stamp_ns=stamp_ns)


def test_between_two_poses() -> None:
    history = PoseHistory()
    history.add(odometry(1 * S, 0.0, math.pi - 0.1))
    history.add(odometry(2 * S, 1.0, -math.pi + 0.1))
    between = history.at(3 * S // 2)
    assert between is not None
    assert between.pose.x_m == pytest.approx(0.5)
    assert abs(between.pose.yaw_rad) == pytest.approx(math.pi)


def test_nothing_near_is_nothing() -> None:
    history = PoseHistory()
    assert history.latest is None
    assert history.at(0) is None
    history.add(odometry(10 * S))
    assert history.at(11 * S) is None
    assert history.at(10 * S + S // 10) is not None


def test_a_reset_forgets_and_late_odometry_is_dropped() -> None:
    history = PoseHistory()
    history.add(odometry(20 * S, 5.0))
    assert not history.add(odometry(20 * S - 1, 9.0))
    assert history.latest is not None
    assert history.latest.pose.x_m == 5.0
    assert history.add(odometry(1 * S, 0.0))
    assert history.at(20 * S) is None


def test_the_past_is_bounded() -> None:
    history = PoseHistory()
    for tick in range(1000):
        history.add(odometry(tick * S // 10))
    assert history.at(999 * S // 10 - 2 * KEEP_NS) is None
