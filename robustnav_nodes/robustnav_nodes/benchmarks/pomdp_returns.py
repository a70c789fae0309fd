"""What POMCP reaches on Tiger and RockSample: episodes, with a particle filter between decisions."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.pomdp_problems import KnownProblem, rocksample, tiger
from robustnav_nodes.planner.particle_update import updated_particles
from robustnav_nodes.planner.pomcp import plan
from robustnav_nodes.planner.pomcp_parameters import PomcpParameters
from robustnav_nodes.planner.problem import State, step
from robustnav_nodes.planner.random_stream import Stream, stream_from
from robustnav_nodes.search_space.compiled import compiled_into_callers

NEGLIGIBLE = 0.01  # rewards are neglected from where the discount falls below this, as Silver and Veness do
FEWEST_PARTICLES = 1024
NO_TIME_LIMIT_S = 60.0


@dataclass(frozen=True, slots=True, kw_only=True)
class MeanReturn:
    """Mean discounted return of `episodes` episodes, and its standard error."""

    mean: float
    standard_error: float
    episodes: int


def tiger_return(*, simulations: int, episodes: int, seed: int) -> MeanReturn:
    """POMCP on Tiger; the optimum is 19.37."""
    return mean_return(discounted_returns(tiger(), simulations=simulations, episodes=episodes, seed=seed))


def rocksample_return(
    size: int, rocks: int, simulations: int, episodes: int, seed: int, *, prefers: bool = True
) -> MeanReturn:
    """POMCP on RockSample[size, rocks], with preferred actions in its rollouts unless not wanted.

    Silver and Veness (2010, table 1) report 20.71 +- 0.21 on [7, 8] and 20.01 +- 0.23 on [11, 11].
    """
    known = rocksample(size, rocks, prefers=prefers, seed=seed)
    return mean_return(discounted_returns(known, simulations=simulations, episodes=episodes, seed=seed))


def mean_return(returns: Float64) -> MeanReturn:
    """Sums up the returns of at least two episodes (float64 [e])."""
    return MeanReturn(
        mean=float(returns.mean()),
        standard_error=float(returns.std(ddof=1)) / math.sqrt(len(returns)),
        episodes=len(returns),
    )


def discounted_returns(
    known: KnownProblem, *, simulations: int, episodes: int, seed: int, negligible: float = NEGLIGIBLE
) -> Float64:
    """float64 [episodes]: the discounted return of each, up to where the discount is `negligible`."""
    steps = math.ceil(math.log(negligible) / math.log(known.discount))
    parameters = PomcpParameters(
        simulations=simulations,
        time_budget_s=NO_TIME_LIMIT_S,
        exploration=known.spread,
        discount=known.discount,
        max_depth=steps,
    )
    rngs = np.random.default_rng(seed).spawn(episodes)
    return np.array([_episode(known, parameters, steps, rng) for rng in rngs])


def _episode(known: KnownProblem, parameters: PomcpParameters, steps: int, rng: np.random.Generator) -> float:
    world = stream_from(rng)
    state = known.first_states(1, rng)[0]
    particles = known.first_states(max(parameters.simulations, FEWEST_PARTICLES), rng)
    total, weight = 0.0, 1.0
    for _ in range(steps):
        action = plan(known.problem, known.model, particles, parameters, rng).action
        observation, reward, ended = _take(known.model, state, action, world)
        total += weight * reward
        weight *= known.discount
        if ended:
            break
        particles = updated_particles(
            known.problem, known.model, particles, action=action, observation=observation, rng=rng
        ).particles
    return total


@compiled_into_callers
def _take(model: Any, state: State, action: int, rng: Stream) -> tuple[int, float, bool]:
    """`step`, for Python to call."""
    return step(model, state, action, rng)
