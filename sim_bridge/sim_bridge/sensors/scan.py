"""The robot's laser: rays all around in one plane."""

import math

import numpy as np

from robustnav_msgs_py.values import LaserScan, Pose2D
from sim_bridge.sensors.world import NOTHING, World

LASER_FRAME = "laser"
LASER_HEIGHT_M = 0.20
RANGE_MIN_M = 0.05


class Laser:
    """Scans one world from the middle of the robot, 0.2 m above the floor. Same thread as the world."""

    def __init__(self, world: World, rays: int, range_m: float) -> None:
        self._world = world
        self._range_m = range_m
        self._step_rad = math.tau / rays
        self._angles_rad = -math.pi + self._step_rad * np.arange(rays)

    def take(self, pose: Pose2D, stamp_ns: int) -> LaserScan:
        """Ranges around the robot at `pose`, from behind it counter-clockwise; some 0.5 ms for 360 rays."""
        angles = self._angles_rad + pose.yaw_rad
        starts = np.tile((pose.x_m, pose.y_m, LASER_HEIGHT_M), (len(angles), 1))
        ends = starts.copy()
        ends[:, 0] += self._range_m * np.cos(angles)
        ends[:, 1] += self._range_m * np.sin(angles)
        shares, bodies = self._world.cast(starts, ends)
        ranges = np.where(bodies == NOTHING, np.inf, shares * self._range_m).astype(np.float32)
        return LaserScan(
            ranges_m=ranges,
            angle_min_rad=-math.pi,
            angle_step_rad=self._step_rad,
            range_min_m=RANGE_MIN_M,
            range_max_m=self._range_m,
            stamp_ns=stamp_ns,
            frame_id=LASER_FRAME,
        )
