"""Figures that were worked out by hand, and the properties that a figure must have."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.instruction.metrics import (
    atd,
    auc,
    auc_of_draws,
    drawn_groups,
    expected_calibration_error,
    interval_of,
    mean_of_draws,
    temperature,
    token_distance,
    with_temperature,
)


def test_auc_counts_ties_half() -> None:
    labels = np.array([0.0, 0.0, 1.0, 1.0])
    assert auc(np.array([0.1, 0.5, 0.5, 0.9]), labels) == pytest.approx(3.5 / 4)
    assert auc(np.zeros(4), labels) == 0.5
    assert auc(np.zeros(4), np.ones(4)) is None
    assert auc(np.zeros(0), np.zeros(0)) is None


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.booleans()), min_size=2, max_size=30))
def test_auc_of_the_opposite_score(rows: list[tuple[float, bool]]) -> None:
    scores = np.array([score for score, _ in rows])
    labels = np.array([float(label) for _, label in rows])
    one, other = auc(scores, labels), auc(-scores, labels)
    assert (one is None) == (other is None)
    assert one is None or other is None or one + other == pytest.approx(1.0)


def test_token_distance_pairs_in_order() -> None:
    assert token_distance([3, 10], [11, 3]) == 0.5
    with pytest.raises(BadParameterError, match="one for each"):
        token_distance([3], [])


def test_atd_is_a_mean_over_episodes() -> None:
    assert atd([1.0, 3.0]) == 2.0
    assert atd([]) is None


def test_a_draw_of_homes_has_the_figures_of_the_episodes_it_repeats() -> None:
    """As often as a home is drawn its episodes count, ties and clean episodes (NaN) included."""
    rng = np.random.default_rng(1)
    scores, labels = rng.integers(0, 6, 40) / 5.0, (rng.uniform(size=40) < 0.5).astype(float)
    distances = np.where(labels > 0.5, rng.integers(0, 9, 40), np.nan)
    group = rng.integers(0, 5, 40)
    draws = drawn_groups(5)[:30]
    aucs, atds = auc_of_draws(scores, labels, group, draws), mean_of_draws(distances, group, draws)
    for draw, found_auc, found_atd in zip(draws, aucs, atds, strict=True):
        rows = np.repeat(np.arange(40), draw[group].astype(int))
        assert found_auc == pytest.approx(auc(scores[rows], labels[rows]))
        assert found_atd == pytest.approx(np.nanmean(distances[rows]))


def test_draws_without_a_figure_are_left_out() -> None:
    nothing = np.array([0])
    assert np.isnan(auc_of_draws(np.ones(1), np.ones(1), nothing, np.ones((1, 1)))).all()
    assert np.isnan(mean_of_draws(np.full(1, np.nan), nothing, np.ones((1, 1)))).all()
    assert interval_of(np.array([np.nan, 1.0, 1.0])) == (1.0, 1.0)
    assert interval_of(np.full(3, np.nan)) is None


def test_the_same_seed_draws_the_same_homes_and_as_many() -> None:
    draws = drawn_groups(7, seed=3)
    assert (draws.sum(axis=1) == 7).all()
    assert (draws == drawn_groups(7, seed=3)).all()
    assert (draws != drawn_groups(7, seed=4)).any()


def test_temperature_mends_overconfidence() -> None:
    rng = np.random.default_rng(2)
    true = rng.uniform(0.05, 0.95, 4000)
    labels = (rng.uniform(size=4000) < true).astype(float)
    overconfident = with_temperature(true, 1.0 / 3.0)
    t = temperature(overconfident, labels)
    assert t == pytest.approx(3.0, rel=0.15)
    mended = with_temperature(overconfident, t)
    assert (
        expected_calibration_error(mended, labels) < 0.03 < expected_calibration_error(overconfident, labels)
    )
    assert temperature(overconfident, np.ones(4000)) == 1.0
