"""Several targets in one search: each is found where it is, and none costs a way of its own."""

import numpy as np
import pytest

from robustnav_msgs_py.records import SearchPhase
from robustnav_nodes.belief.evidence import LikelihoodEvidence
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.planner.search import Search
from robustnav_nodes.planner.several_targets import SeveralTargets

PERFECT = LikelihoodEvidence(recall=0.99, false_alarms=1e-3)


class Eyes:
    """Beliefs about `targets` (candidates), from a detector that is always right."""

    def __init__(self, space, targets):
        self.space, self.targets = space, targets
        self.beliefs = [LocationBelief.uniform(space.candidates) for _ in targets]
        self.looked = set()

    def look(self, pose) -> np.ndarray:
        in_view = self.space.observability.row(pose)
        for number, target in enumerate(self.targets if pose not in self.looked else ()):
            fired = np.eye(len(in_view))[[target]] if in_view[target] else np.zeros((0, len(in_view)))
            factor = PERFECT.factor(in_view, fired)
            self.beliefs[number] = self.beliefs[number].updated(factor, 1e-6)
        self.looked.add(pose)
        return np.stack([belief.probability for belief in self.beliefs])


def at_once(space, parameters, targets, pose, closed=frozenset()) -> tuple[SeveralTargets, list]:
    """The search when it has ended, and all its steps; `closed`: ways (from, to) that prove blocked."""
    eyes = Eyes(space, targets)
    rng = np.random.default_rng(0)
    search = SeveralTargets(space=space, parameters=parameters, targets=len(targets), rng=rng)
    steps = [search.look(pose, space.observability.row(pose), eyes.look(pose))]
    while steps[-1].path:
        if (pose, steps[-1].path[1]) in closed:
            search.close_way()
        else:
            pose = steps[-1].path[1]
        steps.append(search.look(pose, space.observability.row(pose), eyes.look(pose)))
    return search, steps


def one_after_another(space, parameters, targets, pose) -> int:
    """Steps in all."""
    steps = 0
    for target in targets:
        eyes = Eyes(space, [target])
        search = Search(space=space, parameters=parameters, rng=np.random.default_rng(0))
        step = search.look(pose, space.observability.row(pose), eyes.look(pose)[0])
        while step.path:
            pose = step.path[1]
            step = search.look(pose, space.observability.row(pose), eyes.look(pose)[0])
        assert step.phase is SearchPhase.FOUND
        steps += search.steps
    return steps


def drawn(space, seed: int, count: int) -> tuple[list[int], int]:
    """Targets that can be seen, and a start."""
    rng = np.random.default_rng(seed)
    seen = np.nonzero(space.observability.seen_from_somewhere())[0]
    return rng.choice(seen, size=count, replace=False).tolist(), int(rng.integers(len(space.graph)))


@pytest.mark.parametrize("variant", ["lookahead", "greedy_gain", "greedy", "pomp_belief", "pomp_be_pd"])
@pytest.mark.parametrize("seed", range(3))
def test_every_policy_finds_all_of_them_where_they_are(home, parameters_with, variant, seed):
    parameters = parameters_with(variant=variant, ending="view", dock=False, simulations=128, max_steps=400)
    targets, start = drawn(home, seed, 3)
    search, steps = at_once(home, parameters, targets, start)
    assert steps[-1].phase is SearchPhase.FOUND
    assert search.found == targets
    assert search.remaining == []
    assert search.steps == len(steps) - 1


def test_it_takes_fewer_steps_than_one_search_after_another(home, parameters_with):
    parameters = parameters_with(dock=False, max_steps=400, goals=6, lookahead_steps=30)
    taken = []
    for seed in range(8):
        targets, start = drawn(home, seed, 3)
        search, _ = at_once(home, parameters, targets, start)
        taken.append((search.steps, one_after_another(home, parameters, targets, start)))
    together, apart = np.mean(taken, axis=0)
    assert together < 0.8 * apart


def test_of_one_target_it_is_a_search(home, parameters_with):
    """Step by step the same, with docking and without."""
    for seed in range(4):
        for dock in (False, True):
            parameters = parameters_with(dock=dock, goals=6, lookahead_steps=30)
            targets, start = drawn(home, seed, 1)
            search, steps = at_once(home, parameters, targets, start)
            assert steps[-1].phase is SearchPhase.FOUND
            assert search.steps == one_after_another(home, parameters, targets, start)


def test_two_in_one_view_are_found_with_one_look(by_hand, parameters_with):
    space = by_hand.corridor([], [0, 1], [2], [3])
    search, steps = at_once(space, parameters_with(dock=False), [0, 1], 0)
    assert (search.found, search.steps, steps[-1].phase) == ([0, 1], 1, SearchPhase.FOUND)


def test_with_docking_it_goes_up_to_each(home, parameters_with):
    """Both are in view from the start of the docking on; the way leads to a docking pose of each in turn."""
    targets, start = drawn(home, 1, 2)
    search, steps = at_once(home, parameters_with(dock=True), targets, start)
    assert search.found == targets
    assert sum(step.begins_docking for step in steps) >= 2
    docked = {step.location for step in steps if step.phase is SearchPhase.DOCKING}
    assert docked == set(targets)


def test_what_is_not_found_in_time_is_said(by_hand, parameters_with):
    """One is at hand, the other far away, and there are three steps."""
    space = by_hand.corridor([0], [], [], [], [], [], [1], candidates=3)
    search, steps = at_once(space, parameters_with(dock=False, max_steps=3), [0, 1], 1)
    assert steps[-1].phase is SearchPhase.NOT_FOUND
    assert search.found == [0, None]
    assert search.remaining == [1]


def test_what_is_found_is_looked_for_no_more(by_hand, parameters_with):
    """The first is found at the start; then nothing draws the robot back there."""
    space = by_hand.corridor([0, 1], [], [], [2, 3], [], [4])
    _, steps = at_once(space, parameters_with(dock=False), [0, 4], 0)
    assert [step.sight.pose for step in steps] == [0, 1, 2, 3, 4, 5]
    after = steps[1].sight.probability
    assert after[0] < 0.1 * after[4]


def test_a_blocked_way_is_gone_around(by_hand, parameters_with):
    """The short way to the second target proves closed."""
    ways = [[1, 3, -1, -1], [2, 0, -1, -1], [-1, 1, 4, -1], [4, 0, -1, -1], [2, 3, -1, -1]]
    space = by_hand.table(ways, [[0], [], [1], [], []], 3)
    search, steps = at_once(space, parameters_with(dock=False), [0, 1], 0, closed={(1, 2)})
    assert search.found == [0, 1]
    assert [step.sight.pose for step in steps].count(1) == 2
