"""What the networks see in each step: batches of pictures, and of pieces of them."""

from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Float32
from robustnav_nodes.detection.learned.augmentation import KEPT_MIN, lit_otherwise, mirrored_and_zoomed
from robustnav_nodes.detection.learned.extents import extents
from robustnav_nodes.detection.learned.gradient_workers import LossOfBatch
from robustnav_nodes.detection.learned.losses import detection_loss, look_loss, targets
from robustnav_nodes.detection.learned.network import STRIDE, DetectorNetwork, LookNetwork
from robustnav_nodes.detection.learned.patches import patches
from robustnav_nodes.detection.learned.training_pictures import PictureSet, load_pictures

BATCH = 8
# What shows less than this is neither taught nor counted as a mistake.
TAUGHT_PX, TAUGHT_FRACTION = 40, 0.30
# Of the pictures without an object, only some are looked at.
EMPTY_SHARE = 0.3
# A look lesson has so many classes, looks of each, and pieces of each look; the looks of a class have so many
# colours, substances, patterns and sizes between them, as look-alikes in a home have.
CLASSES, LOOKS, PIECES, ALIKE_CHOICES = 6, 5, 3, 2
LOOK_PX, LOOK_FRACTION, LOOK_SIDE_PX = 100, 0.45, 8.0
# How far off a detector is, as parts of a side.
BOX_SHIFT, BOX_STRETCH = 0.05, 0.08
# Depth is known in this part of the lessons, to within this (its logarithm).
P_DEPTH, DEPTH_OFF = 0.7, 0.03
# Which part of an object's look its size is; the last one.
SIZE = 3

# Colour, substance, pattern and size as numbers.
_Look = tuple[int, ...]


def as_images(pixels: NDArray[np.uint8]) -> torch.Tensor:
    """uint8 [n, height, width, 3] to float [n, 3, height, width] in 0..1, channels last in memory."""
    return torch.from_numpy(np.ascontiguousarray(pixels)).permute(0, 3, 1, 2).float() / 255.0


class DetectionLessons:
    """Batches for the detector: each picture once in every round, in another order each time."""

    def __init__(self, pictures: PictureSet, network: DetectorNetwork, seed: int) -> None:
        self._pictures = pictures
        self._network = network
        self._seed = seed
        shown = np.bincount(pictures.objects.picture, minlength=len(pictures)) > 0
        empty = np.flatnonzero(~shown)
        self._numbers = np.concatenate([np.flatnonzero(shown), empty[: int(EMPTY_SHARE * len(empty))]])

    def loss(self, batch: int, rng: np.random.Generator) -> torch.Tensor:
        """Of one batch."""
        rounds, at = divmod(batch, max(1, len(self._numbers) // BATCH))
        order = np.random.default_rng([self._seed, rounds]).permutation(self._numbers)
        numbers = np.sort(order[at * BATCH : (at + 1) * BATCH])
        table = self._pictures.objects
        rows = [table.rows_of(int(number)) for number in numbers]
        images = as_images(self._pictures.pixels[numbers])
        images, boxes, kept = mirrored_and_zoomed(images, [table.box_px[own] for own in rows], rng)
        taught = [
            (table.visible_px[own] >= TAUGHT_PX)
            & (table.visible_fraction[own] >= TAUGHT_FRACTION)
            & (part >= KEPT_MIN)
            for own, part in zip(rows, kept, strict=True)
        ]
        images = lit_otherwise(images, rng).contiguous(memory_format=torch.channels_last)
        logits, reach_px = self._network(images)
        shape = (len(numbers), self._network.classes, images.shape[2] // STRIDE, images.shape[3] // STRIDE)
        wanted = targets(boxes, [table.label[own] for own in rows], taught, shape)
        heat_loss, box_loss = detection_loss(logits.float(), reach_px.float(), wanted)
        return heat_loss + box_loss


class LookLessons:
    """Batches for the looks: of few classes several looks that are hard to tell apart, each seen repeatedly.

    Two objects have one look where class, colour, substance, pattern and size are the same, in any home. In
    part of the batches nobody knows how far things are; size is no part of the look then.
    """

    def __init__(self, pictures: PictureSet, network: LookNetwork) -> None:
        self._pictures = pictures
        self._network = network
        table = pictures.objects
        sides = table.box_px[:, 2:] - table.box_px[:, :2]
        clear = (
            (table.visible_px >= LOOK_PX)
            & (table.visible_fraction >= LOOK_FRACTION)
            & (sides.min(axis=1) >= LOOK_SIDE_PX)
        )
        seen: dict[int, dict[_Look, list[int]]] = defaultdict(lambda: defaultdict(list))
        for row in np.flatnonzero(clear).tolist():
            seen[int(table.label[row])][tuple(table.look[row].tolist())].append(row)
        # A look that was seen once teaches nothing of what is the same.
        self._views = [
            {look: np.array(rows) for look, rows in looks.items() if len(rows) >= 2}
            for _, looks in sorted(seen.items())
        ]
        self._views = [looks for looks in self._views if len(looks) >= 2]
        if not self._views:
            raise BadParameterError(
                "in these pictures no class shows two looks twice each: render more homes to learn looks from"
            )

    def loss(self, _batch: int, rng: np.random.Generator) -> torch.Tensor:
        """Of one batch."""
        rows = self._rows(rng)
        table = self._pictures.objects
        pixels = self._pictures.pixels
        box_px = _disturbed(table.box_px[rows], rng, pixels.shape[1:3])
        pieces = patches(pixels, table.picture[rows], box_px)
        mirrored = torch.from_numpy(rng.random(len(rows)) < 0.5)
        pieces = torch.where(mirrored[:, None, None, None], pieces.flip(3), pieces)
        pieces = lit_otherwise(pieces, rng).contiguous(memory_format=torch.channels_last)
        is_known = rng.random() < P_DEPTH
        metres_per_px = np.full(len(rows), np.nan, dtype=np.float32)
        if is_known:
            off = np.exp(rng.normal(0.0, DEPTH_OFF, len(rows)))
            metres_per_px = (table.ahead_m[rows] / table.focal_px[rows] * off).astype(np.float32)
        size = extents(box_px, metres_per_px, *pixels.shape[1:3])
        embeddings = self._network(pieces, torch.from_numpy(size)).float()
        keys = np.column_stack([table.label[rows], table.look[rows][:, : None if is_known else SIZE]])
        look = np.unique(keys, axis=0, return_inverse=True)[1]
        return look_loss(embeddings, torch.from_numpy(look.ravel()), torch.from_numpy(table.label[rows]))

    def _rows(self, rng: np.random.Generator) -> NDArray[np.int64]:
        """Of some classes, looks that share colours, substances, patterns and sizes, PIECES views of each."""
        chosen = []
        for number in rng.choice(len(self._views), min(CLASSES, len(self._views)), replace=False):
            views = self._views[number]
            looks = list(views)
            kept = [
                set(rng.permutation(sorted({look[part] for look in looks}))[:ALIKE_CHOICES].tolist())
                for part in range(len(looks[0]))
            ]
            alike = [look for look in looks if all(own in some for own, some in zip(look, kept, strict=True))]
            for at in rng.permutation(len(alike))[:LOOKS]:
                rows = views[alike[at]]
                chosen.append(rng.choice(rows, min(PIECES, len(rows)), replace=False))
        return np.concatenate(chosen) if chosen else self._rows(rng)


def _disturbed(box_px: Float32, rng: np.random.Generator, shape: tuple[int, int]) -> Float32:
    """Boxes as a detector gives them: shifted and stretched a little, inside of an image of this shape."""
    size = box_px[:, 2:] - box_px[:, :2]
    middle = (box_px[:, :2] + box_px[:, 2:]) / 2.0 + rng.normal(0.0, BOX_SHIFT, size.shape) * size
    size = size * np.exp(rng.normal(0.0, BOX_STRETCH, size.shape))
    corners = np.concatenate([middle - size / 2.0, middle + size / 2.0], axis=1)
    return np.clip(corners, 0.0, [shape[1], shape[0]] * 2).astype(np.float32)


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectionLoss:
    """Makes the detector's loss from pictures on the disk, in whichever process."""

    pictures: Path
    seed: int

    def __call__(self, network: DetectorNetwork) -> LossOfBatch:
        return DetectionLessons(load_pictures(self.pictures), network, self.seed).loss


@dataclass(frozen=True, slots=True, kw_only=True)
class LookLoss:
    """Makes the loss of the looks from pictures on the disk, in whichever process."""

    pictures: Path

    def __call__(self, network: LookNetwork) -> LossOfBatch:
        return LookLessons(load_pictures(self.pictures), network).loss
