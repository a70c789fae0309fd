"""How much likelier it is that a word was put in for another one than that a person wrote it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.common_sense import CommonSense
from robustnav_nodes.instruction.concepts import (
    CONCEPT_NUMBER,
    CONCEPTS,
    DIRECTION,
    FIRST_OBJECT,
    OPPOSITES,
)

_OPPOSITE = {
    CONCEPT_NUMBER[DIRECTION, one]: CONCEPT_NUMBER[DIRECTION, other] for one, other in OPPOSITES.items()
}
ODDS = ("uniform", "matched", "best", "allowed")


@dataclass(frozen=True, slots=True, kw_only=True)
class Replacements:
    """[objects and rooms, same]: log of how likely the second is put in for the first (-Inf: never)."""

    log_share: Float64


def replacements_of(common_sense: CommonSense) -> Replacements:
    """Uniform over what common sense allows."""
    count = len(CONCEPTS) - FIRST_OBJECT
    log_share = np.full((count, count), -np.inf)
    for number in range(FIRST_OBJECT, len(CONCEPTS)):
        kind, concept = CONCEPTS[number]
        others = [other for other in common_sense.of(kind, concept) if (kind, other) in CONCEPT_NUMBER]
        for other in others:
            column = CONCEPT_NUMBER[kind, other] - FIRST_OBJECT
            log_share[number - FIRST_OBJECT, column] = -math.log(len(others))
    return Replacements(log_share=log_share)


def replacement_odds(
    fits: Float64, numbers: NDArray[np.int64], replacements: Replacements, evidence: Float64 | None = None
) -> Float64:
    """float64 [4, M], as ODDS: log odds that each mention was put in, and for how many others it may stand.

    `fits` [M, concepts]: how well every concept reads there; `evidence` [M, objects and rooms] what the walk
    says, none for the wording alone. NaN where nothing is known to be replaced by the concept.
    """
    count = len(numbers)
    found = np.full((len(ODDS), count), np.nan)
    if not count:
        return found
    sided = numbers < FIRST_OBJECT
    if sided.any():
        other = np.array([_OPPOSITE[number] for number in numbers[sided]])
        gain = fits[sided, other] - fits[sided, numbers[sided]]
        found[:, sided] = gain, np.minimum(gain, 0.0), gain, np.ones(len(gain))
    thing = ~sided
    if thing.any():
        column = numbers[thing] - FIRST_OBJECT
        gain = fits[thing, FIRST_OBJECT:] - fits[thing, numbers[thing]][:, None]
        weight = replacements.log_share.T[column]
        seen = np.zeros_like(gain)
        if evidence is not None:
            seen = evidence[thing] - evidence[thing, column][:, None]
        could = np.isfinite(weight)
        known = could.any(axis=1)
        rows = np.flatnonzero(thing)[known]
        gain, weight, seen, could = gain[known], weight[known], seen[known], could[known]
        found[0, rows] = np.logaddexp.reduce(gain + weight + seen, axis=1)
        found[1, rows] = np.logaddexp.reduce(np.minimum(gain, 0.0) + weight + seen, axis=1)
        found[2, rows] = np.where(could, gain + seen, -np.inf).max(axis=1)
        found[3, rows] = could.sum(axis=1)
    return found


def worst_other(odds: Float64) -> Float64:
    """float64 [M]: the highest odds among the other mentions; NaN where there is none."""
    if len(odds) < 2:
        return np.full(len(odds), np.nan)
    order = np.argsort(np.where(np.isnan(odds), -np.inf, odds))
    worst = np.full(len(odds), odds[order[-1]])
    worst[order[-1]] = odds[order[-2]]
    return worst
