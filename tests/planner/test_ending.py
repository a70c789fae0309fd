import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_nodes.planner.exit_condition import exit_threshold, most_likely_in_view


def test_c1_tau_counts_candidates():
    assert exit_threshold(400, confidence=10.0, tau_max=0.5) == pytest.approx(10 / 400)


@given(candidates=st.integers(3, 5000), confidence=st.floats(1.1, 1e4))
def test_c5_tau_can_always_be_reached(candidates, confidence):
    """With k <= c the thesis' tau is 1 or more, and a search would never end."""
    assert 1.0 / candidates < exit_threshold(candidates, confidence, tau_max=0.5) <= 0.5


@given(candidates=st.integers(2, 50), tau_max=st.floats(0.01, 0.999))
def test_c5_knowing_nothing_never_ends_a_search(candidates, tau_max):
    """With two candidates the clamp at 0.5 would be reached before the first look."""
    assert 1.0 / candidates < exit_threshold(candidates, 10.0, tau_max) < 1.0


def test_a_single_candidate_need_only_be_in_view():
    assert exit_threshold(1, 10.0, 0.5) <= 1.0


def test_only_what_is_in_view_counts():
    probability = np.array([0.6, 0.1, 0.3])
    assert most_likely_in_view(probability, np.array([False, True, True])) == (2, 0.3)
    assert most_likely_in_view(probability, np.zeros(3, dtype=bool)) is None
