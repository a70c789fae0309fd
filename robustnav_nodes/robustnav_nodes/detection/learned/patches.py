"""Pieces of images, cut out around boxes: what the look of an object is told from."""

from collections.abc import Sequence

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float32
from robustnav_nodes.detection.learned.network import PATCH_PX

# A piece's sides are this many times those of its box.
AROUND = 1.3
# So much finer than needed it is cut at first, so that what is large does not lose its pattern.
FINER = 2


def patches(
    images: NDArray[np.uint8], image_of: Sequence[int] | NDArray[np.int32], box_px: Float32
) -> torch.Tensor:
    """Cut boxes [k, 4] out of images (uint8 [n, height, width, 3]), box i out of image_of[i].

    Gives float [k, 3, PATCH_PX, PATCH_PX] in 0..1. Each is stretched to a square; outside of the image, its
    edge is repeated.
    """
    found = np.empty((len(box_px), PATCH_PX, PATCH_PX, 3), dtype=np.uint8)
    fine_px = FINER * PATCH_PX
    for at, (box, number) in enumerate(zip(box_px, image_of, strict=True)):
        size = np.maximum(box[2:] - box[:2], 1.0) * AROUND
        step = size / fine_px
        # Coordinates of boxes count from the corner of the first pixel, those of cv2 from its middle.
        first = (box[:2] + box[2:] - size + step) / 2.0 - 0.5
        turn = np.array([[step[0], 0.0, first[0]], [0.0, step[1], first[1]]], dtype=np.float32)
        fine = cv2.warpAffine(
            images[number],
            turn,
            (fine_px, fine_px),
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
            borderMode=cv2.BORDER_REPLICATE,
        )
        found[at] = cv2.resize(fine, (PATCH_PX, PATCH_PX), interpolation=cv2.INTER_AREA)
    return torch.from_numpy(found).permute(0, 3, 1, 2).float() / 255.0
