"""Ways that prove blocked: never so many that something cannot be reached, and each costs a step once."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest

from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.benchmarks.blocked_ways import with_blocked_ways
from robustnav_nodes.benchmarks.search_episode import BeliefMoment, Outcome, run_episode
from robustnav_nodes.benchmarks.search_scene import SearchScene
from robustnav_nodes.benchmarks.search_suite import NOISY, PERFECT, make_scene, starts_of
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action, PoseGraph

QUICK = PlannerParameters(variant="lookahead", dock=False, goals=4, lookahead_steps=30)


@pytest.fixture(scope="module")
def scene() -> SearchScene:
    return make_scene("easy", 0)


def ways(graph: PoseGraph) -> set[frozenset[tuple[float, float]]]:
    """Pairs of places (x, y) between which there is a way in both directions."""
    found = set()
    for action in (Action.FORWARD, Action.BACKWARD):
        for pose in np.nonzero(graph.successors[:, action] != NOWHERE)[0]:
            after = graph.successors[pose, action]
            there, back = (graph.x_m[pose], graph.y_m[pose]), (graph.x_m[after], graph.y_m[after])
            assert pose in graph.successors[after]
            found.add(frozenset([there, back]))
    return found


@pytest.mark.parametrize("share", [0.0, 0.05, 0.1, 1.0])
@pytest.mark.parametrize("seed", range(3))
def test_everything_can_still_be_reached(scene, share, seed):
    before = scene.space.graph
    after = with_blocked_ways(before, share, np.random.default_rng(seed))
    assert np.isfinite(after.steps_from(0)).all()
    assert np.array_equal(after.successors[:, 2:], before.successors[:, 2:])  # nobody is kept from turning
    assert ways(after) <= ways(before)
    blocked = len(ways(before)) - len(ways(after))
    if share < 1.0:
        assert blocked == round(share * len(ways(before)))
    else:  # a tree is left
        assert len(ways(after)) == len(before) // before.headings - 1


def test_the_seed_decides(scene):
    one, same, other = (
        with_blocked_ways(scene.space.graph, 0.1, np.random.default_rng(seed)).successors
        for seed in (1, 1, 2)
    )
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


@pytest.mark.parametrize("variant", ["lookahead", "greedy_gain", "pomp_belief"])
@pytest.mark.parametrize("number", [0, 7])
def test_a_search_goes_on_around_them(scene, variant, number):
    """It never goes where it is blocked, tries each way once at most, and each try costs a step."""
    target = scene.targets[number]
    start = int(starts_of(scene, target)[0])
    open_graph = with_blocked_ways(scene.space.graph, 0.3, np.random.default_rng(number))
    parameters = dataclasses.replace(QUICK, variant=variant, simulations=64)
    moments: list[BeliefMoment] = []
    rng = np.random.default_rng(number)
    result = run_episode(
        scene, target, PERFECT, start, parameters, BeliefParameters(), rng, moments, open_graph=open_graph
    )
    assert result.outcome is Outcome.SUCCESS
    assert result.steps == len(moments) - 1
    assert result.shortest == max(1, open_graph.steps_from(start)[target.in_view].min())
    for before, after in pairwise(moments):
        assert after.pose == before.pose or after.pose in open_graph.successors[before.pose]


def test_with_every_way_open_nothing_changes(scene):
    target = scene.targets[3]
    start = int(starts_of(scene, target)[0])
    results = []
    for open_graph in (None, scene.space.graph):
        moments: list[BeliefMoment] = []
        rng = np.random.default_rng(0)
        run_episode(
            scene, target, NOISY, start, QUICK, BeliefParameters(), rng, moments, open_graph=open_graph
        )
        results.append([moment.pose for moment in moments])
    assert results[0] == results[1]
