"""Problems to test POMCP on: Tiger (Kaelbling et al. 1998) and RockSample (Smith and Simmons 2004)."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.planner.pomcp import Tree, simulate
from robustnav_nodes.planner.problem import Particles, Problem, State, implement, is_legal, step
from robustnav_nodes.planner.random_stream import Stream, below, uniform
from robustnav_nodes.search_space.compiled import compiled, compiled_into_callers


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class KnownProblem:
    """A problem, its model, its discount, and its first belief.

    first_states(count, rng): int64 [count, state_size], whole states. spread: of returns, the UCT constant
    that its literature uses.
    """

    problem: Problem
    model: Any
    discount: float
    spread: float
    first_states: Callable[[int, np.random.Generator], Particles]


# Tiger ---------------------------------------------------------------------------------------------------

LISTEN, OPEN_LEFT, OPEN_RIGHT = 0, 1, 2


class TigerModel(NamedTuple):
    """State: [door of the tiger], 0 left or 1 right; an opened door puts it anew behind either."""

    p_hears_right: float
    reward_listen: float
    reward_tiger: float
    reward_free: float


def tiger() -> KnownProblem:
    """Goes on for ever; the optimum from where nothing is known is 19.37."""
    return KnownProblem(
        problem=_TIGER,
        model=TigerModel(p_hears_right=0.85, reward_listen=-1.0, reward_tiger=-100.0, reward_free=10.0),
        discount=0.95,
        spread=110.0,
        first_states=lambda count, rng: rng.integers(2, size=(count, 1)),
    )


def _tiger_step(model: TigerModel, state: State, action: int, rng: Stream) -> tuple[int, float, bool]:
    if action == LISTEN:
        heard = state[0] if uniform(rng) < model.p_hears_right else 1 - state[0]
        return heard, model.reward_listen, False
    reward = model.reward_tiger if action - OPEN_LEFT == state[0] else model.reward_free
    state[0] = below(rng, 2)
    return 0, reward, False


def _tiger_rollout_step(model: TigerModel, state: State, actions: int, rng: Stream) -> tuple[float, bool]:
    """Listen for ever: uniformly opened doors cost so much that their noise drowns what is known."""
    return model.reward_listen, False


implement(TigerModel, step=_tiger_step, rollout_step=_tiger_rollout_step)


@compiled
def _simulate_tiger(
    model: TigerModel, tree: Tree, particles: Particles, first: int, last: int, rng: Stream
) -> None:
    simulate(model, tree, particles, first, last, rng)


_TIGER = Problem(actions=3, observations=2, state_size=1, simulate=_simulate_tiger)

# RockSample ----------------------------------------------------------------------------------------------

NORTH, EAST, SOUTH, WEST, SAMPLE, CHECK = 0, 1, 2, 3, 4, 5  # CHECK + r checks rock r
NOTHING, GOOD, BAD = 0, 1, 2  # observations
# A state: [cell, then for each rock these]. What is hidden is whether it IS_GOOD; the rest is history.
IS_GOOD, IS_SAMPLED, BALANCE, CHECKS, EVIDENCE = 0, 1, 2, 3, 4
_PER_ROCK = 5
_NAT = 2**20  # evidence, the log odds of good, is kept in units of 1 / _NAT
_CERTAIN = 30.0  # nats, for readings that cannot err
_REWARD = 10.0  # for a good rock, and for leaving; a bad rock costs as much
_ENOUGH_CHECKS, _CLEAR_BALANCE = 5, 2  # then a rock is checked no more (code of Silver and Veness)

# (column, row) of the rocks and of the start in the layouts of the literature.
_LAYOUTS = {
    (7, 8): (((2, 0), (0, 1), (3, 1), (6, 3), (2, 4), (3, 4), (5, 5), (1, 6)), (0, 3)),
    (11, 11): (
        ((0, 3), (0, 7), (1, 8), (2, 4), (3, 3), (3, 8), (4, 3), (5, 8), (6, 1), (9, 3), (9, 9)),
        (0, 5),
    ),
}


class RockSampleModel(NamedTuple):
    """A square of `size` x `size` cells with rocks; leaving it to the east ends the problem.

    rock_at: int32 [cells], the rock in a cell, -1 where none; towards: int64 [cells, rocks], the moves from a
    cell that come nearer to a rock, as bits; p_right: float64 [cells, rocks], that a check from there is
    right; evidence: int64 [cells, rocks], what it says, in 1 / _NAT; prefers: whether rollouts prefer some
    actions; prior_visits, prior_value: how those begin in a new node.
    """

    size: int
    rocks: int
    rock_at: NDArray[np.int32]
    towards: NDArray[np.int64]
    p_right: Float64
    evidence: NDArray[np.int64]
    prefers: bool
    prior_visits: int
    prior_value: float


def rocksample(
    size: int,
    rocks: int,
    *,
    prefers: bool = True,
    prior: tuple[int, float] = (0, 0.0),
    half_distance: float = 20.0,
    layout: tuple[tuple[tuple[int, int], ...], tuple[int, int]] | None = None,
    seed: int = 0,
) -> KnownProblem:
    """RockSample[size, rocks]: each rock good with probability 1/2, known only by checks and by sampling.

    prefers: rollouts take preferred actions alone; prior: visits and value with which preferred actions begin
    in the tree, by default none. The authors' code gives them (10, 1.0); with 2^12 simulations on [7, 8] that
    costs a third of the return, for it makes all other actions look better at first.

    layout: (column, row) of each rock, and of the start; None: the literature's for [7, 8] and [11, 11], else
    rocks at random by `seed` and a start half way up the west side. A check from a distance d is right with
    probability (1 + 2^(-d / half_distance)) / 2. Legal: moves that stay on the square or leave it to the
    east, sampling where a rock is that was not sampled yet, checks of such rocks.
    """
    places, start = layout or _LAYOUTS.get((size, rocks)) or _random_layout(size, rocks, seed)
    if len(places) != rocks or len(set(places)) != rocks:
        raise BadParameterError(f"a layout of {rocks} rocks needs as many different places, not {places!r}")
    column, row = np.array(places, dtype=np.int32).reshape(rocks, 2).T.copy()
    cell = np.arange(size * size)[:, None]
    east, north = column - cell % size, row - cell // size  # cells from each to each rock
    distance = np.hypot(east, north)
    towards = (north > 0) << NORTH | (east > 0) << EAST | (north < 0) << SOUTH | (east < 0) << WEST
    p_right = 0.5 * (1.0 + 2.0 ** (-distance / half_distance))
    surely = 1.0 / (1.0 + math.exp(-_CERTAIN))
    nats = np.log(np.minimum(p_right, surely) / (1.0 - np.minimum(p_right, surely)))
    rock_at = np.full(size * size, -1, dtype=np.int32)
    rock_at[row * size + column] = np.arange(rocks)
    state_size = 1 + _PER_ROCK * rocks
    start_cell = start[1] * size + start[0]

    def first_states(count: int, rng: np.random.Generator) -> Particles:
        states = np.zeros((count, state_size), dtype=np.int64)
        states[:, 0] = start_cell
        states[:, 1 + IS_GOOD :: _PER_ROCK] = rng.integers(2, size=(count, rocks))
        return states

    return KnownProblem(
        problem=Problem(
            actions=CHECK + rocks, observations=3, state_size=state_size, simulate=_simulate_rocksample
        ),
        model=RockSampleModel(
            size=size,
            rocks=rocks,
            rock_at=rock_at,
            towards=towards,
            p_right=p_right,
            evidence=np.rint(nats * _NAT).astype(np.int64),
            prefers=prefers,
            prior_visits=prior[0],
            prior_value=prior[1],
        ),
        discount=0.95,
        spread=2.0 * _REWARD,
        first_states=first_states,
    )


def _random_layout(size: int, rocks: int, seed: int) -> tuple[tuple[tuple[int, int], ...], tuple[int, int]]:
    if rocks > size * size:
        raise BadParameterError(f"{rocks} rocks do not fit on {size} x {size} cells")
    cells = np.random.default_rng(seed).choice(size * size, size=rocks, replace=False)
    return tuple((int(cell % size), int(cell // size)) for cell in cells), (0, size // 2)


@compiled_into_callers
def _entry(rock: int, which: int) -> int:
    return 1 + _PER_ROCK * rock + which


def _rocksample_is_legal(model: RockSampleModel, state: State, action: int) -> bool:
    cell, size = state[0], model.size
    if action == NORTH:
        return bool(cell + size < size * size)
    if action == EAST:
        return True
    if action == SOUTH:
        return bool(cell >= size)
    if action == WEST:
        return bool(cell % size > 0)
    rock = model.rock_at[cell] if action == SAMPLE else action - CHECK
    return bool(rock >= 0 and state[_entry(rock, IS_SAMPLED)] == 0)


def _rocksample_step(
    model: RockSampleModel, state: State, action: int, rng: Stream
) -> tuple[int, float, bool]:
    cell, size = state[0], model.size
    observation, reward, ended = NOTHING, 0.0, False
    if action == SAMPLE:
        rock = model.rock_at[cell]
        reward = _REWARD if state[_entry(rock, IS_GOOD)] == 1 else -_REWARD
        state[_entry(rock, IS_SAMPLED)] = 1
    elif action >= CHECK:
        rock = action - CHECK
        is_right = uniform(rng) < model.p_right[cell, rock]
        seems_good = is_right == (state[_entry(rock, IS_GOOD)] == 1)
        observation, sign = (GOOD, 1) if seems_good else (BAD, -1)
        state[_entry(rock, BALANCE)] += sign
        state[_entry(rock, CHECKS)] += 1
        state[_entry(rock, EVIDENCE)] += sign * model.evidence[cell, rock]
    elif action == EAST and cell % size == size - 1:
        reward, ended = _REWARD, True
    elif action == EAST:
        state[0] += 1
    elif action == WEST:
        state[0] -= 1
    else:
        state[0] += size if action == NORTH else -size
    return observation, reward, ended


def _rocksample_rollout_step(
    model: RockSampleModel, state: State, actions: int, rng: Stream
) -> tuple[float, bool]:
    """Uniform over the preferred actions; over the legal ones where none is preferred."""
    choices = _preferred(model, state) if model.prefers else 0
    if choices == 0:
        for action in range(actions):
            if is_legal(model, state, action):
                choices |= 1 << action
    _, reward, ended = step(model, state, _one_of(choices, rng), rng)
    return reward, ended


def _rocksample_prior(model: RockSampleModel, state: State, action: int) -> tuple[int, float]:
    visits, value = 0, 0.0
    if model.prior_visits > 0 and (_preferred(model, state) >> action) & 1:
        visits, value = model.prior_visits, model.prior_value
    return visits, value


def _rocksample_reinvigorate(model: RockSampleModel, state: State, rng: Stream) -> None:
    """Draw one rock anew, given every reading of it; rocks do not depend on each other."""
    rock = below(rng, model.rocks)
    log_odds = state[_entry(rock, EVIDENCE)] / _NAT
    state[_entry(rock, IS_GOOD)] = 1 if uniform(rng) * (1.0 + math.exp(-log_odds)) < 1.0 else 0


@compiled_into_callers
def _one_of(choices: int, rng: Stream) -> int:
    """The number of one of the bits of `choices`, of which there is at least one."""
    count, rest = 0, choices
    while rest:
        rest &= rest - 1  # takes the lowest bit away
        count += 1
    for _ in range(below(rng, count)):
        choices &= choices - 1
    chosen = 0
    while (choices >> chosen) & 1 == 0:
        chosen += 1
    return chosen


@compiled_into_callers
def _preferred(model: RockSampleModel, state: State) -> int:
    """The preferred actions as bits, of the history alone, as in the code of Silver and Veness (2010).

    A rock that seems good and lies here is sampled. With no rock left that may be good: east. Else one goes
    towards such a rock, or checks one that is not clear yet. Bits may be 0: nothing is preferred.
    """
    cell = state[0]
    here = model.rock_at[cell]
    if here >= 0 and state[_entry(here, IS_SAMPLED)] == 0 and state[_entry(here, BALANCE)] > 0:
        return 1 << SAMPLE
    preferred, all_bad = 0, True
    for rock in range(model.rocks):
        if state[_entry(rock, IS_SAMPLED)] == 1:
            continue
        balance = state[_entry(rock, BALANCE)]
        if balance >= 0:
            all_bad = False
            preferred |= model.towards[cell, rock]
        is_known = abs(state[_entry(rock, EVIDENCE)]) >= int(_CERTAIN * _NAT)
        if not is_known and state[_entry(rock, CHECKS)] < _ENOUGH_CHECKS and abs(balance) < _CLEAR_BALANCE:
            preferred |= 1 << (CHECK + rock)
    return 1 << EAST if all_bad else preferred


implement(
    RockSampleModel,
    step=_rocksample_step,
    is_legal=_rocksample_is_legal,
    rollout_step=_rocksample_rollout_step,
    prior=_rocksample_prior,
    reinvigorate=_rocksample_reinvigorate,
)


@compiled
def _simulate_rocksample(
    model: RockSampleModel, tree: Tree, particles: Particles, first: int, last: int, rng: Stream
) -> None:
    simulate(model, tree, particles, first, last, rng)
