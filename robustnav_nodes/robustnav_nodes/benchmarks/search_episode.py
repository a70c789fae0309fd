"""One search in a scene, from the start pose to the end, and what became of it."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.belief.evidence import evidence_of
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.benchmarks.search_scene import SearchScene, SearchTarget
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.search import Search


class Outcome(StrEnum):
    """How an episode ended. The three errors are those of the thesis' fig. 3.7."""

    SUCCESS = "success"
    LOCALISATION_ERROR = "localisation_error"  # ended where the target is not in view
    DOCKING_ERROR = "docking_error"  # found, but stopped at another pose than one that counts
    OTHER_ERROR = "other_error"  # not found in time


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeResult:
    """steps: actions taken; shortest: fewest actions from the start to a pose that counts (at least 1);
    decision_ms: time of each decision.
    """

    outcome: Outcome
    steps: int
    shortest: int
    decision_ms: tuple[float, ...]

    @property
    def is_success(self) -> bool:
        """Whether it stopped where it should."""
        return self.outcome is Outcome.SUCCESS

    @property
    def spl(self) -> float:
        """Success weighted by path length, of this episode (thesis eq. 3.3)."""
        return self.shortest / max(self.steps, self.shortest) if self.is_success else 0.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BeliefMoment:
    """The belief (float64 [k]) after a look at `pose`, for a picture of an episode."""

    pose: int
    probability: Float64


def run_episode(
    scene: SearchScene,
    target: SearchTarget,
    detector: str,
    start: int,
    planner: PlannerParameters,
    belief_parameters: BeliefParameters,
    rng: np.random.Generator,
    moments: list[BeliefMoment] | None = None,
) -> EpisodeResult:
    """Search for `target` from pose `start`; each look is added to `moments`, if given.

    With docking (`planner.dock`) it succeeds at a destination pose of the target, without where the target
    is in view. The detector's word is taken once for each pose.
    """
    space, record = scene.space, target.detections[detector]
    evidence = evidence_of(record.statistics, space.observability.share_in_view(), belief_parameters)
    belief = LocationBelief.uniform(space.candidates)
    search = Search(space=space, parameters=planner, rng=rng)
    looked: Bool = np.zeros(len(space.graph), dtype=np.bool_)
    counts = target.destination if planner.dock and target.destination is not None else target.in_view
    shortest = max(1, int(space.graph.steps_from(start)[counts].min()))
    pose, decision_ms, was_found = start, [], False
    while True:
        in_view = space.observability.row(pose)
        if not looked[pose]:
            looked[pose] = True
            densities = record.at(pose, space.observability.candidates)
            belief = belief.updated(evidence.factor(in_view, densities), belief_parameters.probability_floor)
        if moments is not None:
            moments.append(BeliefMoment(pose=pose, probability=belief.probability))
        step = search.look(pose, in_view, belief.probability)
        was_found |= step.location is not None and bool(target.in_view[pose])
        if step.choice is not None:
            decision_ms.append(step.choice.elapsed_ms)
        if not step.path:
            break
        pose = step.path[1]

    outcome = Outcome.OTHER_ERROR
    if step.phase is SearchPhase.FOUND:
        if counts[pose]:
            outcome = Outcome.SUCCESS
        else:
            outcome = Outcome.DOCKING_ERROR if was_found else Outcome.LOCALISATION_ERROR
    return EpisodeResult(
        outcome=outcome, steps=search.steps, shortest=shortest, decision_ms=tuple(decision_ms)
    )
