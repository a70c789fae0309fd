"""Which observations count: one per pose, and only while the robot stands."""

from enum import StrEnum

from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.belief.parameters import BeliefParameters


class Verdict(StrEnum):
    """What became of an observation."""

    COUNTED = "counted"
    MOVING = "moving"
    SEEN_BEFORE = "seen before"


class ViewGate:
    """Admits the first observation from each pose of a search, whatever it says.

    A detector's errors belong to the view: what it missed or imagined from here it misses or imagines again
    in the next image, so a second look from the same pose would count one piece of evidence twice. The first
    verdict stands even where a later image from there says otherwise. While the robot moves, images are
    blurred and their pose is uncertain, so they do not count either.

    Owned by one tracker, used from its thread.
    """

    def __init__(self, parameters: BeliefParameters) -> None:
        self._parameters = parameters
        self._counted: list[Pose2D] = []

    def judge(self, pose: Pose2D, linear_m_s: float, angular_rad_s: float) -> Verdict:
        """Whether an observation from `pose` at this speed counts; one that does is remembered."""
        limits = self._parameters
        if abs(linear_m_s) > limits.max_speed_m_s or abs(angular_rad_s) > limits.max_turn_rad_s:
            return Verdict.MOVING
        if any(self._same_view(pose, earlier) for earlier in self._counted):
            return Verdict.SEEN_BEFORE
        self._counted.append(pose)
        return Verdict.COUNTED

    def _same_view(self, pose: Pose2D, earlier: Pose2D) -> bool:
        near = pose.distance_m(earlier) < self._parameters.min_translation_m
        return near and abs(pose.turn_rad(earlier)) < self._parameters.min_rotation_rad
