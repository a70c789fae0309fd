"""Frames: what is straight ahead stays so, and every move can be taken back."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.frames import (
    CameraMount,
    base_from_map,
    base_from_optical,
    map_from_base,
    optical_from_base,
)
from robustnav_msgs_py.values import Pose2D

POINTS = st.lists(st.tuples(*[st.floats(-10, 10)] * 3), min_size=1, max_size=5).map(np.array)


def test_level_camera_sees_ahead_along_x() -> None:
    mount = CameraMount(x_m=0.1, z_m=1.0, pitch_rad=0.0)
    # 2 m ahead, 0.5 m to the right, 0.3 m below the camera
    assert np.allclose(base_from_optical(mount, np.array([[0.5, 0.3, 2.0]])), [[2.1, -0.5, 0.7]])


def test_pitched_camera_meets_the_floor() -> None:
    mount = CameraMount(x_m=0.0, z_m=1.0, pitch_rad=math.pi / 4)
    assert np.allclose(base_from_optical(mount, np.array([[0.0, 0.0, math.sqrt(2.0)]])), [[1.0, 0.0, 0.0]])


def test_a_robot_facing_north_sees_ahead_along_y() -> None:
    robot = Pose2D(x_m=1.0, y_m=2.0, yaw_rad=math.pi / 2)
    assert np.allclose(map_from_base(robot, np.array([[3.0, 1.0, 0.5]])), [[0.0, 5.0, 0.5]])


@given(points=POINTS, pitch=st.floats(-1.5, 1.5), yaw=st.floats(-4, 4))
def test_inverses(points: np.ndarray, pitch: float, yaw: float) -> None:
    mount, robot = CameraMount(pitch_rad=pitch), Pose2D(x_m=1.0, y_m=-2.0, yaw_rad=yaw)
    assert np.allclose(optical_from_base(mount, base_from_optical(mount, points)), points)
    assert np.allclose(base_from_map(robot, map_from_base(robot, points)), points)
