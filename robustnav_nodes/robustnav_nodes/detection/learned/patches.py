"""Pieces of images, cut out around boxes: what the look of an object is told from."""

import numpy as np
import torch
from torch.nn import functional

from robustnav_msgs_py.values import Float32
from robustnav_nodes.detection.learned.network import PATCH_PX

# A piece reaches this much beyond the box.
AROUND = 1.15


def patches(images: torch.Tensor, image_of: torch.Tensor, box_px: Float32) -> torch.Tensor:
    """Cut boxes [k, 4] out of images (float [n, 3, h, w]), box i out of image_of[i].

    Gives [k, 3, PATCH_PX, PATCH_PX]. Each is stretched to a square; outside of the image, its
    edge is repeated.
    """
    height, width = images.shape[2:]
    size = np.array([width, height], dtype=np.float32)
    middle = (box_px[:, :2] + box_px[:, 2:]) / size - 1.0
    half = np.maximum(box_px[:, 2:] - box_px[:, :2], 1.0) * AROUND / size
    turn = np.zeros((len(box_px), 2, 3), dtype=np.float32)
    turn[:, 0, 0], turn[:, 1, 1], turn[:, :, 2] = half[:, 0], half[:, 1], middle
    # Twice as fine as needed, so that what is large does not lose its pattern.
    shape = [len(box_px), 3, 2 * PATCH_PX, 2 * PATCH_PX]
    grid = functional.affine_grid(torch.from_numpy(turn), shape, align_corners=False)
    fine = functional.grid_sample(
        images[image_of], grid, align_corners=False, padding_mode="border", mode="bilinear"
    )
    return functional.avg_pool2d(fine, 2)
