"""One score for an instruction from the doubts about its mentions."""

from dataclasses import replace

import numpy as np
import pytest

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import KINDS
from robustnav_nodes.instruction.metrics import auc
from robustnav_nodes.instruction.score_scale import (
    SURELY_RIGHT,
    UNSCALED,
    JudgedInstructions,
    ScoreScale,
    learn_scale,
    learn_shifts,
    noisy_or,
)

DIRECTION, OBJECT, ROOM = range(3)
assert KINDS == ("direction", "object", "room")


def any_wrong(odds: list[float]) -> float:
    return float(noisy_or(np.array(odds), np.zeros(len(odds), dtype=np.int64), 1)[0])


def test_an_instruction_is_wrong_where_one_of_its_mentions_is() -> None:
    def odds(probability: float) -> float:
        return float(np.log(probability / (1.0 - probability)))

    assert any_wrong([0.7]) == pytest.approx(0.7)
    assert any_wrong([odds(0.5), odds(0.2)]) == pytest.approx(odds(0.6))
    assert any_wrong([]) == any_wrong([-80.0] * 3) == SURELY_RIGHT
    assert np.isfinite(any_wrong([900.0, -900.0]))


def test_instructions_are_kept_apart() -> None:
    found = noisy_or(np.array([0.7, -0.2, 0.4]), np.array([0, 2, 2]), 4)
    np.testing.assert_allclose(found, [0.7, SURELY_RIGHT, any_wrong([-0.2, 0.4]), SURELY_RIGHT])


def test_the_shift_of_a_kind_counts_for_its_mentions_only() -> None:
    shifts = np.zeros(len(KINDS))
    shifts[DIRECTION] = 1.5
    score = ScoreScale(shifts=shifts, offset=0.5, factor=2.0)
    assert score.log_odds(np.array([0.3]), np.array([ROOM])) == pytest.approx(0.5 + 2.0 * 0.3)
    assert score.log_odds(np.array([0.3]), np.array([DIRECTION])) == pytest.approx(0.5 + 2.0 * 1.8)


def areas(told: JudgedInstructions, shifts: Float64) -> list[float]:
    """The AUC of each type of errors."""
    types = [told.error_type == one for one in np.unique(told.error_type)]
    scores = told.scores(shifts)
    return [auc(scores[own], told.label[own].astype(float)) or 0.0 for own in types]


def judged(
    spread: tuple[float, float, float], types: tuple[int, ...], *, count: int = 3000
) -> JudgedInstructions:
    """Each type of errors is one wrong mention of the kind it names.

    The log odds of mentions of a kind are normal and honest (wrong ones are higher by the variance), so the
    wider their `spread` [KINDS], the better they tell.
    """
    rng = np.random.default_rng(3)
    kind = np.array([DIRECTION, OBJECT] + [ROOM] * 6)
    width = np.array(spread)[kind]
    odds = rng.normal(-3.0 - width**2 / 2.0, width, (count, len(kind)))
    error_type, label = rng.integers(0, len(types), count), rng.integers(0, 2, count)
    wrong = np.array(types)[error_type]  # the first mentions are one of each kind
    odds[np.arange(count), wrong] += width[wrong] ** 2 * label
    return JudgedInstructions(
        odds=odds.ravel(),
        kind=np.tile(kind, count),
        instruction=np.repeat(np.arange(count), len(kind)),
        error_type=error_type,
        label=label,
    )


@pytest.mark.parametrize(("softly", "spread"), [(DIRECTION, (1.5, 2.0, 2.0)), (OBJECT, (2.0, 1.5, 2.0))])
def test_what_is_told_softly_is_not_drowned(softly: int, spread: tuple[float, float, float]) -> None:
    told = judged(spread, (DIRECTION, OBJECT, ROOM))
    shifts = learn_shifts(told)
    assert shifts.argmax() == softly
    assert areas(told, shifts)[softly] > areas(told, UNSCALED.shifts)[softly] + 0.05


def test_the_worst_type_counts_beside_the_mean() -> None:
    """Where four of five types are about rooms, the mean alone would leave wrong sides where they are."""
    told = judged((1.0, 2.0, 2.0), (DIRECTION, ROOM, ROOM, ROOM, ROOM))
    before, after = areas(told, UNSCALED.shifts), areas(told, learn_shifts(told))
    assert min(after) > min(before) + 0.05
    assert np.mean(after) < np.mean(before)


def test_what_is_not_told_at_all_is_not_shifted() -> None:
    told = judged((0.01, 2.0, 2.0), (DIRECTION, OBJECT, ROOM))
    assert learn_shifts(told)[DIRECTION] == 0.0


def test_a_type_of_which_there_are_few_does_not_choose() -> None:
    told = judged((1.5, 2.0, 2.0), (DIRECTION, OBJECT, ROOM))
    few = np.flatnonzero(told.error_type == DIRECTION)[:20]
    counted = np.where(told.error_type == DIRECTION, ROOM, told.error_type)
    counted[few] = DIRECTION
    turned = told.label.copy()
    turned[few] = 1 - turned[few]
    told = replace(told, error_type=counted)
    np.testing.assert_array_equal(learn_shifts(told), learn_shifts(replace(told, label=turned)))


def test_the_score_is_a_probability_and_what_tells_nothing_is_not_turned_around() -> None:
    label = np.array([0, 1] * 40)
    one, kind = np.arange(80), np.arange(80) // 2 % len(KINDS)
    error_type = np.zeros(80, dtype=np.int64)
    told = JudgedInstructions(
        odds=np.where(label, 3.0, 1.0), kind=kind, instruction=one, error_type=error_type, label=label
    )
    scale = learn_scale(told)
    assert scale.factor > 0.0
    assert scale.log_odds(np.array([2.0]), np.array([ROOM])) == pytest.approx(0.0, abs=0.01)
    assert learn_scale(replace(told, odds=-told.odds)) is UNSCALED
