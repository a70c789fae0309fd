"""Where the robot was when an image was taken."""

import math
from bisect import bisect_left
from collections import deque
from dataclasses import replace

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import Odometry, Pose2D

KEEP_NS = 10_000_000_000
# How far outside the recorded span a stamp may lie: images and odometry do not come in order of their stamps.
REACH_NS = 250_000_000
# What is older than the newest by more than this did not come late: time began anew.
LATE_NS = 1_000_000_000


def check_frame(odometry: Odometry, map_frame: str) -> None:
    """Raises BadMessageError where `odometry` is not in the map's frame: it would drift away from it."""
    if odometry.frame_id != map_frame:
        raise BadMessageError(
            f"odom is in frame {odometry.frame_id!r}, the map in {map_frame!r}; it is taken as the pose in "
            "the map all the same: remap odom to what the localisation says, or it will drift away"
        )


class PoseHistory:
    """The last ten seconds of odometry. Owned by a node, used in its executor thread only."""

    def __init__(self) -> None:
        self._past: deque[Odometry] = deque()

    @property
    def latest(self) -> Odometry | None:
        """The newest odometry, None before the first."""
        return self._past[-1] if self._past else None

    def add(self, odometry: Odometry) -> bool:
        """Remember; returns True when time began anew (the simulation was reset), which forgets the past.

        Odometry that comes late (older than the newest, by less than a second) is dropped.
        """
        restarted = False
        if self._past and odometry.stamp_ns <= self._past[-1].stamp_ns:
            if odometry.stamp_ns > self._past[-1].stamp_ns - LATE_NS:
                return False
            self._past.clear()
            restarted = True
        self._past.append(odometry)
        while self._past[0].stamp_ns < odometry.stamp_ns - KEEP_NS:
            self._past.popleft()
        return restarted

    def at(self, stamp_ns: int) -> Odometry | None:
        """The odometry at `stamp_ns`, interpolated; None where nothing near was heard."""
        if not self._past:
            return None
        first, last = self._past[0], self._past[-1]
        if not first.stamp_ns - REACH_NS <= stamp_ns <= last.stamp_ns + REACH_NS:
            return None
        if stamp_ns >= last.stamp_ns:
            return last
        if stamp_ns <= first.stamp_ns:
            return first
        index = bisect_left(self._past, stamp_ns, key=lambda odometry: odometry.stamp_ns)
        before, after = self._past[index - 1], self._past[index]
        part = (stamp_ns - before.stamp_ns) / (after.stamp_ns - before.stamp_ns)
        pose = Pose2D(
            x_m=before.pose.x_m + part * (after.pose.x_m - before.pose.x_m),
            y_m=before.pose.y_m + part * (after.pose.y_m - before.pose.y_m),
            yaw_rad=math.remainder(before.pose.yaw_rad + part * before.pose.turn_rad(after.pose), math.tau),
        )
        return replace(after, pose=pose, stamp_ns=stamp_ns)
