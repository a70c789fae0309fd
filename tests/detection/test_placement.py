"""Boxes are placed by the depth inside them; what has no valid depth is dropped, not guessed."""

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import CameraModel, DepthImage
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.placement import place_boxes

CAMERA = CameraModel(width=64, height=48, fx=50.0, fy=50.0, cx=32.0, cy=24.0)


def boxes(*rows: tuple[float, float, float, float]) -> Boxes:
    count = len(rows)
    return Boxes(
        box_px=np.array(rows, np.float32).reshape(-1, 4),
        score=np.full(count, 0.9, np.float32),
        label=np.arange(count, dtype=np.uint32),
    )


def depth(values: np.ndarray) -> DepthImage:
    return DepthImage(depth_m=values.astype(np.float32), stamp_ns=7, frame_id="optical")


def test_a_box_is_placed_at_its_centre_and_depth() -> None:
    image = np.full((48, 64), 5.0)
    image[20:28, 38:46] = 2.0  # the object, in front of a wall
    found, dropped = place_boxes(boxes((38, 20, 46, 28)), depth(image), CAMERA, part=0.5, samples_min=3)
    assert dropped == 0
    assert np.allclose(found.position_m[0], [(42 - 32) / 50 * 2.0, 0.0, 2.0])
    assert (found.stamp_ns, found.frame_id) == (7, "optical")


def test_holes_do_not_count() -> None:
    image = np.full((48, 64), 2.0)
    image[::2] = np.nan
    image[:, ::3] = np.inf
    found, _ = place_boxes(boxes((10, 10, 30, 30)), depth(image), CAMERA, part=0.5, samples_min=3)
    assert found.position_m[0, 2] == 2.0


@pytest.mark.parametrize("value", [np.nan, np.inf, 0.0])
def test_a_box_without_valid_depth_is_dropped(value: float) -> None:
    image = np.full((48, 64), value)
    image[:, :20] = 3.0
    both = boxes((40, 10, 60, 30), (0, 0, 15, 15))
    found, dropped = place_boxes(both, depth(image), CAMERA, part=0.5, samples_min=3)
    assert (len(found), dropped, list(found.label)) == (1, 1, [1])


def test_boxes_at_and_over_the_edge() -> None:
    image = np.full((48, 64), 2.0)
    edges = boxes((-20, -20, 4, 4), (60, 40, 90, 70), (63, 47, 64, 48))
    found, dropped = place_boxes(edges, depth(image), CAMERA, part=0.5, samples_min=1)
    assert (len(found), dropped) == (3, 0)


def test_depth_of_another_size_is_refused() -> None:
    with pytest.raises(BadMessageError, match=r"32 x 24 pixels.*64 x 48"):
        place_boxes(boxes(), depth(np.ones((24, 32))), CAMERA, part=0.5, samples_min=3)
