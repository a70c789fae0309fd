"""Drives the robot to a goal pose: brake, plan, then turn and drive from corner to corner, and turn at last.

Where it ends is the goal itself, not a hair beside it, so that the poses of a planner's lattice are exact.
Short moves to what lies behind are driven backwards, as a planner on a lattice of poses expects it.
"""

import math
from enum import StrEnum
from itertools import pairwise

from robustnav_msgs_py.errors import RobustnavError
from robustnav_msgs_py.values import Pose2D, Velocity
from sim_bridge.robot.approach import Progress, approach_speed
from sim_bridge.robot.drive import STANDSTILL, Drive, describe
from sim_bridge.robot.route import NoWayError, Point, RoutePlanner

# Moves up to this length go backwards where that saves turning.
REVERSE_M = 0.60
ARRIVED_M = 0.02
TURNED_RAD = 0.003
REACHED_M = 0.001
# While driving, the heading is corrected as fast as this (1/s), until the corner is this near.
STEERING_PER_S = 2.0
STEER_UNTIL_M = 0.10
# A robot that has been stopped this long plans anew; after so many plans it gives up.
BLOCKED_S = 0.5
MAX_PLANS = 3


class GoalRefusedError(RobustnavError):
    """The robot does not go there; the sentence says why."""


class Phase(StrEnum):
    """What the follower is doing."""

    IDLE = "idle"
    BRAKING = "braking"
    TURNING = "turning"
    DRIVING = "driving"
    ALIGNING = "aligning"


class GoalFollower:
    """Follows one goal at a time. Owned by the simulation, stepped from its thread.

    `problem` is the sentence about why the last goal was given up, "" where it was not.
    """

    def __init__(self, drive: Drive, planner: RoutePlanner) -> None:
        self.phase = Phase.IDLE
        self.goal: Pose2D | None = None
        self.problem = ""
        self._drive = drive
        self._planner = planner
        self._corners: list[Point] = []
        self._backwards = False
        self._blocked_s = 0.0
        self._plans = 0
        self._progress = Progress()

    @property
    def busy(self) -> bool:
        """Whether there is a goal to drive to."""
        return self.goal is not None

    def accept(self, goal: Pose2D) -> None:
        """Go to `goal` instead of whatever was followed.

        Raises GoalRefusedError, and goes on with what it did, where the robot does not fit there or no way
        leads there. The goal that is followed already is not begun anew.
        """
        if goal == self.goal:
            return
        self._require_way(goal)
        self.goal = goal
        self.problem = ""
        self._begin()

    def replan(self, planner: RoutePlanner) -> None:
        """Find ways with `planner` from now on; call it once the drive has its new obstacles.

        The robot goes on as it did where its way is still free. Else it brakes and takes another one, or it
        gives the goal up, and `problem` says why.
        """
        self._planner = planner
        if self.goal is None:
            return
        try:
            self._require_way(self.goal)
        except GoalRefusedError as problem:
            self._give_up(str(problem))
            return
        if self.phase is not Phase.ALIGNING and not self._is_way_free():
            self._begin()

    def cancel(self) -> None:
        """Forget the goal, and what was wrong with it."""
        self.goal = None
        self.phase = Phase.IDLE
        self.problem = ""

    def wanted(self, dt_s: float) -> Velocity:
        """The velocity to drive for the next `dt_s`; standstill when idle."""
        velocity = self._followed(dt_s)
        if self.goal is None:
            return STANDSTILL
        if self._progress.is_missing(self._drive.pose, dt_s):
            x_m, y_m = self._here()
            self._give_up(f"the robot wants to drive but stays at ({x_m:.2f}, {y_m:.2f}): its wheels slip")
            return STANDSTILL
        return velocity

    def _followed(self, dt_s: float) -> Velocity:
        """What the goal asks for; the phase may change, and the goal may be reached or given up."""
        if self.goal is None:
            return STANDSTILL
        if self.phase is Phase.BRAKING and self._drive.stands:
            self._plan(self.goal)
        if self.phase is Phase.TURNING:
            velocity = self._turn(self._course(), dt_s)
            if velocity is not None:
                return velocity
            self.phase = Phase.DRIVING
        if self.phase is Phase.DRIVING:
            velocity = self._advance(dt_s)
            if velocity is not None:
                return velocity
        if self.phase is Phase.ALIGNING and self.goal is not None:
            velocity = self._turn(self.goal.yaw_rad, dt_s)
            if velocity is not None:
                return velocity
            self._drive.settle(self.goal)
            self.cancel()
        return STANDSTILL

    def _here(self) -> Point:
        return self._drive.pose.x_m, self._drive.pose.y_m

    def _begin(self) -> None:
        """Brake, and plan once the robot stands."""
        self.phase = Phase.BRAKING
        self._plans = 0
        self._progress.restart()

    def _require_way(self, goal: Pose2D) -> None:
        """Raises GoalRefusedError where the robot cannot stand at the goal or cannot get there."""
        clearance_m = self._drive.obstacles.clearance_m(goal.x_m, goal.y_m)
        if clearance_m < self._drive.keep_m:
            raise GoalRefusedError(
                f"the robot cannot stand at ({goal.x_m:.2f}, {goal.y_m:.2f}): {describe(clearance_m)}, "
                f"it needs {self._drive.keep_m:.2f} m; choose a place on free floor"
            )
        try:
            self._planner.plan(self._here(), (goal.x_m, goal.y_m))
        except NoWayError as problem:
            raise GoalRefusedError(str(problem)) from problem

    def _is_way_free(self) -> bool:
        """Whether the corners ahead can still be driven to, one after the other."""
        way = [self._here(), *self._corners]
        drive = self._drive
        return len(way) > 1 and all(
            drive.obstacles.is_line_free(start, end, drive.keep_m) for start, end in pairwise(way)
        )

    def _plan(self, goal: Pose2D) -> None:
        self._plans += 1
        self._blocked_s = 0.0
        pose = self._drive.pose
        if pose.distance_m(goal) <= REACHED_M:
            self._corners = []
            self.phase = Phase.ALIGNING
            return
        try:
            self._corners = self._planner.plan(self._here(), (goal.x_m, goal.y_m))
        except NoWayError as problem:
            self._give_up(str(problem))
            return
        self._backwards = False
        if len(self._corners) == 1 and pose.distance_m(goal) <= REVERSE_M:
            ahead = math.atan2(goal.y_m - pose.y_m, goal.x_m - pose.x_m)
            turning = [
                abs(_difference(course, pose.yaw_rad)) + abs(_difference(goal.yaw_rad, course))
                for course in (ahead, ahead + math.pi)
            ]
            self._backwards = turning[1] < turning[0]
        self.phase = Phase.TURNING

    def _give_up(self, problem: str) -> None:
        self.cancel()
        self.problem = problem

    def _course(self) -> float:
        """The heading with which the next corner is driven to."""
        x_m, y_m = self._here()
        corner = self._corners[0]
        return math.atan2(corner[1] - y_m, corner[0] - x_m) + (math.pi if self._backwards else 0.0)

    def _turn(self, heading_rad: float, dt_s: float) -> Velocity | None:
        """The turn towards a heading; None once it is reached and the robot stands."""
        error_rad = _difference(heading_rad, self._drive.pose.yaw_rad)
        if abs(error_rad) < TURNED_RAD and self._drive.stands:
            return None
        limits = self._drive.limits
        speed = approach_speed(abs(error_rad), limits.turn_rad_s, limits.turn_acceleration_rad_s2, dt_s)
        return Velocity(linear_m_s=0.0, angular_rad_s=math.copysign(speed, error_rad))

    def _advance(self, dt_s: float) -> Velocity | None:
        """The drive towards the next corner; None once it is reached (the phase has changed then)."""
        corner = self._corners[0]
        distance_m = math.dist(self._here(), corner)
        course_error = _difference(self._course(), self._drive.pose.yaw_rad)
        # Along the robot's own axis; it turns negative once the corner lies behind.
        along_m = distance_m * math.cos(course_error)
        if along_m <= REACHED_M and self._drive.stands:
            self._corners.pop(0)
            self.phase = Phase.TURNING if self._corners else Phase.ALIGNING
            # The corner is passed: the turn towards the next one begins in the same step.
            return self._followed(dt_s)
        if self._is_stuck(dt_s):
            return self._after_block(distance_m, dt_s)
        limits = self._drive.limits
        speed = approach_speed(max(along_m, 0.0), limits.speed_m_s, limits.acceleration_m_s2, dt_s)
        steering = STEERING_PER_S * course_error if distance_m > STEER_UNTIL_M else 0.0
        return Velocity(linear_m_s=-speed if self._backwards else speed, angular_rad_s=steering)

    def _is_stuck(self, dt_s: float) -> bool:
        self._blocked_s = self._blocked_s + dt_s if self._drive.blocked else 0.0
        return self._blocked_s > BLOCKED_S

    def _after_block(self, distance_m: float, dt_s: float) -> Velocity:
        if distance_m <= ARRIVED_M and len(self._corners) == 1:
            self.phase = Phase.ALIGNING
        elif self._plans < MAX_PLANS:
            self.phase = Phase.BRAKING
        else:
            self._give_up(f"something is in the way {distance_m:.2f} m ahead; the robot has stopped there")
        return self._followed(dt_s)


def _difference(heading_rad: float, from_rad: float) -> float:
    """The smallest turn from one heading to the other."""
    return math.remainder(heading_rad - from_rad, math.tau)
