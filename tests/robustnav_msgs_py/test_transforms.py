"""The tree of frames says what `frames` computes."""

import math
import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message

from robustnav_msgs_py.conversions import (
    Transform,
    camera_transform,
    planar_transform,
    tf_available,
    tf_message,
    transform_from_message,
    transform_to_message,
)
from robustnav_msgs_py.conversions.transforms import TF_PACKAGE
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.frames import CameraMount, base_from_optical, map_from_base
from robustnav_msgs_py.values import Float64, Pose2D

POINTS = np.random.default_rng(0).normal(size=(6, 3))
NUMBERS = st.floats(-1e3, 1e3)


def moved(transform: Transform, points: Float64) -> Float64:
    """Points of the child frame in the parent's, by the definition of a unit quaternion."""
    x, y, z, w = transform.quaternion
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    result: Float64 = points @ turn.T + (transform.x_m, transform.y_m, transform.z_m)
    return result


@given(st.floats(-1.5, 1.5), NUMBERS, NUMBERS)
def test_the_camera_is_where_frames_say(pitch_rad: float, x_m: float, z_m: float) -> None:
    mount = CameraMount(x_m=x_m, z_m=z_m, pitch_rad=pitch_rad)
    transform = camera_transform(mount, 5)
    assert (transform.parent, transform.child, transform.stamp_ns) == ("base_link", "camera_optical_frame", 5)
    assert np.allclose(moved(transform, POINTS), base_from_optical(mount, POINTS), atol=1e-9)


@given(NUMBERS, NUMBERS, st.floats(-7.0, 7.0))
def test_a_robot_is_where_frames_say(x_m: float, y_m: float, yaw_rad: float) -> None:
    pose = Pose2D(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)
    transform = planar_transform("map", "base_link", pose, 0)
    assert np.allclose(moved(transform, POINTS), map_from_base(pose, POINTS), atol=1e-9)


def test_a_level_camera_looks_along_x() -> None:
    transform = camera_transform(CameraMount(pitch_rad=0.0), 0)
    assert transform.quaternion == pytest.approx((-0.5, 0.5, -0.5, 0.5))


def test_a_laser_stands_upright_above_the_floor() -> None:
    transform = planar_transform("base_link", "laser", Pose2D(x_m=0.0, y_m=0.0), 0, z_m=0.2)
    assert np.allclose(moved(transform, POINTS), POINTS + np.array([0.0, 0.0, 0.2]))


@given(st.floats(-1.5, 1.5), st.integers(0, 2**31 * 10**9 - 1))
def test_a_transform_comes_back_from_the_wire_unchanged(pitch_rad: float, stamp_ns: int) -> None:
    transform = camera_transform(CameraMount(pitch_rad=pitch_rad), stamp_ns)
    message: Any = transform_to_message(transform)
    assert transform_from_message(deserialize_message(serialize_message(message), type(message))) == transform


@pytest.mark.parametrize(
    ("changed", "match"),
    [
        ({"parent": ""}, "joins two frames, not '' and 'odom'"),
        ({"child": "map"}, "joins two frames"),
        ({"child": "/odom"}, "without a slash in front"),
        ({"z_m": math.nan}, "must be finite"),
        ({"quaternion": (0.0, 0.0, 0.0, math.inf)}, "must be finite"),
        ({"quaternion": (0.0, 0.0, 0.0, 0.0)}, "must have length 1, not 0"),
    ],
)
def test_transforms_that_cannot_be_are_refused(changed: dict[str, Any], match: str) -> None:
    with pytest.raises(BadMessageError, match=match):
        Transform(**{"parent": "map", "child": "odom", **changed})


def test_a_tf_message_holds_all_transforms(monkeypatch: pytest.MonkeyPatch) -> None:
    transforms = [
        planar_transform("map", "odom", Pose2D(x_m=1.0, y_m=2.0, yaw_rad=0.3), 7),
        camera_transform(CameraMount(), 7),
    ]
    if not tf_available():
        # Stands in for the package that only a ROS from apt has.
        package, messages = ModuleType(TF_PACKAGE), ModuleType(f"{TF_PACKAGE}.msg")
        messages.TFMessage = SimpleNamespace  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, TF_PACKAGE, package)
        monkeypatch.setitem(sys.modules, f"{TF_PACKAGE}.msg", messages)
    assert [transform_from_message(item) for item in tf_message(transforms).transforms] == transforms


@pytest.mark.skipif(tf_available(), reason="there is a tf2_msgs here")
def test_without_tf2_msgs_a_sentence_says_so() -> None:
    with pytest.raises(BadMessageError, match="there is no tf2_msgs here .* it comes with ROS from apt"):
        tf_message([])
