"""Tells *this* mug from other mugs, given one picture of it."""

import numpy as np

from robustnav_msgs_py.values import ColorImage, Float32
from robustnav_nodes.detection.learned.detector import LearnedDetector

# A height that differs by this factor (its logarithm) is as telling as a likeness that is less by LIKENESS.
HEIGHT_LOG, LIKENESS = 0.12, 0.03
# What another view or a hidden part may cost at most, in likeness.
HEIGHT_COST_MAX = 0.3
# A box that ends so near to the upper or lower edge of its image may go on beyond it.
EDGE_PX = 1.0


class InstanceMatcher:
    """Scores boxes by how much they look like one reference. Used from one thread."""

    def __init__(
        self,
        detector: LearnedDetector,
        image: ColorImage,
        box_px: Float32,
        height_m: float | None = None,
    ) -> None:
        """The reference is what is in `box_px` [4] of `image`; `height_m`, where its depth is known.

        The height is that of the box at the object's depth: (v_max - v_min) * depth / fy.
        """
        self._detector = detector
        box = np.asarray(box_px, dtype=np.float32)[None]
        self._reference = detector.embed(image, box)[0]
        self._height_m = np.nan
        if height_m is not None:
            known = whole_height_m(box, np.array([height_m], dtype=np.float32), image.pixels.shape[0])
            self._height_m = float(known[0])

    def scores(self, image: ColorImage, box_px: Float32, height_m: Float32 | None = None) -> Float32:
        """For boxes [n, 4] how sure it is that each is the one, float32 [n] in 0..1.

        Without heights (float32 [n], NaN where unknown) things that differ in size alone look the same.
        """
        likeness = self._detector.embed(image, box_px) @ self._reference
        if height_m is not None:
            known = whole_height_m(box_px, height_m, image.pixels.shape[0])
            likeness = likeness - height_cost(known, self._height_m)
        return np.clip((1.0 + likeness) / 2.0, 0.0, 1.0).astype(np.float32)


def whole_height_m(box_px: Float32, height_m: Float32, rows: int) -> Float32:
    """The heights [n] of boxes [n, 4] in images of so many rows; NaN where one is cut at the edge."""
    cut = (box_px[:, 1] <= EDGE_PX) | (box_px[:, 3] >= rows - EDGE_PX)
    return np.where(cut, np.nan, height_m).astype(np.float32)


def height_cost(height_m: Float32, reference_m: float) -> Float32:
    """By how much another height lessens the likeness: float32 [n]; 0 where either is unknown (NaN)."""
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.log(height_m / reference_m) / HEIGHT_LOG
    cost = np.minimum(LIKENESS * off**2, HEIGHT_COST_MAX)
    return np.nan_to_num(cost, nan=0.0).astype(np.float32)
