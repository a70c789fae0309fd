"""Where the target may be before the first look: what kind of place it is kept in, and what people say.

A map of regions, rooms for instance, is given as the number of each candidate's region. Weights are float64
[k], not negative, and sum to one; `LocationBelief.weighted` makes a belief of them.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Float64

Regions = NDArray[np.int64]  # [k], from 0


@dataclass(frozen=True, slots=True, kw_only=True)
class RegionFact:
    """Somebody says that the target is in a region, or is not; `trust`: how likely that is true, in 0..1."""

    region: int
    is_there: bool = True
    trust: float = 0.8

    def __post_init__(self) -> None:
        if not 0.0 <= self.trust <= 1.0:
            raise BadParameterError(f"the trust in a fact is {self.trust!r}; it must lie in 0..1")


def region_prior(region: Regions, affinity: Float64) -> Float64:
    """Weights of candidates in `region` where the target is in region r with probability ~ affinity[r].

    A region's share is spread evenly over its candidates. Raises BadParameterError for an affinity that is
    negative or missing, or where none of the regions with candidates has any.
    """
    if len(affinity) <= region.max():
        raise BadParameterError(f"there are {len(affinity)} affinities for {region.max() + 1} regions")
    if not np.isfinite(affinity).all() or np.any(affinity < 0.0):
        raise BadParameterError(f"an affinity is negative or not finite: {affinity.tolist()}")
    candidates_in = np.bincount(region, minlength=len(affinity))
    weight = affinity[region] / candidates_in[region]
    return _summing_to_one(weight, "no region with candidates has an affinity above 0")


def told(weight: Float64, region: Regions, fact: RegionFact) -> Float64:
    """`weight` after a fact, by Bayes' rule, so that the order of facts does not matter.

    Who is wrong about where the target is names each other region alike: a wrong answer falls on one region
    with (1 - trust) / (regions - 1). Raises BadParameterError where the fact, trusted fully, contradicts all
    that is believed.
    """
    inside = region == fact.region
    others = max(1, len(np.unique(region)) - 1)
    if fact.is_there:
        likelihood = np.where(inside, fact.trust, (1.0 - fact.trust) / others)
    else:
        likelihood = np.where(inside, 1.0 - fact.trust, fact.trust)
    return _summing_to_one(weight * likelihood, f"{fact} leaves no place for the target")


def _summing_to_one(weight: Float64, otherwise: str) -> Float64:
    total = weight.sum()
    if total <= 0.0:
        raise BadParameterError(otherwise)
    return np.asarray(weight / total, dtype=np.float64)
