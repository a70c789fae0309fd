"""A differential drive on a flat floor: limits, motion along arcs, and a stop before anything is touched."""

import math
from dataclasses import dataclass

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.homes.obstacles import Obstacles
from sim_bridge.homes.rect import Rect

STANDSTILL = Velocity(linear_m_s=0.0, angular_rad_s=0.0)
STANDING_M_S = 1e-3
STANDING_RAD_S = 1e-2
# What counts as the same place: a standing robot may be set right by this much.
SETTLE_M = 0.002
SETTLE_RAD = math.radians(0.2)
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
    """Where the robot is and how it moves. Owned by the simulation, stepped from its thread.

    `velocity` is what the wheels do; the robot does the same unless they slip.
    """

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

    @property
    def stands(self) -> bool:
        """Whether it moves too slowly to matter."""
        velocity = self.velocity
        return abs(velocity.linear_m_s) < STANDING_M_S and abs(velocity.angular_rad_s) < STANDING_RAD_S

    def settle(self, pose: Pose2D) -> bool:
        """Take `pose` for the exact one, where the robot stands there but for a hair.

        False, and nothing changes, where it moves, where `pose` is further off than `SETTLE_M` or
        `SETTLE_RAD`, or where something is too near to it.
        """
        near = self.pose.distance_m(pose) <= SETTLE_M and abs(self.pose.turn_rad(pose)) <= SETTLE_RAD
        if not (near and self.stands):
            return False
        here_m = self.obstacles.clearance_m(self.pose.x_m, self.pose.y_m)
        if self.obstacles.clearance_m(pose.x_m, pose.y_m) < min(self.keep_m, here_m):
            return False
        self.pose = Pose2D(x_m=pose.x_m, y_m=pose.y_m, yaw_rad=math.remainder(pose.yaw_rad, math.tau))
        self.velocity = STANDSTILL
        return True

    def is_in_the_way_of(self, area: Rect) -> bool:
        """Whether something that filled the area would be too near to the robot."""
        beyond_x = max(area.x_min_m - self.pose.x_m, self.pose.x_m - area.x_max_m, 0.0)
        beyond_y = max(area.y_min_m - self.pose.y_m, self.pose.y_m - area.y_max_m, 0.0)
        return math.hypot(beyond_x, beyond_y) < self.keep_m

    def replace_obstacles(self, obstacles: Obstacles) -> None:
        """Go on among other obstacles: a door has been closed, a thing has been put elsewhere.

        Raises BadMessageError, and nothing changes, where the robot itself is in the way of a new one.
        """
        x_m, y_m = self.pose.x_m, self.pose.y_m
        clearance_m = obstacles.clearance_m(x_m, y_m)
        if clearance_m < self.keep_m and clearance_m < self.obstacles.clearance_m(x_m, y_m):
            raise BadMessageError(
                f"the robot is in the way at ({x_m:.2f}, {y_m:.2f}): what is put there leaves it "
                f"{max(clearance_m, 0.0):.2f} m, it needs {self.keep_m:.2f} m; drive it away first"
            )
        self.obstacles = obstacles

    def step(self, wanted: Velocity, dt_s: float, slip: float = 0.0) -> None:
        """Move for `dt_s` as near to the wanted velocity as the limits allow.

        A step that would bring something nearer than the kept distance is shortened to end there and the
        robot stands; it still turns, and it still drives away. `blocked` tells whether that happened.
        `slip` is the share (0..1) of the wheels' motion that comes to nothing.
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
        grip_s = (1.0 - slip) * dt_s
        x_m, y_m, yaw_rad = _moved(self.pose, linear, angular, grip_s)
        self.blocked = linear != 0.0 and not self._may_be_at(x_m, y_m)
        if self.blocked:
            x_m, y_m = self._as_far_as_possible(linear, angular, grip_s)
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
