import numpy as np
import pytest

from robustnav_nodes.benchmarks.bootstrap import (
    RESAMPLES,
    difference_interval,
    mean_intervals,
    ratio_interval,
    resampled_means,
)


def test_an_interval_is_as_wide_as_theory_says():
    """Of a normal sample's mean: 1.96 standard errors to each side."""
    values = np.random.default_rng(1).normal(3.0, 2.0, size=(400, 1))
    (low, high), error = mean_intervals(values)[0], values.std() / 20.0
    np.testing.assert_allclose(
        [low, high], values.mean() + 1.96 * error * np.array([-1, 1]), atol=0.08 * error
    )


def test_an_interval_covers_the_truth_about_as_often_as_it_says():
    rng = np.random.default_rng(2)
    samples = (rng.random((60, 300)) < 0.3).astype(float)
    intervals = [mean_intervals(samples[:, start : start + 1])[0] for start in range(0, 300, 3)]
    assert 88 <= sum(low <= 0.3 <= high for low, high in intervals) <= 100


def test_what_never_differs_has_no_width_and_one_episode_is_enough():
    assert mean_intervals(np.ones((50, 2))) == [(1.0, 1.0), (1.0, 1.0)]
    assert mean_intervals(np.array([[0.25]])) == [(0.25, 0.25)]


def test_rows_stay_paired():
    """Two planners that differ by 0.1 in each episode differ by that in each resample."""
    values = np.random.default_rng(3).random(80)
    low, high = difference_interval(values + 0.1, values)
    assert low == pytest.approx(0.1)
    assert high == pytest.approx(0.1)
    assert ratio_interval(2.0 * values, values) == pytest.approx((2.0, 2.0))
    means = resampled_means(np.stack([values, values], axis=1))
    np.testing.assert_array_equal(means[:, 0], means[:, 1])
    assert len(means) == RESAMPLES


def test_a_ratio_over_what_may_be_nothing_has_no_upper_bound():
    success = np.array([1.0, 1.0, 1.0, 1.0])
    assert ratio_interval(success, np.array([1.0, 0.0, 0.0, 0.0])) == (4.0 / 3.0, np.inf)
    assert ratio_interval(success, np.zeros(4)) == (np.inf, np.inf)


def test_it_is_the_same_every_time():
    values = np.random.default_rng(4).random((37, 2))
    np.testing.assert_array_equal(resampled_means(values), resampled_means(values))
