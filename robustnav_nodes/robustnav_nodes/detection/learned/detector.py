"""The learned back end: finds objects in an image, and tells this one from others that look alike."""

import numpy as np
import torch
from torch.nn import functional

from robustnav_msgs_py.values import ColorImage, Float32
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.learned.decoding import decode
from robustnav_nodes.detection.learned.extents import extents
from robustnav_nodes.detection.learned.network import EMBEDDING, MULTIPLE
from robustnav_nodes.detection.learned.patches import patches
from robustnav_nodes.detection.learned.weights import Weights

# Images are brought to the size that the network was trained with.
LONG_SIDE_PX = 320
SCORE_MIN = 0.3
SIDE_MIN_PX = 1.0


class LearnedDetector:
    """Satisfies PixelDetector. Used from one thread; images of any size cost about the same."""

    def __init__(self, weights: Weights, score_min: float = SCORE_MIN) -> None:
        """`score_min`: what is less sure is not told."""
        self.labels = weights.labels
        self._detector = weights.detector
        self._look = weights.look
        self._score_min = score_min

    def detect(self, image: ColorImage) -> Boxes:
        """The objects in an RGB image of any size, best first; boxes end at the edges of the image."""
        whole = _as_image(image)
        height, width = whole.shape[2:]
        scale = LONG_SIDE_PX / max(height, width)
        rows, columns = max(1, round(height * scale)), max(1, round(width * scale))
        if (rows, columns) != (height, width):
            whole = functional.interpolate(whole, (rows, columns), mode="bilinear", antialias=True)
        padded = functional.pad(whole, (0, -columns % MULTIPLE, 0, -rows % MULTIPLE))
        with torch.inference_mode():
            logits, reach_px = self._detector(padded.contiguous(memory_format=torch.channels_last))
            found = decode(logits[0], reach_px[0], self._score_min)
        size = np.array([columns, rows] * 2, dtype=np.float32)
        own_size = np.array([width, height] * 2, dtype=np.float32)
        box_px = (np.clip(found.box_px, 0.0, size) * (own_size / size)).astype(np.float32)
        real = (box_px[:, 2:] - box_px[:, :2] >= SIDE_MIN_PX).all(axis=1)
        return Boxes(box_px=box_px[real], score=found.score[real], label=found.label[real])

    def embed(self, image: ColorImage, box_px: Float32, metres_per_px: Float32 | None = None) -> Float32:
        """The looks of what is in boxes [n, 4]: unit vectors [n, EMBEDDING]; products are likenesses.

        metres_per_px [n]: depth over focal length, NaN where not known. What is mirrored looks the same: both
        ways of seeing it count alike.
        """
        count = len(box_px)
        if count == 0:
            return np.zeros((0, EMBEDDING), dtype=np.float32)
        box_px = np.asarray(box_px, dtype=np.float32)
        if metres_per_px is None:
            metres_per_px = np.full(count, np.nan, dtype=np.float32)
        pixels = np.ascontiguousarray(image.pixels)
        # Sides count in pixels of an image as large as those that it was trained on.
        rows, columns = pixels.shape[:2]
        scale = np.float32(LONG_SIDE_PX / max(rows, columns))
        sides = extents(box_px * scale, metres_per_px / scale, round(rows * scale), round(columns * scale))
        size = torch.from_numpy(sides)
        with torch.inference_mode():
            pieces = patches(pixels[None], [0] * count, box_px)
            both = torch.cat([pieces, pieces.flip(3)]).contiguous(memory_format=torch.channels_last)
            looks = self._look(both, size.repeat(2, 1)).unflatten(0, (2, -1)).sum(dim=0)
        return np.asarray(functional.normalize(looks, dim=1).numpy(), dtype=np.float32)


def _as_image(image: ColorImage) -> torch.Tensor:
    pixels = torch.from_numpy(np.ascontiguousarray(image.pixels))
    return pixels.permute(2, 0, 1)[None].float() / 255.0
