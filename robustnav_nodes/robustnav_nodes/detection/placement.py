"""Boxes in an image -> places in space, by depth."""

import math

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import CameraModel, DepthImage, Detections, Float32, Float64
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.parameters import DetectionParameters

SAMPLES_PER_AXIS = 48  # of a larger box, pixels are left out evenly
EDGE_WEIGHT = 0.05  # of a sample at the edge of its box, over one in the middle


def place_boxes(
    boxes: Boxes, depth: DepthImage, camera: CameraModel, parameters: DetectionParameters
) -> tuple[Detections, int]:
    """Each box's object in the optical frame, and how many boxes had no valid depth and were dropped.

    A box shows its object and what is behind, beside and sometimes in front of it. Its valid depths fall
    into surfaces, parted by gaps of depth_gap_m; the object is the nearest surface that covers depth_cover of
    the box, where the middle of the box counts for more than its edge. Its depth is that surface's median,
    and depth_behind of the box's smaller side farther, as the middle of a thing lies behind its face; its
    place is the box's centre at that depth. A box with fewer than depth_samples_min valid samples is dropped:
    no place is better than a wrong one. Raises BadMessageError where the depth image is not of the camera's
    size.
    """
    z_m = _depths_m(boxes, depth, camera, parameters)
    placed = np.isfinite(z_m)
    kept, z_m = boxes[placed], z_m[placed]
    u, v = (kept.box_px[:, :2] + kept.box_px[:, 2:]).T / 2.0
    position_m = np.column_stack([(u - camera.cx) / camera.fx * z_m, (v - camera.cy) / camera.fy * z_m, z_m])
    detections = Detections(
        position_m=position_m.astype(np.float32),
        score=kept.score,
        label=kept.label,
        box_px=kept.box_px,
        stamp_ns=depth.stamp_ns,
        frame_id=depth.frame_id,
    )
    return detections, len(boxes) - len(kept)


def heights_m(
    boxes: Boxes, depth: DepthImage, camera: CameraModel, parameters: DetectionParameters
) -> Float32:
    """How tall each box is at the depth of its object, float32 [n] (m), NaN where that is not known.

    Raises BadMessageError where the depth image is not of the camera's size.
    """
    z_m = _depths_m(boxes, depth, camera, parameters)
    return ((boxes.box_px[:, 3] - boxes.box_px[:, 1]) * z_m / camera.fy).astype(np.float32)


def _depths_m(
    boxes: Boxes, depth: DepthImage, camera: CameraModel, parameters: DetectionParameters
) -> Float64:
    """How far ahead the middle of each box's object is, [n] (m), as `place_boxes` says; NaN: not known."""
    height, width = depth.depth_m.shape
    if (width, height) != (camera.width, camera.height):
        raise BadMessageError(
            f"the depth image has {width} x {height} pixels, camera_info {camera.width} x {camera.height}"
        )
    face_m = np.array([_face_m(depth.depth_m, box, parameters) for box in boxes.box_px], dtype=np.float64)
    sides = (boxes.box_px[:, 2:] - boxes.box_px[:, :2]) / (camera.fx, camera.fy)
    return np.asarray(face_m * (1.0 + parameters.depth_behind * sides.min(axis=1)), dtype=np.float64)


def _face_m(depth_m: Float32, box: Float32, parameters: DetectionParameters) -> float:
    """Depth of the surface that the object in `box` shows; NaN where too few samples are valid."""
    height, width = depth_m.shape
    columns, rows = _pixels(box[0], box[2], width), _pixels(box[1], box[3], height)
    samples = depth_m[np.ix_(rows, columns)]
    weight = 1.0 - np.maximum(
        _off_centre(rows, box[1], box[3])[:, np.newaxis], _off_centre(columns, box[0], box[2])
    )
    valid = np.isfinite(samples) & (samples > 0.0)
    near_first = samples[valid].astype(np.float64)
    if len(near_first) < parameters.depth_samples_min:
        return math.nan
    order = np.argsort(near_first, kind="stable")
    near_first, weights = near_first[order], np.maximum(weight[valid][order], EDGE_WEIGHT)
    ends = np.append(np.flatnonzero(np.diff(near_first) > parameters.depth_gap_m) + 1, len(near_first))
    begins = np.concatenate([[0], ends[:-1]])
    covers = np.add.reduceat(weights, begins) >= parameters.depth_cover * weights.sum()
    if not covers.any():  # many small surfaces: none of them is the object alone
        return float(np.median(near_first))
    first = int(np.argmax(covers))
    return float(np.median(near_first[begins[first] : ends[first]]))


def _pixels(low: float, high: float, limit: int) -> NDArray[np.int64]:
    """The pixels of a side of a box, at least one, inside 0..limit."""
    begin = min(max(math.floor(low), 0), limit - 1)
    end = max(min(math.ceil(high), limit), begin + 1)
    return np.arange(begin, end, math.ceil((end - begin) / SAMPLES_PER_AXIS), dtype=np.int64)


def _off_centre(pixels: NDArray[np.int64], low: float, high: float) -> NDArray[np.float64]:
    """How far pixels lie from the middle of a box's side: 0 there, 1 at its ends."""
    half = max((high - low) / 2.0, 0.5)
    return np.asarray(np.abs(pixels + 0.5 - (low + high) / 2.0) / half, dtype=np.float64)
