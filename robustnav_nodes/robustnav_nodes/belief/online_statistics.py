"""Learns how good the detector is from searches that were confirmed or refuted: Beta posteriors.

Statistics from a data sheet were measured on other images. Once a person or the gripper confirms where the
target was, each look on the way says what the detector did with it: in view and detected, in view and
missed, or fired at nothing.

Precision is that of the looks of searches, and searches go where the target is: it comes out higher than
over all poses (0.83 for 0.78 in the medium scenes), recall does not.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Bool, Float64

# Of the densities, 1 at the detected place: 2.4 standard deviations, beyond which 5 % of the detections of a
# target lie on the floor.
NEAR = 0.05
_ALMOST_SURE = 0.99  # no statistics are taken to say more: what is never wrong could never learn


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CountedLook:
    """A look that counted: in_view: bool [k]; densities: float64 [m, k], as Evidence takes them."""

    in_view: Bool
    densities: Float64


@dataclass(frozen=True, slots=True, kw_only=True)
class Observed:
    """Counts of what was seen, without any prior."""

    detected: float = 0.0
    missed: float = 0.0
    true_firings: float = 0.0
    false_firings: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class OnlineStatistics:
    """Counts for recall (detected, missed) and precision (true, false firings), the prior's included."""

    detected: float
    missed: float
    true_firings: float
    false_firings: float

    @classmethod
    def starting_from(cls, statistics: ClassStatistics, pseudo_count: float = 5.0) -> "OnlineStatistics":
        """Begin with `statistics`, worth as much as this many looks. Raises BadParameterError unless > 0."""
        if not pseudo_count > 0.0:
            raise BadParameterError(f"the pseudo-count is {pseudo_count!r}; it must be above 0")
        recall = min(max(statistics.recall, 1.0 - _ALMOST_SURE), _ALMOST_SURE)
        precision = min(max(statistics.precision, 1.0 - _ALMOST_SURE), _ALMOST_SURE)
        return cls(
            detected=pseudo_count * recall,
            missed=pseudo_count * (1.0 - recall),
            true_firings=pseudo_count * precision,
            false_firings=pseudo_count * (1.0 - precision),
        )

    def with_observed(self, seen: Observed) -> "OnlineStatistics":
        """The posterior after what was seen, for a prior."""
        return OnlineStatistics(
            detected=self.detected + seen.detected,
            missed=self.missed + seen.missed,
            true_firings=self.true_firings + seen.true_firings,
            false_firings=self.false_firings + seen.false_firings,
        )

    def observed_since(self, prior: "OnlineStatistics") -> Observed:
        """What was seen since `prior`; counts are whole, so rounding takes off what adding floats left."""
        return Observed(
            detected=round(self.detected - prior.detected, 6),
            missed=round(self.missed - prior.missed, 6),
            true_firings=round(self.true_firings - prior.true_firings, 6),
            false_firings=round(self.false_firings - prior.false_firings, 6),
        )

    @property
    def statistics(self) -> ClassStatistics:
        """The posterior means, for the next search."""
        return ClassStatistics(
            recall=self.detected / (self.detected + self.missed),
            precision=self.true_firings / (self.true_firings + self.false_firings),
        )

    def confirmed(self, looks: Iterable[CountedLook], location: int) -> "OnlineStatistics":
        """After a search whose target turned out to be at candidate `location`, found there or elsewhere."""
        detected = missed = false_firings = 0
        for look in looks:
            firings = len(look.densities)
            if look.in_view[location]:
                hit = firings > 0 and bool(look.densities[:, location].max() >= NEAR)
                detected += hit
                missed += not hit
                firings -= hit
            false_firings += firings
        return replace(
            self,
            detected=self.detected + detected,
            missed=self.missed + missed,
            true_firings=self.true_firings + detected,
            false_firings=self.false_firings + false_firings,
        )

    def refuted(self, looks: Iterable[CountedLook], location: int) -> "OnlineStatistics":
        """After a search that found the target at `location`, where it is not; nobody knows where it is.

        What was fired there was false. Other firings and silences say nothing.
        """
        false_firings = sum(int((look.densities[:, location] >= NEAR).sum()) for look in looks)
        return replace(self, false_firings=self.false_firings + false_firings)
