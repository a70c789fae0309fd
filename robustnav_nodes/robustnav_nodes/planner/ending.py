"""When a search may end: what must be seen, or believed, for the target to count as found."""

from typing import Protocol

import numpy as np

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.policy import Sight
from robustnav_nodes.search_space.candidates import Candidates

_AROUND_M = 1.0  # one target's detections lie this near to each other

_OF_VARIANT = {
    "random": "location",
    "greedy": "location",
    "pomp": "detection",
    "pomp_be": "detection",
    "pomp_pd": "location",
    "pomp_be_pd": "location",
}


class Ending(Protocol):
    """Says where the target is found, if it is.

    threshold: the probability that is enough; may_change: whether a later look can say otherwise.
    """

    threshold: float
    may_change: bool

    def looked(self, sight: Sight) -> None:
        """A look counted."""

    def found(self, sight: Sight) -> int | None:
        """The candidate at which the search may end with this look; None: go on."""

    def p_in_view(self, sight: Sight) -> float:
        """The probability in view that is held against the threshold."""


class FirstDetection:
    """POMP: the first detection ends the search, at the likeliest place that it raised."""

    threshold = 0.0
    may_change = False

    def looked(self, sight: Sight) -> None:
        """See Ending."""

    def found(self, sight: Sight) -> int | None:
        """See Ending."""
        risen = sight.in_view & sight.rose
        if not sight.is_new or not risen.any():
            return None
        return int(np.argmax(np.where(risen, sight.probability, -1.0)))

    def p_in_view(self, sight: Sight) -> float:
        """See Ending: that of the likeliest location in view."""
        return _best_in_view(sight)


class LikelyLocation:
    """PD: a location in view is as likely as tau (thesis eq. 3.2).

    `views` > 1 asks besides that its probability has risen in that many looks: a second viewpoint before
    commitment.
    """

    may_change = True

    def __init__(self, candidates: int, tau: float, views: int = 1) -> None:
        self.threshold = tau
        self._views = views
        self._risen = np.zeros(candidates, dtype=np.int64)

    def looked(self, sight: Sight) -> None:
        """See Ending."""
        self._risen += sight.rose

    def found(self, sight: Sight) -> int | None:
        """See Ending."""
        seen_enough = sight.in_view & (self._risen >= self._views) if self._views > 1 else sight.in_view
        if not seen_enough.any():
            return None
        best = int(np.argmax(np.where(seen_enough, sight.probability, -1.0)))
        return best if sight.probability[best] >= self.threshold else None

    def p_in_view(self, sight: Sight) -> float:
        """See Ending: that of the likeliest location in view."""
        return _best_in_view(sight)


class LikelyView:
    """The target is in view with probability `p_found`, wherever in it, and something in view was detected.

    Detections are placed within half a metre or so, which spreads even a sure find over dozens of locations:
    their sum is a probability that a threshold can be set against, whatever the number of candidates.

    R takes it for certain that the target is at a candidate, so what is left when all else was looked at, or
    a view that holds them all, is as likely as a find. Nothing that never rose in view is found; only R over
    a single candidate, which cannot rise, needs nothing more than the view.
    """

    may_change = True

    def __init__(self, candidates: Candidates, p_found: float) -> None:
        self.threshold = p_found
        self._candidates = candidates
        self._risen: Bool = np.full(len(candidates), len(candidates) == 1)

    def looked(self, sight: Sight) -> None:
        """See Ending."""
        self._risen |= sight.rose

    def found(self, sight: Sight) -> int | None:
        """See Ending."""
        if self.p_in_view(sight) < self.threshold or not (sight.in_view & self._risen).any():
            return None
        return self._middle(np.where(sight.in_view, sight.probability, 0.0))

    def _middle(self, probability: Float64) -> int:
        """The candidate nearest to the mean of what lies around the likeliest one.

        Of many that are nearly as likely, the likeliest is a matter of luck; the mean errs least.
        """
        x_m, y_m = self._candidates.x_m, self._candidates.y_m
        best = int(np.argmax(probability))
        around = np.hypot(x_m - x_m[best], y_m - y_m[best]) <= _AROUND_M
        weight = np.where(around, probability, 0.0)
        mean_x_m, mean_y_m = np.average(x_m, weights=weight), np.average(y_m, weights=weight)
        off_m = np.where(weight > 0.0, np.hypot(x_m - mean_x_m, y_m - mean_y_m), np.inf)
        return int(np.argmin(off_m))

    def p_in_view(self, sight: Sight) -> float:
        """See Ending: that the target is anywhere in view."""
        return float(sight.probability[sight.in_view].sum())


def _best_in_view(sight: Sight) -> float:
    return float(sight.probability[sight.in_view].max(initial=0.0))


def exit_threshold(candidates: int, confidence: float, tau_max: float) -> float:
    """tau = confidence / k, at most `tau_max` (C5: with k <= confidence it would be 1 or more: no end).

    Where that is no more than the 1/k of a belief that knows nothing (two candidates), half way from there
    to certainty.
    """
    tau = min(confidence / candidates, tau_max)
    nothing_known = 1.0 / candidates
    return tau if tau > nothing_known else 0.5 * (nothing_known + 1.0)


def ending_of(parameters: PlannerParameters, candidates: Candidates) -> Ending:
    """The ending that `parameters` ask for."""
    kind = (
        _OF_VARIANT.get(parameters.variant, "view") if parameters.ending == "variant" else parameters.ending
    )
    if kind == "detection":
        return FirstDetection()
    if kind == "location":
        count = len(candidates)
        tau = exit_threshold(count, parameters.confidence, parameters.tau_max)
        return LikelyLocation(count, tau, parameters.views_to_commit)
    return LikelyView(candidates, parameters.p_found)
