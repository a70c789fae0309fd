"""Several targets in one scene: looked for at once, or one after another."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.records import SearchPhase
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.benchmarks.recorded_belief import RecordedBelief
from robustnav_nodes.benchmarks.search_scene import SearchScene, SearchTarget
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.search import Search
from robustnav_nodes.planner.several_targets import SeveralTargets


@dataclass(frozen=True, slots=True, kw_only=True)
class TourResult:
    """steps: taken in all; found: for each target whether it was in view where it was said to be found."""

    steps: int
    found: tuple[bool, ...]


def run_at_once(
    scene: SearchScene,
    targets: Sequence[SearchTarget],
    detector: str,
    start: int,
    planner: PlannerParameters,
    belief_parameters: BeliefParameters,
    rng: np.random.Generator,
) -> TourResult:
    """One search for all `targets`, of at most `planner.max_steps` steps in all."""
    space = scene.space
    beliefs = [RecordedBelief(space, target.detections[detector], belief_parameters) for target in targets]
    search = SeveralTargets(space=space, parameters=planner, targets=len(targets), rng=rng)
    pose, found = start, [False] * len(targets)
    while True:
        for belief in beliefs:
            belief.look(pose)
        sought = search.remaining
        probability = np.stack([belief.probability for belief in beliefs])
        step = search.look(pose, space.observability.row(pose), probability)
        for number in set(sought) - set(search.remaining):
            found[number] = bool(targets[number].in_view[pose])
        if not step.path:
            return TourResult(steps=search.steps, found=tuple(found))
        pose = step.path[1]


def run_one_after_another(
    scene: SearchScene,
    targets: Sequence[SearchTarget],
    detector: str,
    start: int,
    planner: PlannerParameters,
    belief_parameters: BeliefParameters,
    rng: np.random.Generator,
) -> TourResult:
    """A search for each of `targets` in turn, from where the one before ended, which told it nothing."""
    space, pose, steps, found = scene.space, start, 0, []
    for target in targets:
        belief = RecordedBelief(space, target.detections[detector], belief_parameters)
        search = Search(space=space, parameters=planner, rng=rng)
        while True:
            belief.look(pose)
            step = search.look(pose, space.observability.row(pose), belief.probability)
            if not step.path:
                break
            pose = step.path[1]
        found.append(step.phase is SearchPhase.FOUND and bool(target.in_view[pose]))
        steps += search.steps
    return TourResult(steps=steps, found=tuple(found))
