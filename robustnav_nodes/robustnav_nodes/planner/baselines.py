"""Simple rules to compare planners with: at random, greedily by count, greedily by belief."""

import numpy as np

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.planner.policy import Choice, Sight, Situation, choose
from robustnav_nodes.planner.viewpoints import (
    NONE,
    Reach,
    best_viewpoint,
    empty_reach,
    outlook_on,
    place_of,
    way_to,
)
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.space import SearchSpace


class RandomWalk:
    """Any legal action, all alike; a Policy."""

    def looked(self, sight: Sight) -> None:
        """See Policy; nothing is remembered."""

    def decide(self, situation: Situation, rng: np.random.Generator) -> Choice | None:
        """See Policy."""
        legal = situation.graph.legal_actions(situation.pose)
        return choose(int(legal[rng.integers(len(legal))]), "at random")


class Greedy:
    """Towards the pose with the most unseen candidates in view per step of the way there; a Policy.

    Decided anew at each step. Where nothing unseen is left to go to, everything counts as unseen again.
    """

    def __init__(self, space: SearchSpace) -> None:
        self._observability = space.observability
        self._reach = empty_reach(len(space.graph))
        self._can_be_seen = space.observability.seen_from_somewhere()
        self._unseen: Bool = self._can_be_seen.copy()
        self._been: Bool = np.zeros(len(space.graph), dtype=np.bool_)

    def looked(self, sight: Sight) -> None:
        """See Policy; a candidate where the detector fired is worth a look from elsewhere."""
        self._been[sight.pose] = True
        self._unseen = (self._unseen & ~sight.in_view) | (sight.in_view & sight.rose)

    def decide(self, situation: Situation, rng: np.random.Generator) -> Choice | None:
        """See Policy."""
        self.looked(situation.sight)  # also where it has been before: there is nothing more to see there
        choice = self._towards_unseen(situation)
        if choice is None:  # what is left is seen from where it has been alone, or from nowhere in reach
            self._begin_again()
            choice = self._towards_unseen(situation)
        return choice

    def _begin_again(self) -> None:
        self._unseen = self._can_be_seen.copy()
        self._been[:] = False

    def _towards_unseen(self, situation: Situation) -> Choice | None:
        mass = self._unseen.astype(np.float64)
        return _towards_best(situation, self._observability, self._reach, mass, self._been.copy())


class GreedyGain:
    """Towards the pose with the most belief in view per step, of those not looked from yet; a Policy."""

    def __init__(self, space: SearchSpace) -> None:
        self._observability = space.observability
        self._reach = empty_reach(len(space.graph))

    def looked(self, sight: Sight) -> None:
        """See Policy; nothing is remembered: it looked from wherever it has been, also to no effect."""

    def decide(self, situation: Situation, rng: np.random.Generator) -> Choice | None:
        """See Policy; None where every pose has been looked from."""
        mass = situation.sight.probability.copy()
        return _towards_best(situation, self._observability, self._reach, mass, situation.visited.copy())


def _towards_best(
    situation: Situation, observability: Observability, reach: Reach, mass: Float64, looked: Bool
) -> Choice | None:
    place = place_of(situation.graph, observability)
    outlook = outlook_on(place, mass, looked)
    goal = best_viewpoint(place, outlook, reach, situation.pose, float(outlook.gain.max()))
    if goal == NONE:
        return None
    way = way_to(reach, goal)
    action = int(np.argmax(situation.graph.successors[situation.pose] == way[0]))
    return choose(action, f"towards a pose {len(way)} steps away")
