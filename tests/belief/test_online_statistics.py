"""What is believed of the detector follows what it does, and never becomes certain."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.belief.observation import place_densities
from robustnav_nodes.belief.online_statistics import CountedLook, OnlineStatistics

SIGMA_M = 0.5
WRONG = ClassStatistics(precision=0.5, recall=0.9)
rates = st.floats(0.0, 1.0)


@pytest.fixture
def look_at(in_a_row):
    """look_at(in_view, *fired_m): five candidates 3 m apart, of which two detections never fit the same."""
    candidates = in_a_row(5, spacing_m=3.0)

    def make(in_view, *fired_m: float) -> CountedLook:
        seen = np.isin(np.arange(5), list(in_view))
        places = np.array([(x_m, 0.0) for x_m in fired_m]).reshape(-1, 2)
        return CountedLook(in_view=seen, densities=place_densities(candidates, seen, places, SIGMA_M))

    return make


def counts(online: OnlineStatistics, before: OnlineStatistics) -> tuple[float, ...]:
    names = ("detected", "missed", "true_firings", "false_firings")
    return tuple(round(getattr(online, name) - getattr(before, name), 9) for name in names)


def test_by_hand(look_at):
    """In view and detected 0.4 m off; missed; detected and a false alarm; out of view and a false alarm."""
    before = OnlineStatistics.starting_from(WRONG)
    looks = [look_at([0, 1], 3.4), look_at([1, 2]), look_at([0, 1], 3.0, 0.0), look_at([4], 12.0)]
    assert counts(before.confirmed(looks, 1), before) == (2, 1, 2, 2)


def test_two_detections_of_the_target_in_one_look_are_one_true_firing(look_at):
    before = OnlineStatistics.starting_from(WRONG)
    assert counts(before.confirmed([look_at([1], 3.0, 3.1)], 1), before) == (1, 0, 1, 1)


def test_a_refuted_find_says_only_that_what_fired_there_was_false(look_at):
    before = OnlineStatistics.starting_from(WRONG)
    looks = [look_at([0, 1], 3.0), look_at([1]), look_at([0], 0.0)]
    assert counts(before.refuted(looks, 1), before) == (0, 0, 0, 1)


def test_nothing_seen_nothing_learnt():
    before = OnlineStatistics.starting_from(WRONG)
    assert before.confirmed([], 0) == before.refuted([], 0) == before
    assert before.statistics.recall == pytest.approx(WRONG.recall)
    assert before.statistics.precision == pytest.approx(WRONG.precision)


@given(recall=st.floats(0.05, 0.95), precision=st.floats(0.3, 0.95), seed=st.integers(0, 2**16))
@settings(max_examples=25)
def test_it_converges_to_the_true_rates(recall, precision, seed):
    """Every look has the target in view; false alarms come at the rate that gives the precision."""
    rng = np.random.default_rng(seed)
    both, other, none = np.array([[1.0, 0.0]]), np.array([[0.0, 1.0]]), np.zeros((0, 2))
    p_false = min(1.0, recall * (1.0 - precision) / precision)
    precision = recall / (recall + p_false)
    looks = [
        CountedLook(
            in_view=np.ones(2, dtype=np.bool_),
            densities=np.concatenate(
                [both if rng.random() < recall else none, other if rng.random() < p_false else none]
            ),
        )
        for _ in range(4000)
    ]
    found = OnlineStatistics.starting_from(WRONG).confirmed(looks, 0).statistics
    assert found.recall == pytest.approx(recall, abs=0.05)
    assert found.precision == pytest.approx(precision, abs=0.13 if recall < 0.2 else 0.08)


@given(
    precision=rates,
    recall=rates,
    pseudo_count=st.floats(0.1, 100.0),
    looks=st.lists(st.tuples(st.booleans(), st.booleans(), st.booleans()), min_size=1, max_size=20),
)
def test_the_posterior_mean_lies_between_prior_and_data_and_is_never_certain(
    precision, recall, pseudo_count, looks
):
    """Looks as (target in view, fired at it, fired elsewhere)."""
    before = OnlineStatistics.starting_from(ClassStatistics(precision=precision, recall=recall), pseudo_count)
    after = before.confirmed([look_of(*look) for look in looks], 0)
    in_view = sum(seen for seen, _, _ in looks)
    true = sum(seen and fired for seen, fired, _ in looks)
    false = sum(elsewhere for _, _, elsewhere in looks)
    between(after.statistics.recall, before.statistics.recall, true, in_view)
    between(after.statistics.precision, before.statistics.precision, true, true + false)


def look_of(seen: bool, fired: bool, elsewhere: bool) -> CountedLook:
    rows = [[1.0, 0.0]] * (seen and fired) + [[0.0, 1.0]] * elsewhere
    return CountedLook(in_view=np.array([seen, True]), densities=np.array(rows).reshape(-1, 2))


def between(after: float, before: float, hits: int, tries: int) -> None:
    observed = hits / tries if tries else before
    low, high = min(before, observed), max(before, observed)
    assert low - 1e-12 <= after <= high + 1e-12
    assert 0.0 < after < 1.0


@pytest.mark.parametrize("pseudo_count", [0.0, -1.0, float("nan")])
def test_a_prior_must_be_worth_something(pseudo_count):
    with pytest.raises(BadParameterError, match="pseudo-count"):
        OnlineStatistics.starting_from(WRONG, pseudo_count)
