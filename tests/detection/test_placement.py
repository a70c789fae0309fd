"""Boxes are placed by the depth inside them; what has no valid depth is dropped, not guessed."""

from dataclasses import replace

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import CameraModel, DepthImage
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.parameters import DetectionParameters
from robustnav_nodes.detection.placement import place_boxes

FACE = DetectionParameters(depth_behind=0.0)
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
    found, dropped = place_boxes(boxes((38, 20, 46, 28)), depth(image), CAMERA, FACE)
    assert dropped == 0
    assert np.allclose(found.position_m[0], [(42 - 32) / 50 * 2.0, 0.0, 2.0])
    assert (found.stamp_ns, found.frame_id) == (7, "optical")


def test_holes_do_not_count() -> None:
    image = np.full((48, 64), 2.0)
    image[::2] = np.nan
    image[:, ::3] = np.inf
    found, _ = place_boxes(boxes((10, 10, 30, 30)), depth(image), CAMERA, FACE)
    assert found.position_m[0, 2] == 2.0


@pytest.mark.parametrize("value", [np.nan, np.inf, 0.0])
def test_a_box_without_valid_depth_is_dropped(value: float) -> None:
    image = np.full((48, 64), value)
    image[:, :20] = 3.0
    both = boxes((40, 10, 60, 30), (0, 0, 15, 15))
    found, dropped = place_boxes(both, depth(image), CAMERA, FACE)
    assert (len(found), dropped, list(found.label)) == (1, 1, [1])


def test_boxes_at_and_over_the_edge() -> None:
    image = np.full((48, 64), 2.0)
    edges = boxes((-20, -20, 4, 4), (60, 40, 90, 70), (63, 47, 64, 48))
    found, dropped = place_boxes(edges, depth(image), CAMERA, replace(FACE, depth_samples_min=1))
    assert (len(found), dropped) == (3, 0)


def test_depth_of_another_size_is_refused() -> None:
    with pytest.raises(BadMessageError, match=r"32 x 24 pixels.*64 x 48"):
        place_boxes(boxes(), depth(np.ones((24, 32))), CAMERA, FACE)


def test_a_thing_that_fills_less_than_half_of_its_box_is_not_placed_on_the_wall() -> None:
    """An open laptop seen from the side: 45 % of its box; the median would be the wall's."""
    image = np.full((48, 64), 5.0)
    image[20:30, 30:34], image[27:30, 24:40] = 2.0, 2.0
    found, _ = place_boxes(boxes((24, 20, 40, 30)), depth(image), CAMERA, FACE)
    assert found.position_m[0, 2] == 2.0


def test_what_hides_an_edge_of_the_box_is_not_the_object() -> None:
    image = np.full((48, 64), 5.0)
    image[10:30, 20:40] = 3.0
    image[10:30, 20:26] = 1.0
    found, _ = place_boxes(boxes((20, 10, 40, 30)), depth(image), CAMERA, FACE)
    assert found.position_m[0, 2] == 3.0


def test_noise_of_a_depth_camera_does_not_part_a_surface() -> None:
    noise = np.random.default_rng(0).normal(0.0, 0.03, (48, 64))
    image = np.full((48, 64), 5.0)
    image[12:28, 22:38] = 4.0
    found, _ = place_boxes(boxes((20, 10, 40, 30)), depth(image + noise), CAMERA, FACE)
    assert found.position_m[0, 2] == pytest.approx(4.0, abs=0.02)


def test_where_everything_is_scattered_the_median_is_taken() -> None:
    image = np.tile(np.arange(1.0, 65.0), (48, 1))
    found, _ = place_boxes(boxes((10, 10, 21, 20)), depth(image), CAMERA, FACE)
    assert found.position_m[0, 2] == 16.0


def test_the_middle_of_a_thing_lies_behind_its_face() -> None:
    """A box of 10 by 20 px at 2 m is 0.4 m wide: a fifth of that farther, along the ray."""
    found, _ = place_boxes(
        boxes((37, 14, 47, 34)), depth(np.full((48, 64), 2.0)), CAMERA, DetectionParameters(depth_behind=0.2)
    )
    assert np.allclose(found.position_m[0], [(42 - 32) / 50 * 2.08, 0.0, 2.08])


def test_a_box_as_large_as_a_large_image_is_sampled() -> None:
    large = CameraModel(width=1280, height=960, fx=1000.0, fy=1000.0, cx=640.0, cy=480.0)
    image = depth(np.full((960, 1280), 2.0))
    found, dropped = place_boxes(boxes((0, 0, 1280, 960)), image, large, FACE)
    assert (dropped, found.position_m[0, 2]) == (0, 2.0)
