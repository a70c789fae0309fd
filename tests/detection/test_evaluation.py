"""Matching and average precision agree with examples worked by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.evaluation import (
    TrueBoxes,
    average_precision,
    first_is_right,
    iou,
    match_boxes,
    mean_average_precision,
    precision_recall,
    share_found,
)

SQUARE = (0.0, 0.0, 10.0, 10.0)
ELSEWHERE = (50.0, 50.0, 60.0, 60.0)


def found(*rows: tuple[tuple[float, float, float, float], float, int]) -> Boxes:
    return Boxes(
        box_px=np.array([row[0] for row in rows], dtype=np.float32).reshape(-1, 4),
        score=np.array([row[1] for row in rows], dtype=np.float32),
        label=np.array([row[2] for row in rows], dtype=np.uint32),
    )


def truth(*rows: tuple[tuple[float, float, float, float], int, bool]) -> TrueBoxes:
    return TrueBoxes(
        box_px=np.array([row[0] for row in rows], dtype=np.float32).reshape(-1, 4),
        label=np.array([row[1] for row in rows], dtype=np.uint32),
        counts=np.array([row[2] for row in rows], dtype=np.bool_),
    )


def test_iou_of_boxes_that_share_a_half_a_corner_and_nothing() -> None:
    boxes = np.array([SQUARE, (5, 0, 15, 10), (10, 10, 20, 20), ELSEWHERE], dtype=np.float32)
    assert iou(boxes[:1], boxes)[0].tolist() == pytest.approx([1.0, 50 / 150, 0.0, 0.0])


def test_boxes_without_area_overlap_nothing() -> None:
    point = np.zeros((1, 4), dtype=np.float32)
    assert iou(point, point)[0, 0] == 0.0


def test_an_object_is_found_once_and_the_second_box_on_it_is_wrong() -> None:
    matches = match_boxes(
        found((SQUARE, 0.6, 3), ((1, 0, 11, 10), 0.9, 3)), truth((SQUARE, 3, True), (ELSEWHERE, 3, True))
    )
    assert matches.truth_of.tolist() == [-1, 0]
    assert matches.found_by.tolist() == [1, -1]
    assert not matches.ignored.any()


def test_another_class_in_the_right_place_is_wrong() -> None:
    matches = match_boxes(found((SQUARE, 0.9, 4)), truth((SQUARE, 3, True)))
    assert matches.truth_of.tolist() == [-1]


def test_what_does_not_count_may_be_found_without_blame() -> None:
    matches = match_boxes(found((SQUARE, 0.9, 3), (SQUARE, 0.8, 3)), truth((SQUARE, 3, False)))
    assert matches.ignored.tolist() == [True, True]
    assert matches.found_by.tolist() == [0]


def test_what_counts_goes_before_a_better_overlap_that_does_not() -> None:
    matches = match_boxes(found((SQUARE, 0.9, 3)), truth((SQUARE, 3, False), ((2, 0, 12, 10), 3, True)))
    assert matches.truth_of.tolist() == [1]
    assert not matches.ignored.any()


def test_average_precision_by_hand() -> None:
    # right, wrong, right, of 4 objects: precision 1, 1/2, 2/3 at recall 1/4, 1/4, 1/2
    area = average_precision(np.array([1.0, 0.5, 2 / 3]), np.array([0.25, 0.25, 0.5]))
    assert area == pytest.approx(0.25 * 1.0 + 0.25 * 2 / 3)


def test_precision_and_recall_run_over_all_images_by_score() -> None:
    images = [found((SQUARE, 0.9, 0), (ELSEWHERE, 0.8, 0)), found((SQUARE, 0.7, 0)), found()]
    real = [truth((SQUARE, 0, True)), truth((SQUARE, 0, True)), truth((SQUARE, 0, True))]
    curve = precision_recall(images, real, 0)
    assert curve.score.tolist() == pytest.approx([0.9, 0.8, 0.7])
    assert curve.precision.tolist() == pytest.approx([1.0, 0.5, 2 / 3])
    assert curve.recall.tolist() == pytest.approx([1 / 3, 1 / 3, 2 / 3])
    assert curve.average_precision == pytest.approx(1 / 3 + 1 / 3 * 2 / 3)


def test_a_class_without_objects_has_no_precision_and_does_not_lower_the_mean() -> None:
    mean, each = mean_average_precision([found((SQUARE, 0.9, 0))], [truth((SQUARE, 0, True))], 2)
    assert mean == 1.0
    assert np.isnan(each[1])


def test_nothing_found_is_a_precision_of_zero() -> None:
    assert precision_recall([found()], [truth((SQUARE, 0, True))], 0).average_precision == 0.0


def test_shares_by_bin_with_the_edge_in_the_upper_one() -> None:
    share, count = share_found(
        np.array([0.5, 1.0, 1.5, 9.0]), np.array([True, True, False, True]), np.array([0.0, 1.0, 2.0, 3.0])
    )
    assert count.tolist() == [1, 2, 0]
    assert share[:2].tolist() == [1.0, 0.5]
    assert np.isnan(share[2])


def test_a_tie_is_no_recognition() -> None:
    assert first_is_right(np.array([0.9, 0.5]), 0)
    assert not first_is_right(np.array([0.9, 0.9]), 0)


@given(st.lists(st.booleans(), max_size=30), st.integers(0, 10))
def test_average_precision_lies_between_0_and_the_recall_that_was_reached(
    right: list[bool], missed: int
) -> None:
    hits = np.cumsum(np.array(right, dtype=np.bool_))
    precision = hits / np.arange(1, len(hits) + 1)
    recall = hits / max(1, sum(right) + missed)
    area = average_precision(precision, recall)
    assert 0.0 <= area <= (recall[-1] if len(recall) else 0.0) + 1e-12
