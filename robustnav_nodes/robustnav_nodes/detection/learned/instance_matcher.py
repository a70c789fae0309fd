"""Tells *this* mug from other mugs, given one picture of it."""

import numpy as np

from robustnav_msgs_py.values import ColorImage, Float32
from robustnav_nodes.detection.learned.detector import LearnedDetector


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
        known = np.array([np.nan if height_m is None else height_m], dtype=np.float32)
        metres_per_px = _metres_per_px(box, known)
        self._by_look = detector.embed(image, box)[0]
        self._by_both = detector.embed(image, box, metres_per_px)[0]
        self._is_known = bool(np.isfinite(metres_per_px[0]))

    def scores(self, image: ColorImage, box_px: Float32, height_m: Float32 | None = None) -> Float32:
        """For boxes [n, 4] how sure it is that each is the one, float32 [n] in 0..1.

        Where the height of either is not known (float32 [n], NaN) they are compared by look alone: what
        differs in size only is the same then.
        """
        metres_per_px = np.full(len(box_px), np.nan, dtype=np.float32)
        if height_m is not None and self._is_known:
            metres_per_px = _metres_per_px(box_px, height_m)
        looks = self._detector.embed(image, box_px, metres_per_px)
        references = np.where(np.isfinite(metres_per_px)[:, None], self._by_both, self._by_look)
        return np.clip((1.0 + (looks * references).sum(axis=1)) / 2.0, 0.0, 1.0).astype(np.float32)


def _metres_per_px(box_px: Float32, height_m: Float32) -> Float32:
    return (height_m / np.maximum(box_px[:, 3] - box_px[:, 1], 1.0)).astype(np.float32)
