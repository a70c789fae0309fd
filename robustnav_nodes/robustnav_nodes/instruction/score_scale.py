"""From doubts about mentions to one about the whole instruction: one wrong mention is enough.

A noisy-or, on a scale that makes a probability of it. Many doubts about what is told easily would drown the
one about what is hard to tell, so the log odds of each kind of mention are shifted before they meet.
"""

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import KINDS
from robustnav_nodes.instruction.metrics import auc

SURELY_RIGHT = -9.0  # log odds of an instruction in which nothing can be wrong
_SHIFTS = np.arange(-1.5, 1.51, 0.25)
_MARGIN = 0.003  # a larger shift must be better by so much
_ENOUGH = 30  # instructions of a type, right ones and wrong ones each, for its AUC to count


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreScale:
    """Makes log odds of an instruction of those of its mentions: offset + factor · noisy-or.

    `shifts` [KINDS] are added to the mentions' first. Raises BadParameterError for numbers that are no scale.
    """

    shifts: Float64
    offset: float
    factor: float

    def __post_init__(self) -> None:
        numbers = [self.offset, self.factor, *self.shifts]
        if len(self.shifts) != len(KINDS) or not np.isfinite(numbers).all() or self.factor <= 0.0:
            raise BadParameterError(
                f"a score needs {len(KINDS)} shifts, finite numbers and a factor above 0, not {numbers}"
            )

    def log_odds(self, odds: Float64, kind: NDArray[np.int64]) -> float:
        """Log odds that an instruction is wrong, from those [M] of its mentions, of kinds [M] of KINDS."""
        all_in_one = np.zeros(len(odds), dtype=np.int64)
        return float(self.offset + self.factor * noisy_or(odds + self.shifts[kind], all_in_one, 1)[0])


UNSCALED = ScoreScale(shifts=np.zeros(len(KINDS)), offset=0.0, factor=1.0)


def noisy_or(odds: Float64, instruction: NDArray[np.int64], count: int) -> Float64:
    """float64 [count]: log odds that at least one mention of an instruction is wrong.

    `odds` [M] are those of the mentions, `instruction` [M] says in which each of them stands.
    """
    none = -np.bincount(instruction, np.logaddexp(0.0, odds), minlength=count)  # log P(no mention is wrong)
    with np.errstate(divide="ignore"):
        found: Float64 = np.maximum(np.log(-np.expm1(none)) - none, SURELY_RIGHT)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class JudgedInstructions:
    """Instructions [N], right and wrong ones, and how doubtful a judge found their mentions [M].

    `odds`, `kind` (of KINDS) and `instruction` (in which it stands) are the mentions', `error_type` and
    `label` (1: wrong) the instructions'.
    """

    odds: Float64
    kind: NDArray[np.int64]
    instruction: NDArray[np.int64]
    error_type: NDArray[np.int64]
    label: NDArray[np.int64]

    def scores(self, shifts: Float64) -> Float64:
        """float64 [N]: log odds of each instruction, with `shifts` [KINDS]."""
        return noisy_or(self.odds + shifts[self.kind], self.instruction, len(self.label))


def learn_scale(judged: JudgedInstructions) -> ScoreScale:
    """Learn it from instructions that the judge of their mentions did not learn from.

    Where the odds tell nothing, no factor above 0 fits, and they stay as they are.
    """
    from sklearn.linear_model import LogisticRegression

    shifts = learn_shifts(judged)
    regression = LogisticRegression(max_iter=500).fit(judged.scores(shifts)[:, None], judged.label)
    offset, factor = float(regression.intercept_[0]), float(regression.coef_[0, 0])
    return ScoreScale(shifts=shifts, offset=offset, factor=factor) if factor > 0.0 else UNSCALED


def learn_shifts(judged: JudgedInstructions) -> Float64:
    """float64 [KINDS], the last 0: of a grid the best by the mean AUC over types of errors plus the lowest.

    The mean alone would let the types that are told easily make up for one that is hardly told. Of shifts
    nearly as good as the best the smallest is taken: what is chosen in few homes is partly chance.
    """
    label = judged.label
    types = [judged.error_type == one for one in np.unique(judged.error_type)]
    types = [own for own in types if min(label[own].sum(), (1 - label[own]).sum()) >= _ENOUGH]

    def goodness(shifts: Float64) -> float:
        scores = judged.scores(shifts)
        areas = [auc(scores[own], label[own].astype(float)) or 0.0 for own in types]
        return float(np.mean(areas) + min(areas)) if areas else 0.0

    grid = [np.array([*shifts, 0.0]) for shifts in product(_SHIFTS, repeat=len(KINDS) - 1)]
    good = np.array([goodness(shifts) for shifts in grid])
    size = np.array([np.abs(shifts).sum() for shifts in grid])
    return grid[int(np.where(good >= good.max() - _MARGIN, size, np.inf).argmin())]
