"""What the wheels say about where the robot is: the truth, and an error that grows with the way.

Two kinds of error are added up. One is drawn anew for every bit of way, so that its variance grows with the
way and does not depend on the length of a step. The other is built into the robot (worn wheels, a wrong wheel
base): drawn once, it grows with the way itself. After a way of L metres straight ahead the variances are

    of the distance    share_per_m^2 (L + (SYSTEMATIC L)^2)
    of the heading     rad_per_m^2   (L + (SYSTEMATIC L)^2)

and a turn of A radians in place adds rad_per_rad^2 (A + (SYSTEMATIC A)^2) to the heading's.
"""

import math
from dataclasses import dataclass, fields

import numpy as np

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.robot.planar import ORIGIN, composed, inverse

# The error built into a robot, after the first metre or radian, over the random one.
SYSTEMATIC = 0.5
# Wheels that claim no more than this beyond what the robot did have not slipped: it is rounding.
ROUNDING = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class OdometryDrift:
    """Standard deviations of the random error after one metre, or one radian; all zero: no drift.

    `share_per_m`: of the distance, as a share of that metre; `rad_per_m`: of the heading after a metre;
    `rad_per_rad`: of the heading after a radian turned.
    """

    share_per_m: float = 0.0
    rad_per_m: float = 0.0
    rad_per_rad: float = 0.0

    def __post_init__(self) -> None:
        for item in fields(self):
            value = getattr(self, item.name)
            if not (math.isfinite(value) and value >= 0.0):
                raise BadParameterError(
                    f"{item.name} of an odometry's drift must be 0 or more, not {value!r}"
                )


class WheelOdometry:
    """Adds up what the wheels claim. Owned by the simulation, updated once per step from its thread.

    `pose` is in frame `odom`, whose origin is the pose at the start; `twist` is what the wheels do, with the
    error that is built in but without the noise, which a driver would have filtered.
    """

    def __init__(self, drift: OdometryDrift, rng: np.random.Generator, start: Pose2D) -> None:
        """`start`: the robot's true pose in `map` as the odometry begins."""
        self.pose = ORIGIN
        self.twist = Velocity(linear_m_s=0.0, angular_rad_s=0.0)
        self._drift = drift
        self._rng = rng
        self._true = start
        # Kept instead of adding up steps: without an error it does not change, so that no rounding adds up.
        self._odom_from_map = inverse(start)
        built_in = SYSTEMATIC * rng.standard_normal(3)
        self._too_far_per_m = float(built_in[0]) * drift.share_per_m
        self._turn_per_m = float(built_in[1]) * drift.rad_per_m
        self._turn_per_rad = float(built_in[2]) * drift.rad_per_rad

    def update(self, true_before: Pose2D, true_after: Pose2D, claimed: Velocity, dt_s: float) -> None:
        """One step of `dt_s`: where the robot truly was and is (in `map`), and how fast the wheels turned.

        Wheels may turn more than the robot moves, when they slip, but never less: a robot that was stopped
        within the step has turned them as far as it came. A robot that is found elsewhere than the last step
        left it has been carried there, which the wheels do not notice.
        """
        if true_before != self._true:
            self._odom_from_map = composed(self.pose, inverse(true_before))
        self._true = true_after
        way_m, turn_rad = _motion(true_before, true_after)
        extra_m = _excess(claimed.linear_m_s * dt_s, way_m)
        extra_rad = _excess(claimed.angular_rad_s * dt_s, turn_rad)
        way_m, turn_rad = way_m + extra_m, turn_rad + extra_rad

        built_in_m = self._too_far_per_m * way_m
        built_in_rad = self._turn_per_m * abs(way_m) + self._turn_per_rad * turn_rad
        noise_m, noise_rad = self._noise(abs(way_m), abs(turn_rad))
        error = Pose2D(
            x_m=extra_m + built_in_m + noise_m, y_m=0.0, yaw_rad=extra_rad + built_in_rad + noise_rad
        )
        self.pose = composed(self._odom_from_map, true_after)
        if error != ORIGIN:
            self.pose = composed(self.pose, error)
            self._odom_from_map = composed(self.pose, inverse(true_after))
        self.twist = Velocity(
            linear_m_s=(way_m + built_in_m) / dt_s, angular_rad_s=(turn_rad + built_in_rad) / dt_s
        )

    def map_from_odom(self, true_pose: Pose2D) -> Pose2D:
        """The correction that a perfect localiser publishes, which finds the robot at `true_pose`."""
        return composed(true_pose, inverse(self.pose))

    def _noise(self, way_m: float, turn_rad: float) -> tuple[float, float]:
        """The random error of a bit of way: along it, and of the heading."""
        drift = self._drift
        noise_m = drift.share_per_m * math.sqrt(way_m)
        noise_rad = math.sqrt(drift.rad_per_m**2 * way_m + drift.rad_per_rad**2 * turn_rad)
        if noise_m == 0.0 and noise_rad == 0.0:
            return 0.0, 0.0
        along, heading = self._rng.standard_normal(2)
        return float(along) * noise_m, float(heading) * noise_rad


def _motion(before: Pose2D, after: Pose2D) -> tuple[float, float]:
    """The arc from one pose to the other: metres (negative: backwards) and radians."""
    turn_rad = before.turn_rad(after)
    half_rad = turn_rad / 2.0
    heading = before.yaw_rad + half_rad
    chord_m = (after.x_m - before.x_m) * math.cos(heading) + (after.y_m - before.y_m) * math.sin(heading)
    return chord_m * (half_rad / math.sin(half_rad) if half_rad != 0.0 else 1.0), turn_rad


def _excess(claimed: float, true: float) -> float:
    """What the wheels claim beyond what happened."""
    return claimed - true if abs(claimed) > abs(true) + ROUNDING else 0.0
