"""How well errors are detected, localised and calibrated: AUC, ATD (thesis eq. 4.1), ECE, temperature."""

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import rankdata

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Float64

Interval = tuple[float, float]
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


def group_interval(
    groups: Sequence[str],
    figure: Callable[[np.ndarray[tuple[int], np.dtype[np.int64]]], float | None],
    seed: int = 0,
) -> Interval | None:
    """95 % interval of `figure(rows)` over groups (homes) drawn again: episodes of one home are alike.

    `figure` is given the row numbers of a resample, and may answer None, which is left out.
    """
    names = sorted(set(groups))
    rows = {name: np.flatnonzero([group == name for group in groups]) for name in names}
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(RESAMPLES if len(names) > 1 else 0):
        drawn = np.concatenate([rows[names[k]] for k in rng.integers(len(names), size=len(names))])
        value = figure(drawn)
        if value is not None:
            found.append(value)
    if not found:
        return None
    low, high = np.percentile(found, _PERCENTILES)
    return float(low), float(high)


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
