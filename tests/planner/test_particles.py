import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_nodes.planner.particles import BelievedCandidates, CandidatesNotRuledOut, ParticleFilter
from robustnav_nodes.planner.pomcp import Plan
from robustnav_nodes.search_space.candidates import Candidates

K = 8
NOBODY = np.zeros(K, dtype=bool)
UNIFORM = np.full(K, 1 / K)


def only(*members: int) -> np.ndarray:
    return np.isin(np.arange(K), members)


def test_c6_what_was_in_view_of_a_silent_detector_leaves_pp():
    source = CandidatesNotRuledOut(~NOBODY)
    source.looked(only(0, 1, 2), NOBODY, UNIFORM)
    assert source.not_ruled_out.tolist() == (~only(0, 1, 2)).tolist()


def test_c6_what_was_detected_stays_in_pp():
    """The released code drops whatever was in view, also where the detector fired."""
    source = CandidatesNotRuledOut(~NOBODY)
    source.looked(only(0, 1, 2), only(1), UNIFORM)
    assert source.not_ruled_out[1]
    assert not source.not_ruled_out[[0, 2]].any()


def test_what_is_detected_later_comes_back_into_pp():
    source = CandidatesNotRuledOut(~NOBODY)
    source.looked(only(0, 1), NOBODY, UNIFORM)
    source.looked(only(1, 2), only(1), UNIFORM)
    assert source.not_ruled_out[1]


@given(views=st.lists(st.integers(0, 2**K - 2), max_size=6), seed=st.integers(0, 1000))
def test_c7_particles_come_from_pp(views, seed):
    """Uniformly, not from "H without pp" as the text has it."""
    source = CandidatesNotRuledOut(~NOBODY)
    for view in views:
        source.looked(np.array([bool(view >> j & 1) for j in range(K)]), NOBODY, UNIFORM)
    particles = source.draw(500, np.random.default_rng(seed))
    assert particles.shape == (500,)
    assert set(particles.tolist()) <= set(np.nonzero(source.not_ruled_out)[0].tolist())


def test_c7_particles_are_uniform_whatever_is_believed():
    source = CandidatesNotRuledOut(~NOBODY)
    believed = np.array([0.93] + [0.01] * 7)
    source.looked(only(7), NOBODY, believed)
    count = np.bincount(source.draw(70_000, np.random.default_rng(0)), minlength=K)
    assert count[7] == 0
    np.testing.assert_allclose(count[:7], 10_000, rtol=0.05)


def test_c8_an_empty_pp_is_refilled_and_then_follows_the_belief():
    can_be_seen = ~only(7)
    source = CandidatesNotRuledOut(can_be_seen)
    believed = np.array([0.4, 0.1, 0.1, 0.1, 0.1, 0.05, 0.05, 0.1])
    source.looked(only(0, 1, 2, 3), NOBODY, believed)
    source.looked(only(4, 5, 6), NOBODY, believed)
    assert source.tours == 2
    assert source.not_ruled_out.tolist() == can_be_seen.tolist()
    share = np.bincount(source.draw(90_000, np.random.default_rng(0)), minlength=K) / 90_000
    np.testing.assert_allclose(share[:7], believed[:7] / 0.9, atol=0.01)
    assert share[7] == 0.0


def test_what_no_pose_sees_is_never_looked_for():
    source = CandidatesNotRuledOut(only(2, 3))
    assert set(source.draw(100, np.random.default_rng(0)).tolist()) == {2, 3}


def test_believed_candidates_follow_the_belief_also_where_the_detector_was_silent():
    """What no pose sees is left out; what was looked at without success is not."""
    source = BelievedCandidates(~only(7))
    believed = np.array([0.4, 0.1, 0.1, 0.1, 0.1, 0.05, 0.05, 0.1])
    source.looked(only(0, 1, 2), NOBODY, believed)
    share = np.bincount(source.draw(90_000, np.random.default_rng(0)), minlength=K) / 90_000
    np.testing.assert_allclose(share[:7], believed[:7] / 0.9, atol=0.01)
    assert share[7] == 0.0


def test_believed_candidates_begin_alike():
    share = np.bincount(BelievedCandidates(~NOBODY).draw(80_000, np.random.default_rng(0)), minlength=K)
    np.testing.assert_allclose(share, 10_000, rtol=0.05)


def a_plan(first_action: list[int], first_observation: list[int]) -> Plan:
    count = len(first_action)
    return Plan(
        action=0,
        values=np.zeros(4),
        visits=np.zeros(4, dtype=np.int32),
        nodes=1,
        first_action=np.array(first_action, dtype=np.int32),
        first_observation=np.array(first_observation, dtype=np.int32),
        simulations=count,
        elapsed_ms=0.0,
        steps=0,
    )


IN_A_ROW = Candidates(x_m=np.arange(K) * 0.3, y_m=np.zeros(K), size_m=0.3)


def test_plain_pomcp_keeps_what_went_through_the_action_unseen():
    source = ParticleFilter(IN_A_ROW, radius_m=0.0)
    source.decided(a_plan([0, 0, 1, 0], [0, 1, 0, 0]), np.array([2, 3, 4, 5]))
    source.looked(only(5), NOBODY, UNIFORM)
    assert set(source.draw(64, np.random.default_rng(0)).tolist()) == {2}


def test_plain_pomcp_tops_up_near_the_survivors_and_out_of_view():
    source = ParticleFilter(IN_A_ROW, radius_m=0.35)
    source.decided(a_plan([0], [0]), np.array([3]))
    source.looked(only(4), NOBODY, UNIFORM)
    assert set(source.draw(200, np.random.default_rng(0)).tolist()) == {2, 3}


@pytest.mark.parametrize("in_view", [only(0, 1, 2), ~NOBODY, NOBODY])
def test_plain_pomcp_without_survivors_starts_anew(in_view):
    source = ParticleFilter(IN_A_ROW, radius_m=0.3)
    source.decided(a_plan([1, 1], [0, 0]), np.array([0, 1]))
    source.looked(in_view, NOBODY, UNIFORM)
    expected = np.nonzero(~in_view)[0] if not in_view.all() else np.arange(K)
    assert set(source.draw(400, np.random.default_rng(0)).tolist()) == set(expected.tolist())
