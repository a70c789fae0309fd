"""The belief between two real steps of any `Problem`: particles by rejection (Silver and Veness 2010).

The search for an object does not need it: there, the belief node says what is believed (see `particles`).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from robustnav_msgs_py.errors import RobustnavError
from robustnav_nodes.planner.problem import Particles, Problem, begin, reinvigorate, step
from robustnav_nodes.planner.random_stream import Stream, below, stream_from
from robustnav_nodes.search_space.compiled import compiled_into_callers


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ParticleUpdate:
    """The particles after a step, and how many of them are samples of the belief, not copies of such.

    particles: int64 [count, state_size], whole states. matched: 0 where the observation contradicts every
    particle that was tried; then it was ignored.
    """

    particles: Particles
    matched: int


def updated_particles(
    problem: Problem,
    model: Any,
    particles: Particles,
    *,
    action: int,
    observation: int,
    rng: np.random.Generator,
    count: int | None = None,
    attempts: int = 100,
) -> ParticleUpdate:
    """The belief after `action` was taken, `observation` made, and the problem did not end.

    particles: int64 [p] or [p, w], the belief before, as for `plan`, in a problem whose `begin` makes the
    default of them: a particle is a whole state. Draws a particle, takes the action, and keeps the state
    where the same observation was made, until there are `count` (default: p) of them, or `attempts` times
    `count` were tried; then copies of those kept make up the number. `reinvigorate` changes each. Raises
    RobustnavError where there are no particles.
    """
    if len(particles) == 0:
        raise RobustnavError("there are no particles to update: a belief needs at least one")
    count = len(particles) if count is None else count
    kept = np.zeros((count, problem.state_size), dtype=np.int64)
    before = np.ascontiguousarray(particles, dtype=np.int64)
    matched = _update(model, before, action, observation, attempts * count, kept, stream_from(rng))
    return ParticleUpdate(particles=kept, matched=int(matched))


@compiled_into_callers
def _update(
    model: Any,
    particles: Particles,
    action: int,
    observation: int,
    attempts: int,
    kept: Particles,
    rng: Stream,
) -> int:
    """Fill `kept` (int64 [count, state_size]); return how many states made the observation."""
    matched = 0
    for _ in range(attempts):
        if matched == len(kept):
            break
        begin(model, particles[below(rng, len(particles))], 0, kept[matched])
        made, _, ended = step(model, kept[matched], action, rng)
        if made == observation and not ended:
            matched += 1
    for index in range(matched, len(kept)):
        if matched > 0:
            kept[index] = kept[below(rng, matched)]
        else:
            begin(model, particles[below(rng, len(particles))], 0, kept[index])
            step(model, kept[index], action, rng)
    for index in range(len(kept)):
        reinvigorate(model, kept[index], rng)
    return matched
