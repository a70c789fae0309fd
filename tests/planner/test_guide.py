"""The plan that rollouts follow, and that it changes nothing where nobody follows it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_nodes.planner.guide import NO_GUIDE, guide_from, ways_to
from robustnav_nodes.planner.pomcp import plan
from robustnav_nodes.planner.search import Search
from robustnav_nodes.planner.search_problem import SEARCH, search_model
from robustnav_nodes.planner.viewpoints import outlook_on, place_of
from robustnav_nodes.search_space.pose_graph import NOWHERE


def guide_on(space, mass, start, *, most_goals=20, looked=()):
    place = place_of(space.graph, space.observability)
    looked = np.isin(np.arange(len(space.graph)), list(looked))
    return guide_from(place, outlook_on(place, np.array(mass), looked), start, most_goals)


@settings(deadline=None)  # the first call compiles
@given(seed=st.integers(0, 10_000))
def test_each_step_of_the_guide_is_on_a_shortest_way(by_hand, seed):
    """Whatever the graph, one-way ways included: one step fewer from where it points."""
    graph = by_hand.maze(seed).graph
    goals = range(len(graph))
    towards = np.stack([ways_to(graph.successors, goal) for goal in goals])
    steps = np.stack([graph.steps_from(pose) for pose in range(len(graph))])
    for goal in goals:
        for pose in range(len(graph)):
            after = towards[goal, pose]
            if after == NOWHERE:
                assert pose == goal or np.isinf(steps[pose, goal])
            else:
                assert after in graph.successors[pose]
                assert steps[after, goal] == steps[pose, goal] - 1


def test_the_goals_are_those_of_the_greedy_plan_by_hand(by_hand):
    """Three steps to 0.6 are better than one to 0.1; then back to what is left, which pose 1 has shown."""
    space = by_hand.corridor([], [0], [], [1], [], [2])
    guide = guide_on(space, [0.1, 0.6, 0.3], 0)
    assert guide.goals.tolist() == [3, 5]
    assert guide.towards[0].tolist() == [1, 2, 3, NOWHERE, 3, 4]


@settings(deadline=None)  # the first call compiles
@given(seed=st.integers(0, 10_000))
def test_the_guide_leaves_nothing_that_can_be_reached(by_hand, seed):
    """Along its goals every candidate with any belief comes into view; no goal comes twice."""
    space = by_hand.maze(seed)
    mass = np.random.default_rng(seed).random(len(space.candidates)) + 0.1
    guide = guide_on(space, mass / mass.sum(), 0, looked=[0])
    pose, seen = 0, set(space.observability.seen_by(0).tolist())
    for number, goal in enumerate(guide.goals):
        while pose != goal:
            pose = int(guide.towards[number, pose])
            seen |= set(space.observability.seen_by(pose).tolist())
    assert len(set(guide.goals.tolist())) == len(guide.goals)
    assert seen >= set(np.nonzero(space.observability.seen_from_somewhere())[0].tolist())


def test_there_are_no_more_goals_than_asked_for(home):
    mass = np.full(len(home.candidates), 1.0 / len(home.candidates))
    assert len(guide_on(home, mass, 0, most_goals=3).goals) == 3


def test_guidance_0_decides_as_if_there_were_no_guide(home, parameters_with):
    """To the last simulation."""
    mass = np.random.default_rng(1).random(len(home.candidates))
    values = []
    for changes in ({"variant": "pomp_belief"}, {"variant": "pomp_guided", "guidance": 0.0}):
        parameters = parameters_with(simulations=512, time_budget_s=60.0, **changes)
        search = Search(space=home, parameters=parameters, rng=np.random.default_rng(3))
        step = search.look(40, home.observability.row(40), mass / mass.sum())
        values.append(step.choice.values)
    np.testing.assert_array_equal(*values)


@pytest.mark.parametrize("guidance", [0.5, 0.8, 1.0])
def test_guided_rollouts_find_what_random_ones_do_not(by_hand, parameters_with, guidance):
    """At the end of a long corridor, seen from its last pose alone."""
    length = 40
    space = by_hand.corridor(*[[]] * (length - 1), [0], candidates=1)
    parameters = parameters_with(guidance=guidance, simulations=256, time_budget_s=60.0, max_depth=120)
    been = np.isin(np.arange(length), [0])
    guide = guide_on(space, [1.0], 0, looked=[0])
    values = []
    for followed in (None, guide):
        model = search_model(space.graph, space.observability, 0, been, parameters, followed)
        made = plan(SEARCH, model, np.zeros(256, dtype=np.int64), parameters, np.random.default_rng(0))
        values.append(np.nanmax(made.values))
    assert values[0] < 0.3 * values[1]
    assert values[1] < parameters.discount ** (length - 2) * parameters.reward_seen


def test_a_rollout_never_waits_at_a_goal_that_it_has_reached(by_hand, parameters_with):
    """The plan's first goal holds nothing for this target; the rollout goes on to the second."""
    space = by_hand.corridor([], [0], [1], [2])
    parameters = parameters_with(guidance=1.0, simulations=64, time_budget_s=60.0)
    guide = guide_on(space, [0.5, 0.3, 0.2], 0)
    assert guide.goals.tolist() == [1, 2, 3]
    model = search_model(space.graph, space.observability, 0, np.arange(4) == 0, parameters, guide)
    made = plan(SEARCH, model, np.full(64, 2), parameters, np.random.default_rng(0))
    assert made.values[0] > 0.8 * parameters.reward_seen


def test_without_a_guide_there_is_nothing_to_follow(home, parameters_with):
    parameters = parameters_with(guidance=0.8)
    model = search_model(home.graph, home.observability, 0, np.zeros(len(home.graph), bool), parameters)
    assert model.guidance == 0.0
    assert model.guide is NO_GUIDE
