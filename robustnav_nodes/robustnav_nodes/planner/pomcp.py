"""POMCP (Silver and Veness 2010): Monte Carlo tree search from a set of particles, for any `Problem`.

One decision: simulations descend the tree by UCT, add at most one node each, and finish with a rollout, by
default of uniformly random legal actions; the action with the highest mean return wins.

Departures from the paper, all of them the thesis': a node is made at its action's second visit, not the
first; the tree is dropped after a real step, so that a decision depends on its particles alone.
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import RobustnavError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.planner.pomcp_parameters import PomcpParameters
from robustnav_nodes.planner.problem import (
    Particles,
    Problem,
    State,
    begin,
    is_legal,
    prior,
    rollout_step,
    step,
)
from robustnav_nodes.planner.random_stream import Stream, below, stream_from
from robustnav_nodes.search_space.compiled import compiled_into_callers

Clock = Callable[[], float]
Int32 = NDArray[np.int32]
_NO_NODE = -1
_ROOT = 0


class Tree(NamedTuple):
    """The search tree, allocated whole (node 0 is the root), its settings, and its scratch space.

    visits: int32 [nodes, actions]; value: float64 [nodes, actions], mean discounted return;
    child: int32 [nodes, actions, observations], _NO_NODE where none; used: int64 [1], nodes in use.
    first_action, first_observation: int32 [simulations], how each simulation began.
    steps: int64 [1], steps simulated so far, in the tree and beyond.
    path_node, path_action: int32 [max_depth], path_reward: float64 [max_depth], scratch: the way of the
    simulation through the tree; state: its state, scratch.
    """

    visits: Int32
    value: Float64
    child: Int32
    used: NDArray[np.int64]
    first_action: Int32
    first_observation: Int32
    steps: NDArray[np.int64]
    path_node: Int32
    path_action: Int32
    path_reward: Float64
    state: State
    discount: float
    exploration: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plan:
    """What POMCP decided and how every action looked; actions by the problem's numbers.

    values: float64 [actions], mean discounted return, NaN for an action never tried; visits: int32
    [actions], both with what `prior` says; nodes: size of the tree; first_action, first_observation: int32
    [simulations], how each simulation began; steps: simulated in all, in the tree and beyond.
    """

    action: int
    values: Float64
    visits: Int32
    nodes: int
    first_action: Int32
    first_observation: Int32
    simulations: int
    elapsed_ms: float
    steps: int


def plan(
    problem: Problem,
    model: Any,
    particles: Particles,
    parameters: PomcpParameters,
    rng: np.random.Generator,
    clock: Clock = time.monotonic,
) -> Plan:
    """Decide on the next action.

    particles: int64 [p] or [p, w], hidden truths drawn from the belief; simulation s takes number s modulo p.
    Ends after `simulations`, or with the batch during which `time_budget_s` of `clock` (seconds) runs out: at
    least one batch always runs, so there is always an answer. The same model, particles and state of `rng`
    give the same decision on every machine unless the time runs out. Raises RobustnavError where there are no
    particles or no action is legal.
    """
    if len(particles) == 0:
        raise RobustnavError("POMCP was given no particles: there is nothing left to look for")
    particles = np.ascontiguousarray(particles, dtype=np.int64)
    run = problem.simulate or simulate
    tree = _empty_tree(problem, parameters)
    stream = stream_from(rng)
    run(model, tree, particles, 0, 0, stream)  # the first call compiles; the clock must not see it
    wanted, done, began = parameters.simulations, 0, clock()
    while done < wanted:
        until = min(wanted, done + parameters.batch_simulations)
        run(model, tree, particles, done, until, stream)
        done = until
        if clock() - began >= parameters.time_budget_s:
            break
    visits = tree.visits[_ROOT].copy()
    if not visits.any():
        raise RobustnavError("no action is legal here: every way from this pose is closed")
    values = np.where(visits > 0, tree.value[_ROOT], np.nan)
    return Plan(
        action=int(np.nanargmax(values)),
        values=values,
        visits=visits,
        nodes=int(tree.used[0]),
        first_action=tree.first_action[:done],
        first_observation=tree.first_observation[:done],
        simulations=done,
        steps=int(tree.steps[0]),
        elapsed_ms=1000.0 * (clock() - began),
    )


def _empty_tree(problem: Problem, parameters: PomcpParameters) -> Tree:
    nodes, depth = parameters.simulations + 1, parameters.max_depth
    return Tree(
        visits=np.zeros((nodes, problem.actions), dtype=np.int32),
        value=np.zeros((nodes, problem.actions)),
        child=np.full((nodes, problem.actions, problem.observations), _NO_NODE, dtype=np.int32),
        used=np.zeros(1, dtype=np.int64),
        first_action=np.zeros(parameters.simulations, dtype=np.int32),
        first_observation=np.zeros(parameters.simulations, dtype=np.int32),
        steps=np.zeros(1, dtype=np.int64),
        path_node=np.zeros(depth, dtype=np.int32),
        path_action=np.zeros(depth, dtype=np.int32),
        path_reward=np.zeros(depth),
        state=np.zeros(problem.state_size, dtype=np.int64),
        discount=parameters.discount,
        exploration=parameters.exploration,
    )


@compiled_into_callers
def simulate(
    model: Any,
    tree: Tree,
    particles: Particles,
    first_simulation: int,
    last_simulation: int,
    rng: Stream,
) -> None:
    """Run simulations first_simulation .. last_simulation - 1 and enter them into `tree`."""
    state, max_depth = tree.state, len(tree.path_node)
    for simulation in range(first_simulation, last_simulation):
        begin(model, particles[simulation % len(particles)], simulation, state)
        node = _ROOT if tree.used[0] > 0 else _new_node(model, tree, state)
        depth, ended, grown, back = 0, False, False, 0.0
        while depth < max_depth:
            action = _uct_action(model, tree, node, state, rng)
            if action < 0:
                ended = True
                break
            observation, reward, ended = step(model, state, action, rng)
            if depth == 0:
                tree.first_action[simulation] = action
                tree.first_observation[simulation] = observation
            tree.path_node[depth], tree.path_action[depth], tree.path_reward[depth] = node, action, reward
            depth += 1
            if ended:
                break
            child = tree.child[node, action, observation]
            if child == _NO_NODE:
                # At its action's second visit, those of `prior` included; at most one in a simulation.
                if grown or tree.visits[node, action] == 0:
                    break
                grown = True
                child = _new_node(model, tree, state)
                tree.child[node, action, observation] = child
            node = child
        tree.steps[0] += depth
        if not ended:
            back = _rollout(model, tree, max_depth - depth, rng)

        for at in range(depth - 1, -1, -1):
            back = tree.path_reward[at] + tree.discount * back
            node, action = tree.path_node[at], tree.path_action[at]
            tree.visits[node, action] += 1
            tree.value[node, action] += (back - tree.value[node, action]) / tree.visits[node, action]


@compiled_into_callers
def _new_node(model: Any, tree: Tree, state: State) -> int:
    node = int(tree.used[0])
    tree.used[0] += 1
    for action in range(tree.visits.shape[1]):
        if is_legal(model, state, action):
            tree.visits[node, action], tree.value[node, action] = prior(model, state, action)
    return node


@compiled_into_callers
def _uct_action(model: Any, tree: Tree, node: int, state: State, rng: Stream) -> int:
    """The legal action of the highest upper confidence bound, chance among equals; -1 where none is legal."""
    action_count = tree.visits.shape[1]
    total = 0
    for action in range(action_count):
        total += tree.visits[node, action]
    log_total = _log(total) if total > 0 else 0.0
    best_action, best_bound, equals = -1, -math.inf, 0
    for action in range(action_count):
        if not is_legal(model, state, action):
            continue
        visits = tree.visits[node, action]
        bound = math.inf
        if visits > 0:
            bound = tree.value[node, action] + tree.exploration * math.sqrt(log_total / visits)
        if bound > best_bound:
            best_action, best_bound, equals = action, bound, 1
        elif bound == best_bound:
            equals += 1
            if below(rng, equals) == 0:
                best_action = action
    return best_action


@compiled_into_callers
def _rollout(model: Any, tree: Tree, max_steps: int, rng: Stream) -> float:
    """Discounted return of at most `max_steps` steps beyond the tree."""
    state, actions, discount = tree.state, tree.visits.shape[1], tree.discount
    total, weight, steps, ended = 0.0, 1.0, 0, False
    while steps < max_steps and not ended:
        reward, ended = rollout_step(model, state, actions, rng)
        total += weight * reward
        weight *= discount
        steps += 1
    tree.steps[0] += steps
    return total


_LN_2 = math.log(2.0)
_SQRT_HALF = math.sqrt(0.5)


@compiled_into_callers
def _log(count: int) -> float:
    """Natural logarithm of a positive number by + - * / alone, as 2 artanh((m - 1) / (m + 1)) + e ln 2.

    The last bit of a C library's logarithm depends on the processor; decisions must not.
    """
    mantissa, exponent = math.frexp(count)
    if mantissa < _SQRT_HALF:
        mantissa, exponent = 2.0 * mantissa, exponent - 1
    power = (mantissa - 1.0) / (mantissa + 1.0)
    square = power * power
    total = 0.0
    for odd in range(1, 21, 2):  # |power| < 0.172, so the next term is below 2^-53
        total += power / odd
        power *= square
    return 2.0 * total + exponent * _LN_2
