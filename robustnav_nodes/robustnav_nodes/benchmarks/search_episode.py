"""One search in a scene, from the start pose to the end, and what became of it."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Float64
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.benchmarks.recorded_belief import RecordedBelief
from robustnav_nodes.benchmarks.search_scene import SearchScene, SearchTarget
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.search import Search
from robustnav_nodes.search_space.pose_graph import PoseGraph


class Outcome(StrEnum):
    """How an episode ended. The three errors are those of the thesis' fig. 3.7."""

    SUCCESS = "success"
    LOCALISATION_ERROR = "localisation_error"  # ended where the target is not in view
    DOCKING_ERROR = "docking_error"  # found, but stopped at another pose than one that counts
    OTHER_ERROR = "other_error"  # not found in time


@dataclass(frozen=True, slots=True, kw_only=True)
class EpisodeResult:
    """steps: actions taken; shortest: fewest actions from the start to a pose that counts (at least 1);
    is_wrong_stop: whether it stopped where the target is not in view; decision_ms: time of each decision.
    """

    outcome: Outcome
    steps: int
    shortest: int
    is_wrong_stop: bool
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
    *,
    prior: Float64 | None = None,
    open_graph: PoseGraph | None = None,
) -> EpisodeResult:
    """Search for `target` from pose `start`; each look is added to `moments`, if given.

    prior: weights of the candidates, float64 [k]; open_graph: the scene's graph without the ways that prove
    blocked when the robot tries them, each of which costs it a step; None: all ways are open.

    With docking (`planner.dock`) it succeeds at a destination pose of the target, without where the target
    is in view. The detector's word is taken once for each pose.
    """
    space = scene.space
    open_graph = space.graph if open_graph is None else open_graph
    belief = RecordedBelief(space, target.detections[detector], belief_parameters, prior)
    search = Search(space=space, parameters=planner, rng=rng, prior=belief.probability)
    counts = target.destination if planner.dock and target.destination is not None else target.in_view
    shortest = max(1, int(open_graph.steps_from(start)[counts].min()))
    pose, decision_ms, was_in_view, is_docking = start, [], False, False
    while True:
        in_view = space.observability.row(pose)
        belief.look(pose)
        if moments is not None:
            moments.append(BeliefMoment(pose=pose, probability=belief.probability))
        step = search.look(pose, in_view, belief.probability)
        begins = step.location is not None and (step.begins_docking or not is_docking)
        if begins:  # the find that counts is the last one
            was_in_view = bool(target.in_view[pose])
        is_docking = step.location is not None
        if step.choice is not None:
            decision_ms.append(step.elapsed_ms)
        if not step.path:
            break
        if step.path[1] in open_graph.successors[pose]:
            pose = step.path[1]
        else:
            search.close_way()

    was_found = step.phase is SearchPhase.FOUND
    outcome = Outcome.OTHER_ERROR
    if was_found:
        if counts[pose]:
            outcome = Outcome.SUCCESS
        else:
            outcome = Outcome.DOCKING_ERROR if was_in_view else Outcome.LOCALISATION_ERROR
    return EpisodeResult(
        outcome=outcome,
        steps=search.steps,
        shortest=shortest,
        is_wrong_stop=was_found and not target.in_view[pose],
        decision_ms=tuple(decision_ms),
    )
