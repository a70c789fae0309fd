"""Matching, average precision and calibration, worked by hand."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_nodes.benchmarks.detection_scores import (
    NONE,
    average_precision,
    calibration_error,
    match_boxes,
    overlaps,
    reliability,
)

UNIT = [0.0, 0.0, 10.0, 10.0]


def test_overlap_by_hand():
    """Half of it, itself, beside it, and a box without area."""
    others = np.array([[0.0, 0.0, 5.0, 10.0], UNIT, [10.0, 0.0, 20.0, 10.0], [3.0, 3.0, 3.0, 3.0]])
    assert overlaps(np.array([UNIT]), others)[0].tolist() == [0.5, 1.0, 0.0, 0.0]
    assert overlaps(np.zeros((0, 4)), others).shape == (0, 4)


def test_the_best_score_chooses_first_and_a_true_box_is_taken_once():
    found = np.array([[0.0, 0.0, 10.0, 9.0], UNIT, [50.0, 50.0, 60.0, 60.0]])
    chosen = match_boxes(found, np.array([0.9, 0.8, 0.7]), np.array([UNIT]), np.array([True]))
    assert chosen.tolist() == [0, NONE, NONE]


def test_true_boxes_that_count_go_first():
    """The found box fits the one that does not count better."""
    true = np.array([[0.0, 0.0, 10.0, 8.0], UNIT])
    chosen = match_boxes(np.array([UNIT]), np.array([0.5]), true, np.array([True, False]))
    assert chosen.tolist() == [0]


def test_average_precision_by_hand():
    """Right, wrong, right of two objects: 1/2 at precision 1, 1/2 at precision 2/3."""
    score, right = np.array([0.5, 0.9, 0.7]), np.array([True, True, False])
    assert average_precision(score, right, 2) == pytest.approx(0.5 + 0.5 * 2 / 3)
    assert average_precision(score, right, 4) == pytest.approx(0.25 + 0.25 * 2 / 3)


def test_precision_is_made_to_fall_only():
    """Wrong, then right: what lies before the best precision gets it too."""
    assert average_precision(np.array([0.9, 0.8]), np.array([False, True]), 1) == 0.5
    score = np.array([0.9, 0.8, 0.7, 0.6])
    assert average_precision(score, np.array([True, False, True, True]), 3) == pytest.approx(
        1 / 3 + 2 / 3 * 0.75
    )


def test_without_objects_or_detections():
    none = np.zeros(0)
    assert math.isnan(average_precision(none, none.astype(bool), 0))
    assert average_precision(none, none.astype(bool), 3) == 0.0
    assert reliability(none, none.astype(bool)) == []
    assert math.isnan(calibration_error([]))


def test_reliability_by_hand():
    """Two of score 0.1, both wrong; two of 0.9 and 1.0, one right: |0 - 0.1| / 2 + |0.5 - 0.95| / 2."""
    rows = reliability(np.array([0.1, 0.1, 0.9, 1.0]), np.array([False, False, True, False]))
    assert [(row.low, row.detections, row.precision) for row in rows] == [(0.1, 2, 0.0), (0.9, 2, 0.5)]
    assert calibration_error(rows) == pytest.approx(0.05 + 0.225)


@given(st.lists(st.tuples(st.floats(0.0, 1.0), st.booleans()), max_size=30), st.integers(1, 40))
def test_average_precision_lies_between_nothing_and_the_recall(rows, more):
    score, right = np.array([row[0] for row in rows]), np.array([row[1] for row in rows], dtype=bool)
    objects = int(right.sum()) + more - 1 or 1
    value = average_precision(score, right, objects)
    assert -1e-12 <= value <= right.sum() / objects + 1e-12
