"""POMCP (Silver and Veness 2010): Monte Carlo tree search from a set of particles, for any `Problem`.

One decision: simulations descend the tree by UCT, add at most one node each, and finish with a rollout of
uniformly random legal actions; the action with the highest mean return wins.
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
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.problem import Problem, State, begin, is_legal, step
from robustnav_nodes.search_space.compiled import compiled_into_callers

Clock = Callable[[], float]
Int32 = NDArray[np.int32]
_NO_NODE = -1


class Tree(NamedTuple):
    """The search tree, allocated whole (node 0 is the root), its settings, and its scratch space.

    visits: int32 [nodes, actions]; value: float64 [nodes, actions], mean discounted return;
    child: int32 [nodes, actions, observations], _NO_NODE where none; used: int32 [1], nodes in use.
    first_action, first_observation: int32 [simulations], how each simulation began.
    """

    visits: Int32
    value: Float64
    child: Int32
    used: Int32
    first_action: Int32
    first_observation: Int32
    state: State
    max_depth: int
    discount: float
    exploration: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Plan:
    """What POMCP decided and how every action looked; actions by the problem's numbers.

    values: float64 [actions], mean discounted return, NaN for an action never tried; visits: int32
    [actions]; nodes: size of the tree; first_action, first_observation: int32 [simulations], how each
    simulation began.
    """

    action: int
    values: Float64
    visits: Int32
    nodes: int
    first_action: Int32
    first_observation: Int32
    simulations: int
    elapsed_ms: float


def plan(
    problem: Problem,
    model: Any,
    particles: NDArray[np.int64],
    parameters: PlannerParameters,
    rng: np.random.Generator,
    clock: Clock = time.monotonic,
) -> Plan:
    """Decide on the next action.

    particles: int64 [p], hidden truths drawn from the belief; simulation s takes number s modulo p. Ends
    after `simulations`, or with the batch during which `time_budget_s` of `clock` (seconds) runs out: at
    least one batch always runs, so there is always an answer. The same model, particles and state of `rng`
    give the same decision unless the time runs out. Raises RobustnavError where there are no particles or
    no action is legal.
    """
    if len(particles) == 0:
        raise RobustnavError("POMCP was given no particles: there is nothing left to look for")
    tree = _empty_tree(problem, parameters)
    problem.simulate(model, tree, particles, 0, 0, rng)  # the first call compiles; the clock must not see it
    wanted, done, began = parameters.simulations, 0, clock()
    while done < wanted:
        until = min(wanted, done + parameters.batch_simulations)
        problem.simulate(model, tree, particles, done, until, rng)
        done = until
        if clock() - began >= parameters.time_budget_s:
            break
    visits = tree.visits[0].copy()
    if not visits.any():
        raise RobustnavError("no action is legal here: every way from this pose is closed")
    values = np.where(visits > 0, tree.value[0], np.nan)
    return Plan(
        action=int(np.nanargmax(values)),
        values=values,
        visits=visits,
        nodes=int(tree.used[0]),
        first_action=tree.first_action[:done],
        first_observation=tree.first_observation[:done],
        simulations=done,
        elapsed_ms=1000.0 * (clock() - began),
    )


def _empty_tree(problem: Problem, parameters: PlannerParameters) -> Tree:
    nodes = parameters.simulations + 1
    return Tree(
        visits=np.zeros((nodes, problem.actions), dtype=np.int32),
        value=np.zeros((nodes, problem.actions)),
        child=np.full((nodes, problem.actions, problem.observations), _NO_NODE, dtype=np.int32),
        used=np.ones(1, dtype=np.int32),
        first_action=np.zeros(parameters.simulations, dtype=np.int32),
        first_observation=np.zeros(parameters.simulations, dtype=np.int32),
        state=np.zeros(problem.state_size, dtype=np.int64),
        max_depth=parameters.max_depth,
        discount=parameters.discount,
        exploration=parameters.exploration,
    )


@compiled_into_callers
def simulate(
    model: Any,
    tree: Tree,
    particles: NDArray[np.int64],
    first_simulation: int,
    last_simulation: int,
    rng: np.random.Generator,
) -> None:
    """Run simulations first_simulation .. last_simulation - 1 and enter them into `tree`."""
    state = tree.state
    path_node = np.zeros(tree.max_depth, dtype=np.int32)
    path_action = np.zeros(tree.max_depth, dtype=np.int32)
    path_reward = np.zeros(tree.max_depth)
    for simulation in range(first_simulation, last_simulation):
        begin(model, particles[simulation % len(particles)], simulation, state)
        node, depth, ended, beyond = 0, 0, False, 0.0
        while depth < tree.max_depth:
            action = _uct_action(model, tree, node, state, rng)
            if action < 0:
                break
            observation, reward, ended = step(model, state, action, rng)
            if depth == 0:
                tree.first_action[simulation] = action
                tree.first_observation[simulation] = observation
            path_node[depth], path_action[depth], path_reward[depth] = node, action, reward
            depth += 1
            if ended:
                break
            child = tree.child[node, action, observation]
            if child < 0:
                # A node is made at its action's second visit, so one simulation adds at most one.
                if tree.visits[node, action] == 0:
                    break
                child = tree.used[0]
                tree.used[0] += 1
                tree.child[node, action, observation] = child
            node = child
        if not ended:
            beyond = _rollout(model, tree, tree.max_depth - depth, rng)

        back = beyond
        for at in range(depth - 1, -1, -1):
            back = path_reward[at] + tree.discount * back
            node, action = path_node[at], path_action[at]
            tree.visits[node, action] += 1
            tree.value[node, action] += (back - tree.value[node, action]) / tree.visits[node, action]


@compiled_into_callers
def _uct_action(model: Any, tree: Tree, node: int, state: State, rng: np.random.Generator) -> int:
    """The legal action of the highest upper confidence bound, chance among equals; -1 where none is legal."""
    action_count = tree.visits.shape[1]
    total = 0
    for action in range(action_count):
        total += tree.visits[node, action]
    log_total = math.log(total) if total > 0 else 0.0
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
            if rng.random() * equals < 1.0:
                best_action = action
    return best_action


@compiled_into_callers
def _rollout(model: Any, tree: Tree, max_steps: int, rng: np.random.Generator) -> float:
    """Discounted return of at most `max_steps` uniformly random legal actions."""
    state, action_count = tree.state, tree.visits.shape[1]
    total, weight = 0.0, 1.0
    for _ in range(max_steps):
        legal = 0
        for action in range(action_count):
            if is_legal(model, state, action):
                legal += 1
        if legal == 0:
            break
        pick = int(rng.random() * legal)
        chosen = 0
        for action in range(action_count):
            if is_legal(model, state, action):
                if pick == 0:
                    chosen = action
                    break
                pick -= 1
        _, reward, ended = step(model, state, chosen, rng)
        total += weight * reward
        weight *= tree.discount
        if ended:
            break
    return total
