"""How much one look says about each candidate location, in the thesis' way and as a likelihood ratio."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from robustnav_msgs_py.detector_statistics import ClassStatistics, RecallByRange
from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.belief.observation import detected_factor, missed_factor, usable_f1
from robustnav_nodes.belief.parameters import BeliefParameters


class Evidence(Protocol):
    """Turns one look into the factor of Bayes' rule."""

    def factor(self, in_view: Bool, densities: Float64, distance_m: Float64 | None = None) -> Float64:
        """float64 [k], not negative; only its ratios matter.

        in_view: bool [k]; densities: float64 [m, k], for each detection how well it fits each candidate in
        view, from 1 at its peak to 0, 0 outside the view, m = 0 where the detector was silent; distance_m:
        float64 [k] from the camera, where known.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class F1Evidence:
    """The thesis' factors (3.2.1.3): F1 for a miss, a normal density for a detection (C2, C3)."""

    f1: float
    detection_floor: float

    def factor(self, in_view: Bool, densities: Float64, distance_m: Float64 | None = None) -> Float64:
        """See Evidence."""
        if len(densities) == 0:
            return missed_factor(in_view, self.f1)
        return detected_factor(in_view, densities, self.detection_floor)


@dataclass(frozen=True, slots=True, kw_only=True)
class LikelihoodEvidence:
    """How much likelier the look is if the target is at j than if it is not: P(look | j) / P(look | not j).

    A target in view is detected with probability r and then reported at a place with the density that the
    detection has at j. False alarms come at a rate of `false_alarms` a look, anywhere in view. Outside the
    view a look says nothing: the ratio is 1. So a false alarm can be outweighed by looking again, and what
    the belief holds is a probability that a threshold can be set against.

    recall: r near the robot; it falls in proportion to the distance, to recall * (1 - recall_loss) at
    range_max_m. Where `recall_by_range` is known, r at each distance is what it says instead.
    """

    recall: float
    false_alarms: float
    recall_loss: float = 0.0
    range_max_m: float = 1.0
    recall_by_range: RecallByRange | None = None

    def factor(self, in_view: Bool, densities: Float64, distance_m: Float64 | None = None) -> Float64:
        """See Evidence."""
        recall = self._recall_at(distance_m) if distance_m is not None else self.recall
        reported = np.zeros(len(in_view))
        if len(densities) > 0:
            total = densities.sum(axis=1, keepdims=True)
            places_in_view = np.count_nonzero(in_view)
            per_false_alarm = np.divide(densities, total, out=np.zeros_like(densities), where=total > 0.0)
            # One that no place in view fits is none of them: without this, the nearest would have it all.
            fit = densities.max(axis=1, keepdims=True)
            reported = (fit * per_false_alarm).sum(axis=0) * places_in_view / self.false_alarms
        return np.where(in_view, 1.0 - recall + recall * reported, 1.0)

    def _recall_at(self, distance_m: Float64) -> Float64:
        if self.recall_by_range is not None:
            return self.recall_by_range.at(distance_m)
        share = np.clip(distance_m / self.range_max_m, 0.0, 1.0)
        return np.asarray(self.recall * (1.0 - self.recall_loss * share), dtype=np.float64)


def false_alarms_a_look(statistics: ClassStatistics, share_in_view: float, least: float) -> float:
    """How often the detector fires at nothing, by its precision.

    share_in_view: part of all looks that have the target in view, for a target that may be anywhere. Of the
    detector's firings the part `precision` is true, and recall * share_in_view of all looks are true
    firings. At least `least`: no detector is perfect for ever.
    """
    if statistics.precision <= 0.0:
        return 1.0
    false_for_each_true = (1.0 - statistics.precision) / statistics.precision
    return min(1.0, max(least, statistics.recall * share_in_view * false_for_each_true))


def evidence_of(
    statistics: ClassStatistics, share_in_view: float, parameters: BeliefParameters
) -> F1Evidence | LikelihoodEvidence:
    """The kind of evidence that `parameters` ask for, for a detector with these statistics."""
    if parameters.evidence == "f1":
        return F1Evidence(
            f1=usable_f1(statistics.f1, parameters.f1_min, parameters.f1_max),
            detection_floor=parameters.detection_floor,
        )
    by_range, limits = statistics.recall_by_range, (parameters.recall_min, parameters.recall_max)
    return LikelihoodEvidence(
        recall=min(max(statistics.recall, parameters.recall_min), parameters.recall_max),
        false_alarms=false_alarms_a_look(statistics, share_in_view, parameters.false_alarms_min),
        recall_loss=parameters.recall_loss,
        range_max_m=parameters.range_max_m,
        recall_by_range=by_range.within(*limits) if by_range is not None else None,
    )
