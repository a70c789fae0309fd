"""Which viewpoint each mention speaks of: people tell a way in its order, so a hidden Markov model knows.

The hidden state is the viewpoint; it moves on with the words. `LOG_BACK` leaves a little for people who name
something before they say how to get there.
"""

import math

import numpy as np
from numba import njit

from robustnav_msgs_py.values import Float64

_WIDTH = 0.22  # of the distribution of (viewpoint / last) around where it is to be expected
_STEP_WIDTH = 0.20  # the same of the distance between two mentions
_LOG_BACK = -2.5  # going back one viewpoint
_NEVER = -30.0


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def place_mentions(log_evidence: Float64, expected_at: Float64) -> tuple[Float64, Float64]:
    """Posterior over viewpoints of each mention: (all evidence, that of the other mentions only).

    `log_evidence` float64 [M, T]: how well each mention fits each viewpoint; `expected_at` float64 [M] in
    0..1, ascending: how far along the way it is to be expected by its place in the text. Both answers
    float64 [M, T]; rows sum to one.
    """
    mentions, places = log_evidence.shape
    with_own = np.zeros((mentions, places))
    without_own = np.zeros((mentions, places))
    if mentions == 0:
        return with_own, without_own
    last = max(1, places - 1)
    prior = np.zeros((mentions, places))
    for m in range(mentions):
        for t in range(places):
            off = (t / last - expected_at[m]) / _WIDTH
            prior[m, t] = -0.5 * off * off
    forward = np.zeros((mentions, places))  # what came before says, own prior and evidence left out
    backward = np.zeros((mentions, places))
    for m in range(1, mentions):
        for t in range(places):
            forward[m, t] = _reach(forward, prior, log_evidence, expected_at, m - 1, m, t, last, True)
    for m in range(mentions - 2, -1, -1):
        for t in range(places):
            backward[m, t] = _reach(backward, prior, log_evidence, expected_at, m + 1, m, t, last, False)
    for m in range(mentions):
        others = forward[m] + backward[m] + prior[m]
        without_own[m] = _shares(others)
        with_own[m] = _shares(others + log_evidence[m])
    return with_own, without_own


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _reach(
    message: Float64,
    prior: Float64,
    evidence: Float64,
    expected_at: Float64,
    other: int,
    own: int,
    t: int,
    last: int,
    ahead: bool,
) -> float:
    gap = abs(expected_at[own] - expected_at[other])
    best = -math.inf
    total = 0.0
    for s in range(evidence.shape[1]):
        step = (t - s) if ahead else (s - t)
        if step < -1:
            move = _NEVER
        else:
            off = (step / last - gap) / _STEP_WIDTH
            move = -0.5 * off * off + (_LOG_BACK if step < 0 else 0.0)
        value = message[other, s] + prior[other, s] + evidence[other, s] + move
        if value > best:
            total = total * math.exp(best - value) + 1.0 if best > -math.inf else 1.0
            best = value
        else:
            total += math.exp(value - best)
    return best + math.log(total)


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _shares(logs: Float64) -> Float64:
    weights = np.exp(logs - logs.max())
    shares: Float64 = weights / weights.sum()
    return shares
