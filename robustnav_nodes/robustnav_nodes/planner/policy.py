"""What a planner is: something that is told of every look and decides on the next action."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.search_space.pose_graph import Action, PoseGraph


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sight:
    """One look from a pose of the graph, and the belief that takes it into account.

    probability: R, float64 [k]; in_view: bool [k]; rose: bool [k], the candidates in view whose probability
    grew since the look before, so that the detector fired there; is_new: whether this is the first look from
    the pose, or the belief changed.
    """

    pose: int
    probability: Float64
    in_view: Bool
    rose: Bool
    is_new: bool

    @property
    def best(self) -> int:
        """The most likely candidate anywhere."""
        return int(np.argmax(self.probability))

    def normalised_entropy(self) -> float:
        """Entropy of the belief over its maximum log k, in 0..1; a probability of 0 adds nothing."""
        positive = self.probability[self.probability > 0.0]
        entropy = -float(np.sum(positive * np.log(positive)))
        return min(1.0, max(0.0, entropy / float(np.log(max(2, len(self.probability))))))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Situation:
    """Where a decision is made.

    graph: the poses and the ways that are open; visited: bool [n], where the robot has been, here included;
    step: how many actions were taken so far; start: the pose where the search began.
    """

    graph: PoseGraph
    sight: Sight
    visited: Bool
    step: int
    start: int

    @property
    def pose(self) -> int:
        """The robot's pose on the graph."""
        return self.sight.pose


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Choice:
    """A decision and how every action looked; actions by their numbers.

    values: float64 [4], NaN for an action that was not tried; visits: int [4], simulations that began with
    it; reason: in words.
    """

    action: int
    values: Float64
    visits: NDArray[np.int32]
    simulations: int
    reason: str


class Policy(Protocol):
    """Decides where to look next. Owned by one search, used from one thread."""

    def looked(self, sight: Sight) -> None:
        """A look counted."""

    def decide(self, situation: Situation, rng: np.random.Generator) -> Choice | None:
        """The next action, one that `graph` allows; None where there is nothing left to look at."""


def choose(action: int, reason: str) -> Choice:
    """A choice that weighed nothing."""
    return Choice(
        action=action,
        values=np.full(len(Action), np.nan),
        visits=np.zeros(len(Action), dtype=np.int32),
        simulations=0,
        reason=reason,
    )
