import doctest
import itertools
import math
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import robustnav_nodes.planner.problem
from robustnav_msgs_py.errors import RobustnavError
from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.benchmarks.pomdp_problems import rocksample, tiger
from robustnav_nodes.planner.pomcp import _log, plan
from robustnav_nodes.planner.pomcp_parameters import PomcpParameters
from robustnav_nodes.planner.problem import Problem, implement, step
from robustnav_nodes.planner.search_problem import SEARCH, search_model
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action


def decide(space, parameters, start, particles, seed=0, visited=None, graph=None, **more):
    graph = space.graph if graph is None else graph
    visited = np.zeros(len(graph), dtype=bool) if visited is None else visited
    model = search_model(graph, space.observability, start, visited, parameters)
    rng = np.random.default_rng(seed)
    return plan(SEARCH, model, np.asarray(particles, dtype=np.int64), parameters, rng, **more)


@given(seed=st.integers(0, 2**32), start=st.integers(0, 10_000))
@settings(max_examples=20, deadline=None)
def test_same_seed_same_decision(home, parameters_with, seed, start):
    parameters = parameters_with(simulations=128)
    particles = np.arange(len(home.candidates))
    one, other = (decide(home, parameters, start % len(home.graph), particles, seed) for _ in range(2))
    assert one.action == other.action
    np.testing.assert_array_equal(one.values, other.values)
    np.testing.assert_array_equal(one.visits, other.visits)


def test_a_seed_gives_the_same_decision_on_every_machine():
    """To the last bit; these numbers change only where the search is meant to change."""
    known, rng = tiger(), np.random.default_rng(0)
    parameters = PomcpParameters(simulations=256, exploration=known.spread, discount=known.discount)
    chosen = plan(known.problem, known.model, known.first_states(256, rng), parameters, rng)
    assert [value.hex() for value in chosen.values.tolist()] == [
        "-0x1.0e01889c3ace9p+6",
        "-0x1.74c8e2941b978p+6",
        "-0x1.401d701891998p+7",
    ]
    assert chosen.visits.tolist() == [205, 45, 6]


@given(seed=st.integers(0, 1000), start=st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_illegal_actions_are_never_taken(home, parameters_with, seed, start):
    start %= len(home.graph)
    chosen = decide(home, parameters_with(simulations=64), start, [0, 1, 2], seed)
    illegal = home.graph.successors[start] == NOWHERE
    assert np.all(chosen.visits[illegal] == 0)
    assert np.all(np.isnan(chosen.values[illegal]))
    assert np.all(chosen.visits[~illegal] > 0)
    assert not illegal[chosen.action]
    assert chosen.visits.sum() == chosen.simulations == 64


def test_illegal_actions_never_enter_a_rollout(home, parameters_with):
    """A closed graph: one that took a way that does not exist would leave the two poses that are left."""
    successors = np.full_like(home.graph.successors, NOWHERE)
    successors[5, Action.TURN_LEFT] = 6
    successors[6, Action.TURN_RIGHT] = 5
    closed = type(home.graph)(
        x_m=home.graph.x_m,
        y_m=home.graph.y_m,
        yaw_rad=home.graph.yaw_rad,
        successors=successors,
        headings=home.graph.headings,
    )
    model = search_model(
        closed, home.observability, 5, np.zeros(len(closed), dtype=bool), parameters_with(simulations=64)
    )
    target = int(np.nonzero(~home.observability.row(5) & ~home.observability.row(6))[0][0])
    plan(SEARCH, model, np.array([target]), parameters_with(simulations=64), np.random.default_rng(0))
    assert set(np.nonzero(model.last_visit >= 0)[0].tolist()) <= {5, 6}


def test_in_a_corridor_only_forward_makes_sense(space_of, parameters_with):
    parameters = parameters_with(headings=4, range_max_m=1.5)
    space = space_of(
        "####################",
        "#................o##",
        "####################",
        headings=4,
        range_max_m=1.5,
    )
    start = space.graph.nearest(Pose2D(x_m=2.0, y_m=0.45, yaw_rad=0.0))
    chosen = decide(space, parameters, start, np.arange(len(space.candidates)))
    assert Action(chosen.action) is Action.FORWARD
    backwards = space.graph.nearest(Pose2D(x_m=2.0, y_m=0.45, yaw_rad=math.pi))
    assert Action(decide(space, parameters, backwards, [0]).action) is not Action.FORWARD


def test_a_target_seen_in_one_turn_is_worth_the_reward(home, parameters_with):
    """Seen by turning left and by nothing else in one step: that action's value is 1000."""
    graph, observability = home.graph, home.observability
    for start, target in itertools.product(range(0, len(graph), 5), range(len(home.candidates))):
        ends = graph.successors[start]
        sees = [end != NOWHERE and bool(observability.column(target)[end]) for end in ends]
        if sees == [False, False, True, False]:
            break
    chosen = decide(home, parameters_with(), start, [target])
    assert Action(chosen.action) is Action.TURN_LEFT
    assert chosen.values[Action.TURN_LEFT] == pytest.approx(1000.0)
    assert np.all(chosen.first_observation == (chosen.first_action == Action.TURN_LEFT))


def test_a_pose_visited_before_costs_ten(home, parameters_with):
    """One step deep, the target out of sight, an action is worth -1, and -10 where the robot has been."""
    graph = home.graph
    start = next(i for i in range(len(graph)) if len(graph.legal_actions(i)) == 4)
    hidden = ~np.any([home.observability.row(i) for i in graph.successors[start]], axis=0)
    visited = np.zeros(len(graph), dtype=bool)
    visited[[start, graph.successors[start, Action.BACKWARD]]] = True
    target = int(np.nonzero(hidden)[0][0])
    chosen = decide(home, parameters_with(max_depth=1), start, [target], visited=visited)
    np.testing.assert_allclose(chosen.values, [-1.0, -10.0, -1.0, -1.0])


def test_going_back_and_forth_counts_as_a_revisit(home, parameters_with):
    """Two steps deep: straight on, then any of four; one of them comes back, to a pose worth -10."""
    graph = home.graph
    start = next(
        i
        for i in range(len(graph))
        if len(graph.legal_actions(i)) == 4
        and all(len(graph.legal_actions(int(end))) == 4 for end in graph.successors[i])
    )
    reach = {start} | {int(b) for a in graph.successors[start] for b in graph.successors[a]}
    hidden = ~np.any([home.observability.row(i) for i in reach | set(graph.successors[start])], axis=0)
    target = int(np.nonzero(hidden)[0][0])
    parameters = parameters_with(max_depth=2, simulations=20_000, exploration=1e6)
    chosen = decide(home, parameters, start, [target])
    np.testing.assert_allclose(chosen.values, -1.0 - 0.97 * (3 * 1.0 + 10.0) / 4, rtol=0.02)


def test_time_ends_a_decision_after_whole_batches(home, parameters_with):
    ticks = itertools.count()
    parameters = parameters_with(time_budget_s=2.5, batch_simulations=16)
    chosen = decide(home, parameters, 0, [0, 1], clock=lambda: float(next(ticks)))
    assert chosen.simulations == 3 * 16
    assert chosen.visits.sum() == 48
    hurried = decide(home, parameters, 0, [0, 1], clock=lambda: 100.0 * next(ticks))
    assert hurried.simulations == 16
    assert len(hurried.first_action) == 16


def test_batches_do_not_change_the_decision(home, parameters_with):
    small = decide(home, parameters_with(batch_simulations=8), 40, [0, 1, 2])
    whole = decide(home, parameters_with(batch_simulations=4096), 40, [0, 1, 2])
    np.testing.assert_array_equal(small.values, whole.values)


def test_nothing_to_look_for_is_refused(home, parameters_with):
    with pytest.raises(RobustnavError, match="no particles"):
        decide(home, parameters_with(), 0, [])


def test_no_way_out_is_refused(home, parameters_with):
    closed = type(home.graph)(
        x_m=home.graph.x_m,
        y_m=home.graph.y_m,
        yaw_rad=home.graph.yaw_rad,
        successors=np.full_like(home.graph.successors, NOWHERE),
        headings=home.graph.headings,
    )
    with pytest.raises(RobustnavError, match="no action is legal"):
        decide(home, parameters_with(), 0, [0], graph=closed)


class CountingModel(NamedTuple):
    """Five actions of which some are legal; counts which are taken. Nothing is ever observed or won."""

    taken: np.ndarray
    legal: np.ndarray


def _counting_is_legal(model, state, action):
    return model.legal[action]


def _counting_step(model, state, action, rng):
    model.taken[action] += 1
    return 0, 0.0, False


implement(CountingModel, is_legal=_counting_is_legal, step=_counting_step)
COUNTING = Problem(actions=5, observations=1, state_size=1)


def counting(*legal):
    return CountingModel(taken=np.zeros(5, dtype=np.int64), legal=np.isin(np.arange(5), legal))


def test_rollouts_are_uniform_over_legal_actions(parameters_with):
    model = counting(1, 3, 4)
    plan(COUNTING, model, np.array([0]), parameters_with(simulations=512), np.random.default_rng(0))
    assert model.taken.sum() == 512 * 300
    assert model.taken[[0, 2]].tolist() == [0, 0]
    np.testing.assert_allclose(model.taken[[1, 3, 4]] / model.taken.sum(), 1 / 3, rtol=0.02)


def test_every_simulated_step_is_counted(parameters_with):
    model = counting(1, 3, 4)
    parameters = parameters_with(simulations=100, batch_simulations=8)
    assert plan(COUNTING, model, np.array([0]), parameters, np.random.default_rng(0)).steps == 100 * 300
    assert model.taken.sum() == 100 * 300


def test_a_node_is_made_at_its_actions_second_visit(parameters_with):
    """With one legal action the first simulation makes no node, and each of the others makes one."""
    parameters = parameters_with(simulations=20)
    chosen = plan(COUNTING, counting(1), np.array([0]), parameters, np.random.default_rng(0))
    assert chosen.nodes == 1 + 19


class BanditModel(NamedTuple):
    """One step; action a pays a. Actions from `first_preferred` on begin with two visits worth 100 each."""

    first_preferred: int


def _bandit_step(model, state, action, rng):
    return 0, float(action), True


def _bandit_prior(model, state, action):
    return (2, 100.0) if action >= model.first_preferred else (0, 0.0)


implement(BanditModel, step=_bandit_step, prior=_bandit_prior)
BANDIT = Problem(actions=4, observations=1, state_size=1)


def test_a_prior_counts_like_visits_and_fades():
    parameters = PomcpParameters(simulations=8, exploration=0.0)
    chosen = plan(BANDIT, BanditModel(2), np.array([0]), parameters, np.random.default_rng(0))
    # The two without a prior are tried once each; the other six go to where the mean is highest.
    assert chosen.visits.tolist()[:2] == [1, 1]
    assert chosen.visits[2:].sum() == 4 + 6
    visits = chosen.visits[2:] - 2
    np.testing.assert_allclose(chosen.values[2:], (200.0 + visits * [2.0, 3.0]) / (2 + visits))
    many = PomcpParameters(simulations=100_000, exploration=1.0)
    chosen = plan(BANDIT, BanditModel(2), np.array([0]), many, np.random.default_rng(0))
    assert chosen.action == 3
    assert chosen.values[3] == pytest.approx(3.0, abs=0.01)


def test_a_prior_makes_no_more_than_one_node_a_simulation():
    known = rocksample(7, 8, prior=(10, 20.0))
    parameters = PomcpParameters(simulations=256, discount=known.discount, max_depth=90)
    rng = np.random.default_rng(0)
    chosen = plan(known.problem, known.model, known.first_states(256, rng), parameters, rng)
    assert chosen.nodes <= 256 + 1


class CornerModel(NamedTuple):
    """Three steps east end it; the rollout policy goes east, and never west where that would be legal."""

    seen: np.ndarray


def _corner_step(model, state, action, rng):
    model.seen[action] += 1
    state[0] += 1 if action == 0 else -1
    return 0, -1.0, state[0] == 3


def _corner_rollout_step(model, state, actions, rng):
    _, reward, ended = step(model, state, 0, rng)
    return reward, ended


implement(CornerModel, step=_corner_step, rollout_step=_corner_rollout_step)


def test_a_problem_may_bring_its_rollout_policy():
    """From each first action on, the way is straight: -1 a step, three steps or five."""
    model = CornerModel(np.zeros(2, dtype=np.int64))
    problem = Problem(actions=2, observations=1, state_size=1)
    parameters = PomcpParameters(simulations=8, exploration=1e6, discount=0.5)
    chosen = plan(problem, model, np.array([0]), parameters, np.random.default_rng(0))
    assert chosen.action == 0
    assert chosen.values[0] == pytest.approx(-1.75, abs=0.2)


@pytest.mark.parametrize("states", [np.array([7, 7]), np.array([[7, 0], [7, 0]])])
def test_a_particle_may_be_a_whole_state(states):
    """What `begin` does not say is said by the particle: a number, or a row."""
    model = CornerModel(np.zeros(2, dtype=np.int64))
    problem = Problem(actions=2, observations=1, state_size=states.ndim)
    parameters = PomcpParameters(simulations=8, max_depth=4)
    chosen = plan(problem, model, states - 5, parameters, np.random.default_rng(0))
    assert chosen.values[0] == -1.0  # one step east of 2


@pytest.mark.parametrize("count", [1, 2, 3, 7, 1000, 1025, 10**6, 2**31 - 1])
def test_the_logarithm_is_the_logarithm(count):
    assert _log(count) == pytest.approx(math.log(count), rel=1e-15, abs=1e-16)


def test_the_example_in_the_documentation_works():
    failed, tried = doctest.testmod(robustnav_nodes.planner.problem)
    assert tried > 10
    assert failed == 0
