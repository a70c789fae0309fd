"""An image in a square that a model looks at, and boxes from there back in the image."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from robustnav_msgs_py.values import Float32

GREY = 114  # what the YOLO family was trained to see beside an image


@dataclass(frozen=True, slots=True, kw_only=True)
class Letterbox:
    """How an image of width x height lies in the square: `scale` times as large, from (left, top)."""

    width: int
    height: int
    side: int
    scale: float
    left: int
    top: int

    @classmethod
    def of(cls, width: int, height: int, side: int) -> "Letterbox":
        """As large as it fits, in the middle."""
        scale = min(side / width, side / height)
        wide, high = max(1, round(width * scale)), max(1, round(height * scale))
        return cls(
            width=width,
            height=height,
            side=side,
            scale=scale,
            left=(side - wide) // 2,
            top=(side - high) // 2,
        )

    def filled(self, pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """uint8 [side, side, 3]: the image with grey beside it."""
        wide, high = max(1, round(self.width * self.scale)), max(1, round(self.height * self.scale))
        resized = Image.fromarray(pixels).resize((wide, high), Image.Resampling.BILINEAR)
        square = np.full((self.side, self.side, 3), GREY, dtype=np.uint8)
        square[self.top : self.top + high, self.left : self.left + wide] = np.asarray(resized)
        return square

    def back(self, box_px: Float32) -> Float32:
        """Boxes [n, 4] of the square in the image, cut off at its edges."""
        moved = (box_px - np.array([self.left, self.top] * 2)) / self.scale
        limits = np.array([self.width, self.height] * 2)
        return np.asarray(np.clip(moved, 0.0, limits), dtype=np.float32)
