from typing import NamedTuple

import numpy as np
import pytest

from robustnav_msgs_py.errors import RobustnavError
from robustnav_nodes.benchmarks.pomdp_problems import (
    CHECK,
    EVIDENCE,
    GOOD,
    IS_GOOD,
    LISTEN,
    OPEN_LEFT,
    rocksample,
    tiger,
)
from robustnav_nodes.planner.particle_update import updated_particles
from robustnav_nodes.planner.problem import Problem, implement


def test_hearing_the_tiger_makes_it_likely_by_bayes_rule():
    known, rng = tiger(), np.random.default_rng(0)
    particles = known.first_states(20_000, rng)
    for times in (1, 2, 3):
        update = updated_particles(
            known.problem, known.model, particles, action=LISTEN, observation=1, rng=rng
        )
        particles = update.particles
        assert update.matched == 20_000
        assert particles.mean() == pytest.approx(1.0 / (1.0 + (0.15 / 0.85) ** times), abs=0.01)


def test_opening_a_door_forgets():
    known, rng = tiger(), np.random.default_rng(0)
    sure = np.ones((10_000, 1), dtype=np.int64)
    found = updated_particles(known.problem, known.model, sure, action=OPEN_LEFT, observation=0, rng=rng)
    assert found.particles.mean() == pytest.approx(0.5, abs=0.02)


class CopyModel(NamedTuple):
    """Observes what the state is."""


def _copy_step(model, state, action, rng):
    return state[0], 0.0, state[0] == 3


implement(CopyModel, step=_copy_step)
COPY = Problem(actions=1, observations=4, state_size=1)


def test_the_few_that_match_are_copied():
    particles = np.array([0] * 999 + [1])
    found = updated_particles(
        COPY, CopyModel(), particles, action=0, observation=1, rng=np.random.default_rng(0), attempts=2
    )
    assert 1 <= found.matched < 1000
    assert found.particles.shape == (1000, 1)
    assert np.all(found.particles == 1)


@pytest.mark.parametrize("observation", [2, 3])
def test_an_observation_that_contradicts_all_is_ignored(observation):
    """3 ends the problem; it did not end."""
    particles = np.array([0, 1, 3])
    found = updated_particles(
        COPY,
        CopyModel(),
        particles,
        action=0,
        observation=observation,
        rng=np.random.default_rng(0),
        count=50,
    )
    assert found.matched == 0
    assert set(found.particles[:, 0].tolist()) <= {0, 1, 3}
    assert len(found.particles) == 50


def test_no_particles_are_refused():
    with pytest.raises(RobustnavError, match="no particles"):
        updated_particles(
            COPY, CopyModel(), np.zeros(0), action=0, observation=0, rng=np.random.default_rng(0)
        )


def test_reinvigoration_brings_back_what_the_history_allows():
    """All particles say that rock 0 is good, and one reading that it may be: some turn bad again."""
    known, rng = rocksample(7, 8), np.random.default_rng(0)
    particles = known.first_states(4096, rng)
    particles[:, 1 + IS_GOOD] = 1
    update = updated_particles(
        known.problem, known.model, particles, action=CHECK, observation=GOOD, rng=rng
    ).particles
    p_right = known.model.p_right[particles[0, 0], 0]
    # One of eight rocks is drawn anew in each particle.
    assert 1.0 - update[:, 1 + IS_GOOD].mean() == pytest.approx((1.0 - p_right) / 8.0, abs=0.005)
    assert np.all(update[:, 1 + EVIDENCE] > 0)
