"""Poses on the floor as transforms: one put after the other, and taken back."""

import math

from robustnav_msgs_py.values import Pose2D

ORIGIN = Pose2D(x_m=0.0, y_m=0.0)


def composed(first: Pose2D, then: Pose2D) -> Pose2D:
    """`then`, given in the frame of `first`, in the frame in which `first` is given: a_from_c."""
    cos, sin = math.cos(first.yaw_rad), math.sin(first.yaw_rad)
    return Pose2D(
        x_m=first.x_m + cos * then.x_m - sin * then.y_m,
        y_m=first.y_m + sin * then.x_m + cos * then.y_m,
        yaw_rad=math.remainder(first.yaw_rad + then.yaw_rad, math.tau),
    )


def inverse(pose: Pose2D) -> Pose2D:
    """What `pose` undoes: composed with it, in either order, it gives the origin."""
    cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    return Pose2D(
        x_m=-cos * pose.x_m - sin * pose.y_m,
        y_m=sin * pose.x_m - cos * pose.y_m,
        yaw_rad=-math.remainder(pose.yaw_rad, math.tau),
    )
