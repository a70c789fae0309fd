"""Figures that were worked out by hand, and the properties that a figure must have."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.instruction.metrics import (
    atd,
    auc,
    expected_calibration_error,
    group_interval,
    temperature,
    token_distance,
    with_temperature,
)


def test_auc_counts_ties_half() -> None:
    labels = np.array([0.0, 0.0, 1.0, 1.0])
    assert auc(np.array([0.1, 0.5, 0.5, 0.9]), labels) == pytest.approx(3.5 / 4)
    assert auc(np.zeros(4), labels) == 0.5
    assert auc(np.zeros(4), np.ones(4)) is None
    assert auc(np.zeros(0), np.zeros(0)) is None


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.booleans()), min_size=2, max_size=30))
def test_auc_of_the_opposite_score(rows: list[tuple[float, bool]]) -> None:
    scores = np.array([score for score, _ in rows])
    labels = np.array([float(label) for _, label in rows])
    one, other = auc(scores, labels), auc(-scores, labels)
    assert (one is None) == (other is None)
    assert one is None or other is None or one + other == pytest.approx(1.0)


def test_token_distance_pairs_in_order() -> None:
    assert token_distance([3, 10], [11, 3]) == 0.5
    with pytest.raises(BadParameterError, match="one for each"):
        token_distance([3], [])


def test_atd_is_a_mean_over_episodes() -> None:
    assert atd([1.0, 3.0]) == 2.0
    assert atd([]) is None


def test_interval_holds_the_figure() -> None:
    values = np.random.default_rng(1).normal(size=60)
    found = group_interval([str(k // 10) for k in range(60)], lambda rows: float(values[rows].mean()))
    assert found is not None
    assert found[0] <= values.mean() <= found[1]
    assert group_interval(["one"] * 4, lambda rows: 1.0) is None


def test_temperature_mends_overconfidence() -> None:
    rng = np.random.default_rng(2)
    true = rng.uniform(0.05, 0.95, 4000)
    labels = (rng.uniform(size=4000) < true).astype(float)
    overconfident = with_temperature(true, 1.0 / 3.0)
    t = temperature(overconfident, labels)
    assert t == pytest.approx(3.0, rel=0.15)
    mended = with_temperature(overconfident, t)
    assert (
        expected_calibration_error(mended, labels) < 0.03 < expected_calibration_error(overconfident, labels)
    )
    assert temperature(overconfident, np.ones(4000)) == 1.0
