"""Where POMCP imagines the target: the particles of each decision, in the thesis' two ways and in ours."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.planner.pomcp import Plan
from robustnav_nodes.search_space.candidates import Candidates

Particles = NDArray[np.int64]


class ParticleSource(Protocol):
    """Gives the particles (int64 [count], candidates) of a decision; told of each view and each decision."""

    def looked(self, in_view: Bool, rose: Bool, probability: Float64) -> None:
        """A view counted. bool [k]: what was in view, whose probability rose; float64 [k]: R after it."""

    def draw(self, count: int, rng: np.random.Generator) -> Particles:
        """Particles for one decision."""

    def decided(self, plan: Plan, particles: Particles) -> None:
        """`plan` was made with `particles` and its action will be taken."""


class CandidatesNotRuledOut:
    """BE: particles uniformly from pp, the candidates not yet ruled out (thesis 3.2.1.3).

    A candidate leaves pp when it was in view and its probability did not rise: the detector was silent about
    it (C6: the released code drops whatever was in view, detected or not). One in view whose probability
    rose is in pp, again if need be. The belief's probabilities say so; the planner needs no detections.

    C7: particles come from pp itself; the text's "H without pp" is a slip. C8: where pp runs empty, every
    candidate that can be seen is in pp again, and from then on particles follow the belief R within pp, as a
    second tour should begin where the first one most likely missed the target.
    """

    def __init__(self, can_be_seen: Bool) -> None:
        self._can_be_seen = can_be_seen
        self._probability: Float64 = np.full(len(can_be_seen), 1.0 / len(can_be_seen))
        self.not_ruled_out: Bool = can_be_seen.copy()
        self.tours = 1

    def looked(self, in_view: Bool, rose: Bool, probability: Float64) -> None:
        """See ParticleSource."""
        self._probability = probability
        self.not_ruled_out = (self.not_ruled_out & ~in_view) | (in_view & rose)
        if not self.not_ruled_out.any():
            self.not_ruled_out = self._can_be_seen.copy()
            self.tours += 1

    def draw(self, count: int, rng: np.random.Generator) -> Particles:
        """See ParticleSource."""
        members = np.nonzero(self.not_ruled_out)[0]
        if self.tours == 1:
            return members[rng.integers(len(members), size=count)]
        return _drawn(members, self._probability, count, rng)

    def decided(self, plan: Plan, particles: Particles) -> None:
        """See ParticleSource; this source does not depend on the plan."""


class BelievedCandidates:
    """Beyond the thesis: particles follow the belief R itself, over all candidates that can be seen.

    pp forgets in one look what R only doubts: a candidate that the detector missed is gone from pp for the
    rest of the tour. R keeps it in proportion to the chance of a miss.
    """

    def __init__(self, can_be_seen: Bool) -> None:
        self._can_be_seen = can_be_seen
        self._probability: Float64 = np.full(len(can_be_seen), 1.0 / len(can_be_seen))

    def looked(self, in_view: Bool, rose: Bool, probability: Float64) -> None:
        """See ParticleSource."""
        self._probability = probability

    def draw(self, count: int, rng: np.random.Generator) -> Particles:
        """See ParticleSource."""
        return _drawn(np.nonzero(self._can_be_seen)[0], self._probability, count, rng)

    def decided(self, plan: Plan, particles: Particles) -> None:
        """See ParticleSource; this source does not depend on the plan."""


class ParticleFilter:
    """The plain POMCP update (POMP): particles that survive a step, topped up near the survivors.

    A particle survives where its simulation began with the action that is taken and the target, had it been
    there, was not seen. Missing ones are copies of survivors moved to a candidate within `radius_m` that is
    not in view now; with no survivors, any candidate not in view; with all in view, any candidate.
    """

    def __init__(self, candidates: Candidates, radius_m: float) -> None:
        self._candidates = candidates
        self._radius_m = radius_m
        self._survivors: Particles | None = None
        self._hidden = np.ones(len(candidates), dtype=np.bool_)

    def looked(self, in_view: Bool, rose: Bool, probability: Float64) -> None:
        """See ParticleSource."""
        self._hidden = ~in_view

    def draw(self, count: int, rng: np.random.Generator) -> Particles:
        """See ParticleSource."""
        anywhere = np.nonzero(self._hidden)[0]
        if len(anywhere) == 0:
            anywhere = np.arange(len(self._hidden))
        if self._survivors is None:
            return anywhere[rng.integers(len(anywhere), size=count)]
        survivors = self._survivors[self._hidden[self._survivors]]
        if len(survivors) == 0:
            return anywhere[rng.integers(len(anywhere), size=count)]
        missing = max(0, count - len(survivors))
        parents = survivors[rng.integers(len(survivors), size=missing)]
        return np.concatenate([survivors[:count], self._moved(parents, rng)])

    def decided(self, plan: Plan, particles: Particles) -> None:
        """See ParticleSource."""
        simulated = particles[np.arange(plan.simulations) % len(particles)]
        self._survivors = simulated[(plan.first_action == plan.action) & (plan.first_observation == 0)]

    def _moved(self, parents: Particles, rng: np.random.Generator) -> Particles:
        """Each parent moved to a random neighbour that is not in view, itself included."""
        moved = np.empty_like(parents)
        x_m, y_m = self._candidates.x_m, self._candidates.y_m
        for parent in np.unique(parents):
            near = np.hypot(x_m - x_m[parent], y_m - y_m[parent]) <= self._radius_m
            choice = np.nonzero(near & self._hidden)[0]
            mine = parents == parent
            moved[mine] = choice[rng.integers(len(choice), size=int(mine.sum()))]
        return moved


def _drawn(members: Particles, probability: Float64, count: int, rng: np.random.Generator) -> Particles:
    """`count` of `members` by their probability (float64 [k]); all alike where a belief gives them none."""
    weight = probability[members]
    total = weight.sum()
    return rng.choice(members, size=count, p=weight / total if total > 0.0 else None)
