"""What the robot knows where it stands: its pose on the graph, the belief, and what is in view."""

from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import BeliefCloud, Bool, Float64, Pose2D
from robustnav_nodes.planner.exit_condition import most_likely_in_view
from robustnav_nodes.search_space.pose_graph import PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

# A probability that grew by less did not grow: a silent view lifts those at the belief's floor by up to that
# floor, relatively, when it makes the sum one again.
_ROSE = 1.001


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Look:
    """One look at the place.

    pose: the robot's pose on the graph; probability: R, float64 [k]; in_view: bool [k]; rose: bool [k], the
    candidates in view whose probability grew since the look before, so that the detector fired there;
    is_new: whether the belief changed at all, that is, whether the view counted; best_in_view: the most
    likely candidate in view and its probability.
    """

    pose: int
    probability: Float64
    in_view: Bool
    rose: Bool
    is_new: bool
    best_in_view: tuple[int, float] | None

    @property
    def best(self) -> int:
        """The most likely candidate anywhere."""
        return int(np.argmax(self.probability))

    def normalised_entropy(self) -> float:
        """Entropy of the belief over its maximum log k, in 0..1; a probability of 0 adds nothing."""
        positive = self.probability[self.probability > 0.0]
        entropy = -float(np.sum(positive * np.log(positive)))
        return min(1.0, max(0.0, entropy / float(np.log(max(2, len(self.probability))))))


def look_around(
    space: SearchSpace, graph: PoseGraph, robot: Pose2D, cloud: BeliefCloud, before: Float64
) -> Look:
    """What a robot at `robot` knows by the belief `cloud`, if it was `before` (float64 [k]) at the last look.

    Raises BadMessageError where `cloud` is not about the candidates of `space`.
    """
    _check(space, cloud)
    in_view = space.visible(robot)
    return Look(
        pose=graph.nearest(robot),
        probability=cloud.probability,
        in_view=in_view,
        rose=in_view & (cloud.probability > before * _ROSE),
        is_new=not np.array_equal(cloud.probability, before),
        best_in_view=most_likely_in_view(cloud.probability, in_view),
    )


def _check(space: SearchSpace, cloud: BeliefCloud) -> None:
    frame_id, position_m = space.frame_id, space.candidates.position_m
    if cloud.frame_id != frame_id:
        raise BadMessageError(
            f"the belief is in frame {cloud.frame_id!r}, the planner's map in {frame_id!r}: "
            "both nodes must hear the same map"
        )
    if cloud.position_m.shape != position_m.shape:
        raise BadMessageError(
            f"the belief is about {len(cloud.probability)} candidate locations, the planner's map has "
            f"{len(position_m)}: both nodes must hear the same map and mask and have the same parameters"
        )
    off_m = float(np.max(np.abs(cloud.position_m - position_m)))
    if off_m > 0.5 * space.candidates.size_m:
        raise BadMessageError(
            f"the belief's candidate locations lie up to {off_m:.2f} m from the planner's: "
            "both nodes must hear the same map and mask and have the same parameters"
        )
