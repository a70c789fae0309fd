"""When a search may end: a location in view is likely enough (thesis eq. 3.2)."""

import numpy as np

from robustnav_msgs_py.values import Bool, Float64


def exit_threshold(candidates: int, confidence: float, tau_max: float) -> float:
    """tau = confidence / k, at most `tau_max` (C5: with k <= confidence it would be 1 or more: no end).

    Where that is no more than the 1/k of a belief that knows nothing (two candidates), half way from there
    to certainty.
    """
    tau = min(confidence / candidates, tau_max)
    nothing_known = 1.0 / candidates
    return tau if tau > nothing_known else 0.5 * (nothing_known + 1.0)


def most_likely_in_view(probability: Float64, in_view: Bool) -> tuple[int, float] | None:
    """The most likely location in view and its probability; None where nothing is in view."""
    if not in_view.any():
        return None
    best = int(np.argmax(np.where(in_view, probability, -1.0)))
    return best, float(probability[best])
