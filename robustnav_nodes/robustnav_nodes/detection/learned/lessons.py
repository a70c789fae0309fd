"""What the networks see in each step: batches of pictures, and of pieces of them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float32
from robustnav_nodes.detection.learned.augmentation import KEPT_MIN, lit_otherwise, mirrored_and_zoomed
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
# A look lesson has so many classes, looks of each, and pieces of each look.
CLASSES, LOOKS, PIECES = 6, 4, 4
LOOK_PX, LOOK_FRACTION, LOOK_SIDE_PX = 120, 0.45, 9.0
BOX_SHIFT, BOX_STRETCH = 0.08, 0.10


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
    """Batches for the looks: objects of few classes, several looks of each, seen several times each.

    Two objects have one look where class, colour, substance and pattern are the same, in whichever home; size
    is not told from a piece of an image.
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
        keys = np.column_stack([table.label, table.look[:, :3]])
        _, self._look = np.unique(keys, axis=0, return_inverse=True)
        rows = np.flatnonzero(clear)
        ordered = rows[np.argsort(self._look[rows], kind="stable")]
        firsts = np.unique(self._look[ordered], return_index=True)[1]
        views = np.split(ordered, firsts[1:])
        # A look that was seen once teaches nothing of what is the same.
        several = [at for at, own in enumerate(views) if len(own) >= PIECES]
        self._views = [views[at] for at in several]
        label_of = np.array([table.label[views[at][0]] for at in several], dtype=np.int64)
        of_class = [np.flatnonzero(label_of == label) for label in range(len(pictures.labels))]
        self._looks_of = [own for own in of_class if len(own) >= 2]

    def loss(self, _batch: int, rng: np.random.Generator) -> torch.Tensor:
        """Of one batch."""
        labels = rng.choice(len(self._looks_of), min(CLASSES, len(self._looks_of)), replace=False)
        chosen = np.concatenate(
            [
                rng.choice(self._views[look], PIECES, replace=False)
                for looks in (self._looks_of[label] for label in labels)
                for look in rng.choice(looks, min(LOOKS, len(looks)), replace=False)
            ]
        )
        table = self._pictures.objects
        numbers, image_of = np.unique(table.picture[chosen], return_inverse=True)
        images = as_images(self._pictures.pixels[numbers])
        box_px = _disturbed(table.box_px[chosen], rng)
        pieces = patches(images, torch.from_numpy(image_of), box_px)
        mirrored = torch.from_numpy(rng.random(len(pieces)) < 0.5)
        pieces = torch.where(mirrored[:, None, None, None], pieces.flip(3), pieces)
        pieces = lit_otherwise(pieces, rng).contiguous(memory_format=torch.channels_last)
        return look_loss(self._network(pieces).float(), torch.from_numpy(self._look[chosen]))


def _disturbed(box_px: Float32, rng: np.random.Generator) -> Float32:
    """Boxes as a detector gives them: shifted and stretched a little."""
    size = box_px[:, 2:] - box_px[:, :2]
    middle = (box_px[:, :2] + box_px[:, 2:]) / 2.0 + rng.normal(0.0, BOX_SHIFT, size.shape) * size
    size = size * np.exp(rng.normal(0.0, BOX_STRETCH, size.shape))
    return np.concatenate([middle - size / 2.0, middle + size / 2.0], axis=1).astype(np.float32)


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
