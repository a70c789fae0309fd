"""Changes to pictures that leave what they show as it is: mirrored, nearer, lit and coloured otherwise."""

import numpy as np
import torch
from torch.nn import functional

from robustnav_msgs_py.values import Float32, Float64

# How much nearer or farther, how much brighter, and how far off the balance of the colours.
ZOOM, BRIGHTNESS, BALANCE, CONTRAST = (0.85, 1.45), (0.65, 1.30), (0.95, 1.05), (0.80, 1.20)
P_ZOOM, P_LIGHT = 0.5, 0.7
# An object of which less than this part stays in the picture is not taught.
KEPT_MIN = 0.4


def mirrored_and_zoomed(
    images: torch.Tensor, boxes: list[Float32], rng: np.random.Generator
) -> tuple[torch.Tensor, list[Float32], list[Float32]]:
    """Mirror half of the images (float [n, 3, h, w]) and look nearer at half of them.

    Gives also the boxes, cut at the edges, and which part of each is left: float32 [k] for each image.
    """
    height, width = images.shape[2:]
    zoom = np.where(
        rng.random(len(images)) < P_ZOOM, np.exp(_uniform(rng, np.log(ZOOM), (len(images),))), 1.0
    )
    mirror = np.where(rng.random(len(images)) < 0.5, -1.0, 1.0)
    # The middle of what is seen, in -1..1, so that nearer ones stay inside of the picture.
    middle = rng.uniform(-1.0, 1.0, (len(images), 2)) * np.abs(1.0 - 1.0 / zoom)[:, None]
    turn = np.zeros((len(images), 2, 3), dtype=np.float32)
    turn[:, 0, 0], turn[:, 1, 1], turn[:, :, 2] = mirror / zoom, 1.0 / zoom, middle
    grid = functional.affine_grid(torch.from_numpy(turn), list(images.shape), align_corners=False)
    changed = functional.grid_sample(images, grid, align_corners=False)
    size = np.array([width, height], dtype=np.float64)
    moved, kept = [], []
    for at, own in enumerate(boxes):
        scale = np.array([mirror[at] * zoom[at], zoom[at]])
        corners = own.reshape(-1, 2, 2).astype(np.float64) / size * 2.0 - 1.0
        corners = ((corners - middle[at]) * scale + 1.0) / 2.0 * size
        corners = np.sort(corners, axis=1)
        cut = np.clip(corners, 0.0, size)
        part = np.prod(cut[:, 1] - cut[:, 0], axis=1) / np.prod(corners[:, 1] - corners[:, 0], axis=1)
        moved.append(cut.reshape(-1, 4).astype(np.float32))
        kept.append(part.astype(np.float32))
    return changed, moved, kept


def lit_otherwise(images: torch.Tensor, rng: np.random.Generator) -> torch.Tensor:
    """Most of the images (float [n, 3, h, w] in 0..1) brighter or darker, flatter or harder, tinted."""
    count = len(images)
    gain = _uniform(rng, np.log(BRIGHTNESS), (count, 1)) + _uniform(rng, np.log(BALANCE), (count, 3))
    contrast = rng.uniform(*CONTRAST, (count, 1))
    changed = rng.random((count, 1)) < P_LIGHT
    gain, contrast = np.where(changed, np.exp(gain), 1.0), np.where(changed, contrast, 1.0)
    factor = torch.from_numpy((gain * contrast).astype(np.float32))[:, :, None, None]
    shift = torch.from_numpy((0.5 * gain * (1.0 - contrast)).astype(np.float32))[:, :, None, None]
    return (images * factor + shift).clamp(0.0, 1.0)


def _uniform(rng: np.random.Generator, bounds: Float64, shape: tuple[int, ...]) -> Float64:
    return rng.uniform(float(bounds[0]), float(bounds[1]), shape)
