"""How fast to go towards an end, and how to tell that nothing comes of going."""

import math

from robustnav_msgs_py.values import Pose2D

# Braking is planned with this share of what the drive can do, so that an end is not overrun.
BRAKING_SHARE = 0.8
# Less than this in so long is no progress: the wheels slip.
PROGRESS_M = 0.005
PROGRESS_RAD = math.radians(0.5)
PATIENCE_S = 5.0


def approach_speed(distance: float, highest: float, acceleration: float, dt_s: float) -> float:
    """The speed from which the distance is enough to brake, when a step of `dt_s` has been made with it.

    `distance` (m or rad) is not negative; the others are in its unit, per second or per second squared.
    """
    slowing = BRAKING_SHARE * acceleration
    # The v with v dt + v^2 / (2 slowing) = distance, without the difference of two nearly equal roots.
    per_step = slowing * dt_s
    return min(
        highest, 2.0 * slowing * distance / (per_step + math.sqrt(per_step**2 + 2.0 * slowing * distance))
    )


class Progress:
    """Tells when a robot that is being driven stays where it is."""

    def __init__(self) -> None:
        self._from: Pose2D | None = None
        self._since_s = 0.0

    def restart(self) -> None:
        """Begin to wait anew."""
        self._from = None
        self._since_s = 0.0

    def is_missing(self, pose: Pose2D, dt_s: float) -> bool:
        """Whether the robot, now at `pose`, has stayed there too long; call it once per driven step."""
        begin = self._from
        if begin is None or begin.distance_m(pose) > PROGRESS_M or abs(begin.turn_rad(pose)) > PROGRESS_RAD:
            self._from = pose
            self._since_s = 0.0
        self._since_s += dt_s
        return self._since_s > PATIENCE_S
