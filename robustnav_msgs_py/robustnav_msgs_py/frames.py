"""Where things are: map <- base_link <- camera optical frame, for a robot on a flat floor."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64, Pose2D


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraMount:
    """How the camera sits on the robot: forward of and above `base_link`, pitched down by `pitch_rad`."""

    x_m: float = 0.1
    z_m: float = 1.1
    pitch_rad: float = 0.26


def base_from_optical(mount: CameraMount, points_m: NDArray[np.floating]) -> Float64:
    """Move points [n, 3] from the optical frame (z forward, x right, y down) to `base_link`."""
    points = np.asarray(points_m, dtype=np.float64)
    right, down, forward = points[:, 0], points[:, 1], points[:, 2]
    cos, sin = math.cos(mount.pitch_rad), math.sin(mount.pitch_rad)
    x = mount.x_m + cos * forward - sin * down
    z = mount.z_m - sin * forward - cos * down
    return np.stack([x, -right, z], axis=1)


def optical_from_base(mount: CameraMount, points_m: NDArray[np.floating]) -> Float64:
    """Inverse of `base_from_optical`."""
    points = np.asarray(points_m, dtype=np.float64)
    x, z = points[:, 0] - mount.x_m, points[:, 2] - mount.z_m
    cos, sin = math.cos(mount.pitch_rad), math.sin(mount.pitch_rad)
    return np.stack([-points[:, 1], -sin * x - cos * z, cos * x - sin * z], axis=1)


def map_from_base(pose: Pose2D, points_m: NDArray[np.floating]) -> Float64:
    """Move points [n, 3] from `base_link` of a robot at `pose` to `map`."""
    points = np.asarray(points_m, dtype=np.float64)
    cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    x = pose.x_m + cos * points[:, 0] - sin * points[:, 1]
    y = pose.y_m + sin * points[:, 0] + cos * points[:, 1]
    return np.stack([x, y, points[:, 2]], axis=1)


def base_from_map(pose: Pose2D, points_m: NDArray[np.floating]) -> Float64:
    """Inverse of `map_from_base`."""
    points = np.asarray(points_m, dtype=np.float64)
    dx, dy = points[:, 0] - pose.x_m, points[:, 1] - pose.y_m
    cos, sin = math.cos(pose.yaw_rad), math.sin(pose.yaw_rad)
    return np.stack([cos * dx + sin * dy, cos * dy - sin * dx, points[:, 2]], axis=1)
