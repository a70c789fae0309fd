"""Suppression and letterboxing by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.letterbox import Letterbox
from robustnav_nodes.detection.suppression import suppress


def boxes(*rows: tuple[float, float, int]) -> Boxes:
    """Boxes of 10 x 10 px as (u_min, score, label)."""
    return Boxes(
        box_px=np.array([(u, 0.0, u + 10.0, 10.0) for u, _, _ in rows], np.float32).reshape(-1, 4),
        score=np.array([score for _, score, _ in rows], np.float32),
        label=np.array([label for _, _, label in rows], np.uint32),
    )


def test_the_best_of_a_heap_stays_and_other_classes_are_left_alone() -> None:
    """IoU 0.8 / 1.2 with the first; the third is of another class; the fourth lies 5 px on: IoU 1/3."""
    found = suppress(boxes((2, 0.6, 0), (0, 0.9, 0), (0, 0.5, 1), (5, 0.7, 0)), 0.5)
    assert found.box_px[:, 0].tolist() == [0.0, 5.0, 0.0]
    assert found.label.tolist() == [0, 0, 1]


def test_a_box_without_area_is_dropped() -> None:
    found = boxes((0, 0.9, 0), (30, 0.8, 0))
    found.box_px[0, 2] = 0.0
    assert suppress(found, 0.5).box_px[:, 0].tolist() == [30.0]


def test_nothing_stays_nothing() -> None:
    assert len(suppress(boxes(), 0.5)) == 0


@given(st.lists(st.tuples(st.floats(0, 50), st.floats(0, 1), st.integers(0, 1)), max_size=20))
def test_suppressing_twice_changes_nothing(rows: list[tuple[float, float, int]]) -> None:
    once = suppress(boxes(*rows), 0.4)
    assert np.array_equal(suppress(once, 0.4).box_px, once.box_px)


@pytest.mark.parametrize(("width", "height"), [(320, 240), (240, 320), (31, 17), (1, 1), (1000, 3)])
def test_boxes_come_back_from_the_letterbox(width: int, height: int) -> None:
    letterbox = Letterbox.of(width, height, 64)
    pixels = np.zeros((height, width, 3), np.uint8)
    square = letterbox.filled(pixels)
    assert square.shape == (64, 64, 3)
    black = np.nonzero((square == 0).all(axis=2))
    found = np.array([[black[1].min(), black[0].min(), black[1].max() + 1, black[0].max() + 1]])
    slack = 1.0 / letterbox.scale
    assert np.abs(letterbox.back(found)[0] - [0, 0, width, height]).max() <= slack
