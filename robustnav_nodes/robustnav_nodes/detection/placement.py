"""Boxes in an image -> places in space, by depth."""

import math

import numpy as np

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import CameraModel, DepthImage, Detections
from robustnav_nodes.detection.boxes import Boxes


def place_boxes(
    boxes: Boxes, depth: DepthImage, camera: CameraModel, *, part: float, samples_min: int
) -> tuple[Detections, int]:
    """Each box's object in the optical frame, and how many boxes had no valid depth and were dropped.

    The object's depth is the median of the valid samples in the middle `part` of its box (its edges show
    what is behind); its place is the box's centre at that depth. A box with fewer than `samples_min` valid
    samples is dropped: no place is better than a wrong one. Raises BadMessageError where the depth image is
    not of the camera's size.
    """
    height, width = depth.depth_m.shape
    if (width, height) != (camera.width, camera.height):
        raise BadMessageError(
            f"the depth image has {width} x {height} pixels, camera_info {camera.width} x {camera.height}"
        )
    kept: list[int] = []
    places: list[tuple[float, float, float]] = []
    for index, (u_min, v_min, u_max, v_max) in enumerate(boxes.box_px):
        u, v = (u_min + u_max) / 2.0, (v_min + v_max) / 2.0
        rows = _middle(v, v_max - v_min, part, height)
        columns = _middle(u, u_max - u_min, part, width)
        samples = depth.depth_m[rows, columns]
        valid = samples[np.isfinite(samples) & (samples > 0.0)]
        if len(valid) < samples_min:
            continue
        z = float(np.median(valid))
        kept.append(index)
        places.append(((u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z))
    detections = Detections(
        position_m=np.array(places, dtype=np.float32).reshape(-1, 3),
        score=boxes.score[kept],
        label=boxes.label[kept],
        box_px=boxes.box_px[kept],
        stamp_ns=depth.stamp_ns,
        frame_id=depth.frame_id,
    )
    return detections, len(boxes) - len(kept)


def _middle(centre: float, size: float, part: float, limit: int) -> slice:
    """The middle `part` of a side of a box, at least one pixel, inside 0..limit."""
    first = math.floor(centre - part * size / 2.0)
    last = max(first + 1, math.ceil(centre + part * size / 2.0))
    return slice(min(max(first, 0), limit - 1), max(min(last, limit), 1))
