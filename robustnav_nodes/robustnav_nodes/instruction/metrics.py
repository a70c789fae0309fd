"""How well errors are detected, localised and calibrated: AUC, ATD (thesis eq. 4.1), ECE, temperature."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar
from scipy.stats import rankdata

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Float64

Interval = tuple[float, float]
Int64 = NDArray[np.int64]
RESAMPLES = 1000
_PERCENTILES = (2.5, 97.5)
_SURE = 1e-6  # probabilities are kept this far from 0 and 1


def auc(scores: Float64, labels: Float64) -> float | None:
    """Area under the ROC curve: P(score of a wrong one > that of a right one), ties counting half.

    Both float64 [n], labels 0 or 1. None where one of the two classes is missing.
    """
    positive = labels > 0.5
    wrong, right = int(positive.sum()), int((~positive).sum())
    if not wrong or not right:
        return None
    ranks = rankdata(scores)
    return float((ranks[positive].sum() - wrong * (wrong + 1) / 2.0) / (wrong * right))


def token_distance(true: Sequence[int], predicted: Sequence[int]) -> float:
    """Mean distance in tokens of the errors of one episode from their predictions, paired in their order.

    Raises BadParameterError where the two are not equally many, or none.
    """
    if not true or len(true) != len(predicted):
        raise BadParameterError(
            f"{len(predicted)} positions are predicted for {len(true)} errors; there must be one for each"
        )
    return sum(abs(a - b) for a, b in zip(sorted(true), sorted(predicted), strict=True)) / len(true)


def atd(distances: Sequence[float]) -> float | None:
    """Absolute token distance (eq. 4.1): the mean over perturbed episodes; None without any."""
    return float(np.mean(distances)) if len(distances) else None


def drawn_groups(count: int, seed: int = 0) -> Float64:
    """float64 [RESAMPLES, count]: how often each of `count` groups (homes) comes, drawn again.

    Episodes of one home are alike, so that homes are what a bootstrap draws. The same seed, the same draws.
    """
    return (
        np.random.default_rng(seed).multinomial(count, np.full(count, 1.0 / count), RESAMPLES).astype(float)
    )


def auc_of_draws(scores: Float64, labels: Float64, group: Int64, draws: Float64) -> Float64:
    """float64 [draws]: the AUC of each draw of groups; NaN where one of the classes is missing.

    `group` int64 [n] holds the number of each episode's group, a column of `draws`.
    """
    groups = draws.shape[1]
    positive = labels > 0.5
    wrong, right = scores[positive], scores[~positive]
    wrong_in, right_in = group[positive], group[~positive]
    ahead = np.zeros((groups, groups))  # [g, h]: pairs of a wrong one of g above a right one of h
    for h in np.unique(right_in):
        ordered = np.sort(right[right_in == h])
        below = np.searchsorted(ordered, wrong, "left") + np.searchsorted(ordered, wrong, "right")
        ahead[:, h] = np.bincount(wrong_in, weights=below / 2.0, minlength=groups)
    pairs = (draws @ np.bincount(wrong_in, minlength=groups)) * (
        draws @ np.bincount(right_in, minlength=groups)
    )
    return _quotient(((draws @ ahead) * draws).sum(axis=1), pairs)


def mean_of_draws(values: Float64, group: Int64, draws: Float64) -> Float64:
    """float64 [draws]: the mean of the values that are not NaN in each draw of groups; NaN without any."""
    known = ~np.isnan(values)
    groups = draws.shape[1]
    total = draws @ np.bincount(group[known], weights=values[known], minlength=groups)
    return _quotient(total, draws @ np.bincount(group[known], minlength=groups))


def interval_of(figures: Float64) -> Interval | None:
    """The middle 95 % of what resamples gave, NaN left out; None where nothing is left."""
    known = figures[~np.isnan(figures)]
    if not len(known):
        return None
    low, high = np.percentile(known, _PERCENTILES)
    return float(low), float(high)


def _quotient(above: Float64, below: Float64) -> Float64:
    found = np.full(len(above), np.nan)
    np.divide(above, below, out=found, where=below > 0.0)
    return found


def reliability(scores: Float64, labels: Float64, bins: int = 10) -> list[tuple[float, float, int]]:
    """(mean score, share of wrong ones, count) of each of `bins` stretches of 0..1 that is not empty."""
    which = np.minimum((scores * bins).astype(np.int64), bins - 1)
    return [
        (float(scores[which == k].mean()), float(labels[which == k].mean()), int((which == k).sum()))
        for k in range(bins)
        if (which == k).any()
    ]


def expected_calibration_error(scores: Float64, labels: Float64, bins: int = 10) -> float:
    """Mean distance of score and share, weighted by count (Guo et al. 2017); 0 without episodes."""
    if not len(scores):
        return 0.0
    return sum(abs(p - share) * count for p, share, count in reliability(scores, labels, bins)) / len(scores)


def temperature(scores: Float64, labels: Float64) -> float:
    """T that makes sigmoid(logit(score) / T) most likely; 1 where that cannot be told."""
    if not len(scores) or len(set(labels.tolist())) == 1:
        return 1.0
    logits = logit(scores)
    sign = 2.0 * labels - 1.0

    def loss(log_t: float) -> float:
        return float(np.logaddexp(0.0, -sign * logits * np.exp(-log_t)).mean())

    return float(np.exp(minimize_scalar(loss, bounds=(-3.0, 3.0), method="bounded").x))


def with_temperature(scores: Float64, t: float) -> Float64:
    """sigmoid(logit(scores) / t)."""
    return 1.0 / (1.0 + np.exp(-logit(scores) / t))


def logit(p: Float64) -> Float64:
    """log(p / (1 - p)), kept finite."""
    kept = np.clip(p, _SURE, 1.0 - _SURE)
    return np.log(kept / (1.0 - kept))
