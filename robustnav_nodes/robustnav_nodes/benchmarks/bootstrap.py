"""95 % intervals by the percentile bootstrap (Efron 1979) over episodes."""

import numpy as np

from robustnav_msgs_py.values import Float64

RESAMPLES = 10_000
SEED = 0
_PERCENTILES = (2.5, 97.5)
_DRAWS_AT_ONCE = 2_000_000

Interval = tuple[float, float]


def resampled_means(values: Float64) -> Float64:
    """float64 [RESAMPLES, m]: column means of `values` (float64 [e, m]) over e episodes drawn again.

    All columns are drawn together: what stands in one row stays paired. Always the same for the same e.
    """
    episodes = len(values)
    rng = np.random.default_rng([SEED, episodes])
    rows = max(1, _DRAWS_AT_ONCE // (episodes * values.shape[1]))
    return np.concatenate(
        [
            values[rng.integers(episodes, size=(min(rows, RESAMPLES - done), episodes))].mean(axis=1)
            for done in range(0, RESAMPLES, rows)
        ]
    )


def mean_intervals(values: Float64) -> list[Interval]:
    """Of the mean of each column of `values` (float64 [e, m], at least one episode)."""
    return [_interval(column) for column in resampled_means(values).T]


def difference_interval(values: Float64, others: Float64) -> Interval:
    """Of mean(values) - mean(others), float64 [e] each, of the same episodes in the same order."""
    return mean_intervals((values - others)[:, np.newaxis])[0]


def ratio_interval(values: Float64, others: Float64) -> Interval:
    """Of mean(values) / mean(others), not negative, of the same episodes; +Inf where the latter may be 0."""
    mean, other = resampled_means(np.stack([values, others], axis=1)).T
    ratio = np.full(len(mean), np.inf)
    np.divide(mean, other, out=ratio, where=other > 0.0)
    # no interpolation: half way to infinity is no number
    low, high = np.percentile(ratio, _PERCENTILES, method="nearest")
    return float(low), float(high)


def _interval(means: Float64) -> Interval:
    low, high = np.percentile(means, _PERCENTILES)
    return float(low), float(high)
