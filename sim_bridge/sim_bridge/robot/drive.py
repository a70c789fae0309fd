"""A differential drive on a flat floor: limits, motion along arcs, and a stop before anything is touched."""

import math
from dataclasses import dataclass

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.robot.obstacles import Obstacles

STANDSTILL = Velocity(linear_m_s=0.0, angular_rad_s=0.0)
# Halvings of a step that would end too close: to 1/64 of it.
HALVINGS = 6


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveLimits:
    """What the drive can do; braking is this much stronger than accelerating."""

    speed_m_s: float
    turn_rad_s: float
    acceleration_m_s2: float
    turn_acceleration_rad_s2: float
    braking: float


class Drive:
    """Where the robot is and how it moves. Owned by the simulation, stepped from its thread."""

    def __init__(
        self, obstacles: Obstacles, limits: DriveLimits, radius_m: float, stop_distance_m: float
    ) -> None:
        self.obstacles = obstacles
        self.limits = limits
        self.keep_m = radius_m + stop_distance_m
        self.pose = Pose2D(x_m=0.0, y_m=0.0)
        self.velocity = STANDSTILL
        self.blocked = False

    def place(self, pose: Pose2D) -> None:
        """Put the robot somewhere, standing. Raises BadMessageError where it does not fit."""
        clearance_m = self.obstacles.clearance_m(pose.x_m, pose.y_m)
        if clearance_m < self.keep_m:
            raise BadMessageError(
                f"the robot does not fit at ({pose.x_m:.2f}, {pose.y_m:.2f}): {describe(clearance_m)}, "
                f"it needs {self.keep_m:.2f} m"
            )
        self.pose = pose
        self.velocity = STANDSTILL
        self.blocked = False

    def step(self, wanted: Velocity, dt_s: float) -> None:
        """Move for `dt_s` as near to the wanted velocity as the limits allow.

        A step that would bring something nearer than the kept distance is shortened to end there and the
        robot stands; it still turns, and it still drives away. `blocked` tells whether that happened.
        """
        limits = self.limits
        linear = _approached(
            self.velocity.linear_m_s,
            _clamped(wanted.linear_m_s, limits.speed_m_s),
            limits.acceleration_m_s2 * dt_s,
            limits.braking,
        )
        angular = _approached(
            self.velocity.angular_rad_s,
            _clamped(wanted.angular_rad_s, limits.turn_rad_s),
            limits.turn_acceleration_rad_s2 * dt_s,
            limits.braking,
        )
        x_m, y_m, yaw_rad = _moved(self.pose, linear, angular, dt_s)
        self.blocked = linear != 0.0 and not self._may_be_at(x_m, y_m)
        if self.blocked:
            x_m, y_m = self._as_far_as_possible(linear, angular, dt_s)
            linear = 0.0
        self.pose = Pose2D(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)
        self.velocity = Velocity(linear_m_s=linear, angular_rad_s=angular)

    def _may_be_at(self, x_m: float, y_m: float) -> bool:
        clearance_m = self.obstacles.clearance_m(x_m, y_m)
        if clearance_m >= self.keep_m:
            return True
        # Already too close, as after a change of parameters: only away from it.
        return clearance_m > self.obstacles.clearance_m(self.pose.x_m, self.pose.y_m)

    def _as_far_as_possible(self, linear: float, angular: float, dt_s: float) -> tuple[float, float]:
        """The end of the longest part of the step that keeps the distance, by halving."""
        reached = (self.pose.x_m, self.pose.y_m)
        low_s, high_s = 0.0, dt_s
        for _ in range(HALVINGS):
            middle_s = (low_s + high_s) / 2.0
            x_m, y_m, _ = _moved(self.pose, linear, angular, middle_s)
            if self._may_be_at(x_m, y_m):
                low_s, reached = middle_s, (x_m, y_m)
            else:
                high_s = middle_s
        return reached


def describe(clearance_m: float) -> str:
    """How near the nearest obstacle is, in words."""
    if clearance_m <= 0.0:
        return "that is inside a wall or furniture, or outside the home"
    return f"the nearest obstacle is {clearance_m:.2f} m away"


def _clamped(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _approached(now: float, wanted: float, change: float, braking: float) -> float:
    """`now` moved towards `wanted` by at most `change`, or that times `braking` while it slows down."""
    slows = abs(wanted) < abs(now) or now * wanted < 0.0
    limit = change * braking if slows else change
    return now + _clamped(wanted - now, limit)


def _moved(pose: Pose2D, linear: float, angular: float, dt_s: float) -> tuple[float, float, float]:
    """The pose after `dt_s` along the exact arc."""
    half_rad = angular * dt_s / 2.0
    # sin(h) / h: the chord of the arc over its length.
    chord = linear * dt_s * (math.sin(half_rad) / half_rad if half_rad != 0.0 else 1.0)
    heading = pose.yaw_rad + half_rad
    x_m = pose.x_m + chord * math.cos(heading)
    y_m = pose.y_m + chord * math.sin(heading)
    return x_m, y_m, math.remainder(pose.yaw_rad + 2.0 * half_rad, math.tau)
