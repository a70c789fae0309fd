"""Poses put together and taken back."""

import math

from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.values import Pose2D
from sim_bridge.robot.planar import ORIGIN, composed, inverse

NUMBERS = st.floats(-20.0, 20.0)
POSES = st.builds(lambda x, y, yaw: Pose2D(x_m=x, y_m=y, yaw_rad=yaw), NUMBERS, NUMBERS, st.floats(-7.0, 7.0))


def is_near(one: Pose2D, other: Pose2D) -> bool:
    return one.distance_m(other) < 1e-9 and abs(one.turn_rad(other)) < 1e-9


@given(POSES)
def test_a_pose_and_its_inverse_are_the_origin_in_either_order(pose: Pose2D) -> None:
    assert is_near(composed(pose, inverse(pose)), ORIGIN)
    assert is_near(composed(inverse(pose), pose), ORIGIN)


@given(POSES, POSES, POSES)
def test_it_does_not_matter_which_two_of_three_are_put_together_first(
    a: Pose2D, b: Pose2D, c: Pose2D
) -> None:
    assert is_near(composed(composed(a, b), c), composed(a, composed(b, c)))


def test_two_metres_ahead_of_a_robot_that_looks_north_lie_north_of_it() -> None:
    robot = Pose2D(x_m=1.0, y_m=2.0, yaw_rad=math.pi / 2)
    assert is_near(composed(robot, Pose2D(x_m=2.0, y_m=0.0)), Pose2D(x_m=1.0, y_m=4.0, yaw_rad=math.pi / 2))
