"""Discrete actions, as benchmarks of embodied agents have them: so far ahead, so far round, stop.

They are exact: each one ends on the pose that geometry gives, so that 24 turns of 15 degrees come back to the
heading where they began, and four sides of a square to its corner.
"""

import math
import re
from collections import deque
from dataclasses import dataclass

from robustnav_msgs_py.errors import BadMessageError, RobustnavError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.robot.approach import Progress, approach_speed
from sim_bridge.robot.drive import STANDSTILL, Drive
from sim_bridge.robot.planar import composed

# The usual steps of embodied benchmarks, and those of the search's lattice of poses.
BENCHMARK_STEP_M, BENCHMARK_TURN_RAD = 0.25, math.radians(15.0)
LATTICE_STEP_M, LATTICE_TURN_RAD = 0.30, math.radians(30.0)
MOST_M = 10.0
MOST_TURN_RAD = math.tau
MOST_WAITING = 20
MOST_CHARACTERS = 60
REACHED_M = 0.001
REACHED_RAD = 0.002
FORMS = "'forward [METRES]', 'back [METRES]', 'left [DEGREES]', 'right [DEGREES]' or 'stop'"
NUMBER = re.compile(r"\d{1,6}(\.\d{1,9})?", re.ASCII)


class ActionRefusedError(RobustnavError):
    """The robot does not take the action; the sentence says why."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Action:
    """Drive `forward_m` straight ahead (negative: back) or turn by `turn_rad` on the spot; neither: stop."""

    forward_m: float = 0.0
    turn_rad: float = 0.0

    def __post_init__(self) -> None:
        if self.forward_m != 0.0 and self.turn_rad != 0.0:
            raise BadMessageError(f"an action drives or turns, not both: {self!r}")
        if not abs(self.forward_m) <= MOST_M:
            raise BadMessageError(f"an action drives at most {MOST_M:g} m, not {self.forward_m!r}")
        if not abs(self.turn_rad) <= MOST_TURN_RAD:
            raise BadMessageError(f"an action turns by at most one turn, not {self.turn_rad!r} rad")

    def __str__(self) -> str:
        if self.forward_m != 0.0:
            return f"{'forward' if self.forward_m > 0.0 else 'back'} {abs(self.forward_m):g}"
        if self.turn_rad != 0.0:
            return f"{'left' if self.turn_rad > 0.0 else 'right'} {math.degrees(abs(self.turn_rad)):g}"
        return "stop"

    @property
    def stops(self) -> bool:
        """Whether it ends everything before it."""
        return self.forward_m == 0.0 and self.turn_rad == 0.0


STOP = Action()


def parse_action(line: str, step_m: float = BENCHMARK_STEP_M, turn_rad: float = BENCHMARK_TURN_RAD) -> Action:
    """The action that a person types, as 'forward', 'forward 0.3', 'left 30' (degrees) or 'stop'.

    `step_m` and `turn_rad` are taken where the line holds no number. Raises BadMessageError, with the forms
    that are understood, where the line is none of them.
    """
    words = line.casefold().split() if len(line) <= MOST_CHARACTERS else []
    if words == ["stop"]:
        return STOP
    if len(words) not in (1, 2) or words[0] not in ("forward", "back", "left", "right"):
        raise BadMessageError(f"there is no action {line[:MOST_CHARACTERS]!r}; type {FORMS}")
    drives, sign = words[0] in ("forward", "back"), 1.0 if words[0] in ("forward", "left") else -1.0
    amount = step_m if drives else turn_rad
    if len(words) > 1:
        most = MOST_M if drives else math.degrees(MOST_TURN_RAD)
        typed = float(words[1]) if NUMBER.fullmatch(words[1]) else 0.0
        if not 0.0 < typed <= most:
            raise BadMessageError(
                f"{words[0]} takes {'metres' if drives else 'degrees'}, more than 0 and at most {most:g}, "
                f"not {words[1]!r}; type {FORMS}"
            )
        amount = typed if drives else math.radians(typed)
    return Action(forward_m=sign * amount) if drives else Action(turn_rad=sign * amount)


class ActionRunner:
    """Carries actions out one after the other. Owned by the simulation, stepped from its thread.

    `problem` is the sentence about why an action ended early; it is "" until one does, and again once another
    action is accepted. Those that wait already begin where the robot was stopped.
    """

    def __init__(self, drive: Drive) -> None:
        self.problem = ""
        self._drive = drive
        self._waiting: deque[Action] = deque()
        self._action: Action | None = None
        self._begin = self._end = self._seen = drive.pose
        self._turned_rad = 0.0
        self._driven = False
        self._progress = Progress()

    @property
    def busy(self) -> bool:
        """Whether there is an action to carry out."""
        return self._action is not None or bool(self._waiting)

    def accept(self, action: Action) -> None:
        """Carry the action out after those before; 'stop' ends them all, and the robot brakes.

        Raises ActionRefusedError, and changes nothing, where too many wait already.
        """
        if action.stops:
            self.cancel()
            return
        if len(self._waiting) >= MOST_WAITING:
            raise ActionRefusedError(
                f"{len(self._waiting)} actions wait already: '{action}' is not taken; "
                "wait until some are done, or type 'stop'"
            )
        self._waiting.append(action)
        self.problem = ""

    def cancel(self) -> None:
        """Forget all actions, and what was wrong with them."""
        self._waiting.clear()
        self._action = None
        self.problem = ""

    def wanted(self, dt_s: float) -> Velocity:
        """The velocity to drive for the next `dt_s`; standstill when idle."""
        while self.busy:
            if self._action is None:
                # To the last bit: a heading that still creeps would be off by the end of a long way.
                if self._drive.velocity != STANDSTILL:
                    return STANDSTILL
                self._next()
            left_m, left_rad = self._left()
            arrived = abs(left_m) <= REACHED_M and abs(left_rad) <= REACHED_RAD and self._drive.stands
            if arrived or self._is_held(dt_s):
                self._finish()
            else:
                self._driven = True
                return self._towards(left_m, left_rad, dt_s)
        return STANDSTILL

    def _next(self) -> None:
        """Begin with the action that has waited longest, from where the robot stands."""
        self._action = action = self._waiting.popleft()
        self._begin = self._seen = pose = self._drive.pose
        self._end = composed(pose, Pose2D(x_m=action.forward_m, y_m=0.0, yaw_rad=action.turn_rad))
        self._turned_rad = 0.0
        self._driven = False
        self._progress.restart()

    def _left(self) -> tuple[float, float]:
        """Metres to drive along the heading of the beginning, and radians to turn."""
        pose = self._drive.pose
        # Added up: a turn may be longer than half a circle.
        self._turned_rad += self._seen.turn_rad(pose)
        self._seen = pose
        cos, sin = math.cos(self._begin.yaw_rad), math.sin(self._begin.yaw_rad)
        left_m = (self._end.x_m - pose.x_m) * cos + (self._end.y_m - pose.y_m) * sin
        turn_rad = self._action.turn_rad if self._action is not None else 0.0
        return left_m, turn_rad - self._turned_rad

    def _is_held(self, dt_s: float) -> bool:
        """Whether something has stopped the robot since the action began, or its wheels only slip."""
        if not self._driven:
            return False
        return self._drive.blocked or self._progress.is_missing(self._drive.pose, dt_s)

    def _finish(self) -> None:
        """End on the very pose that the action leads to, or say what kept the robot from it."""
        action, drive = self._action, self._drive
        self._action = None
        if drive.settle(self._end):
            return
        reason = "something is in the way" if drive.blocked else "its wheels slip"
        pose, begin = drive.pose, self._begin
        self.problem = (
            f"'{action}' ended after {begin.distance_m(pose):.2f} m and "
            f"{math.degrees(abs(self._turned_rad)):.0f} degrees at ({pose.x_m:.2f}, {pose.y_m:.2f}): {reason}"
        )

    def _towards(self, left_m: float, left_rad: float, dt_s: float) -> Velocity:
        limits = self._drive.limits
        speed = approach_speed(abs(left_m), limits.speed_m_s, limits.acceleration_m_s2, dt_s)
        turn = approach_speed(abs(left_rad), limits.turn_rad_s, limits.turn_acceleration_rad_s2, dt_s)
        # An action asks for one of the two; what is left of the other is rounding.
        drives = self._action is not None and self._action.forward_m != 0.0
        return Velocity(
            linear_m_s=math.copysign(speed, left_m) if drives else 0.0,
            angular_rad_s=0.0 if drives else math.copysign(turn, left_rad),
        )
