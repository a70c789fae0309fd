"""What each look says about one target, and whether it is found."""

import numpy as np

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.planner.ending import ending_of
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.policy import Sight
from robustnav_nodes.search_space.candidates import Candidates

# Odds that grew by less did not grow: a silent view lifts those at the belief's floor by up to that
# floor, relatively, when it makes the sum one again.
_ROSE = 1.001


class Watch:
    """Follows the belief about one target over `candidates` from look to look.

    prior: R before the first look, float64 [k]; None: uniform. What is above it after that look has risen.
    """

    def __init__(
        self, candidates: Candidates, parameters: PlannerParameters, prior: Float64 | None = None
    ) -> None:
        self.ending = ending_of(parameters, candidates)
        self._probability: Float64 | None = (
            np.full(len(candidates), 1.0 / len(candidates)) if prior is None else prior
        )
        self._poses: set[int] = set()

    def move_to(self, candidates: Candidates, parameters: PlannerParameters) -> None:
        """Go on with the `candidates` of a map that has grown or changed.

        The next look only says where the belief stands; what had risen must rise once more.
        """
        self.ending = ending_of(parameters, candidates)
        self._probability = None
        self._poses.clear()

    def look(self, pose: int, in_view: Bool, probability: Float64) -> Sight:
        """Take in R (float64 [k]) after a look from `pose` (in_view: bool [k])."""
        before = self._probability if self._probability is not None else probability
        is_first = pose not in self._poses
        self._poses.add(pose)
        sight = Sight(
            pose=pose,
            probability=probability,
            in_view=in_view,
            rose=in_view & (probability * (1.0 - before) > before * (1.0 - probability) * _ROSE),
            is_new=is_first or not np.array_equal(probability, before),
        )
        self._probability = probability
        self.ending.looked(sight)
        return sight
