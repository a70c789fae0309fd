"""The belief: a probability for each candidate location, given everything observed so far."""

import dataclasses
import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import BeliefCloud, Float64
from robustnav_nodes.search_space.candidates import Candidates

_ROUNDING_M = 1e-6  # what lies exactly on the edge of a patch lies on it


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LocationBelief:
    """The vector R (thesis 3.2.1.3) over the k candidates: sums to one, never 0, never NaN.

    probability: float64 [k].
    """

    candidates: Candidates
    probability: Float64

    @classmethod
    def uniform(cls, candidates: Candidates) -> "LocationBelief":
        """Nothing is known yet: 1/k each (C1: k candidates; the thesis writes n, its number of poses)."""
        count = len(candidates)
        return cls(candidates=candidates, probability=np.full(count, 1.0 / count))

    @classmethod
    def weighted(cls, candidates: Candidates, weight: Float64, strength: float) -> "LocationBelief":
        """Something is known beforehand: in proportion to `weight` (float64 [k], not negative, not all 0).

        strength: in 0..1, the part of the belief that follows the weights; the rest is uniform, so that below
        1 no location begins at 0. Raises BadParameterError where weights or strength are none, or where a
        location would begin at 0.
        """
        if weight.shape != (len(candidates),) or not np.isfinite(weight).all() or np.any(weight < 0.0):
            raise BadParameterError(
                f"a prior needs {len(candidates)} finite weights, none of them negative: got {weight}"
            )
        if not 0.0 <= strength <= 1.0 or weight.sum() <= 0.0:
            raise BadParameterError(
                f"a prior of strength {strength!r} and weights that sum to {weight.sum()}: the strength must "
                "lie in 0..1 and some weight above 0"
            )
        probability = strength * weight / weight.sum() + (1.0 - strength) / len(candidates)
        if probability.min() <= 0.0:
            raise BadParameterError("a weight is 0 and the strength 1: a location at 0 could never come back")
        return cls(candidates=candidates, probability=probability)

    def updated(self, factor: Float64, probability_floor: float) -> "LocationBelief":
        """Bayes' rule with `factor` (d, float64 [k], see `observation`): p_j <- p_j d_j / sum (eq. 3.1).

        C4: no location falls below `probability_floor` / k, so the sum is never 0 and every location can
        come back. A factor that is not finite or sums to nothing leaves the belief as it is.
        """
        product = self.probability * factor
        total = float(product.sum())
        if not math.isfinite(total) or total <= 0.0 or bool(np.any(product < 0.0)):
            return self
        raised = np.maximum(product / total, probability_floor / len(product))
        return dataclasses.replace(self, probability=raised / raised.sum())

    def carried_to(self, candidates: Candidates) -> "LocationBelief":
        """This belief on the candidates of a map that has grown or changed.

        A candidate whose middle lies on the patch of an old one (the nearest, where it lies on several) keeps
        that one's probability; one where none was has the prior's share, 1/k of the old k. All are then
        scaled to sum to one. So what is known of places to each other stays, and a wholly other map begins
        at the uniform belief.
        """
        old = self.candidates
        places = KDTree(np.stack([old.x_m, old.y_m], axis=1))
        _, nearest = places.query(
            np.stack([candidates.x_m, candidates.y_m], axis=1),
            p=np.inf,  # a patch is a square
            distance_upper_bound=0.5 * old.size_m + _ROUNDING_M,
        )
        with_new = np.append(self.probability, 1.0 / len(old))  # a query without an answer gives len(old)
        probability = with_new[nearest]
        return LocationBelief(candidates=candidates, probability=probability / probability.sum())

    def normalised_entropy(self) -> float:
        """Entropy over its maximum log k: 1 where nothing is known, near 0 where one location is sure."""
        count = len(self.probability)
        if count == 1:
            return 0.0
        entropy = -float(np.sum(self.probability * np.log(self.probability)))
        return min(1.0, max(0.0, entropy / math.log(count)))

    def cloud(self, stamp_ns: int, frame_id: str) -> BeliefCloud:
        """The belief as it is published; `stamp_ns` is the stamp of the last observation looked at."""
        return BeliefCloud(
            position_m=self.candidates.position_m,
            probability=self.probability.copy(),
            stamp_ns=stamp_ns,
            frame_id=frame_id,
        )
