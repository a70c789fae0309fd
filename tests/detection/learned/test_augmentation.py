"""Boxes stay on what they are around, and pictures stay pictures."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from robustnav_nodes.detection.learned.augmentation import (  # noqa: E402
    ZOOM,
    lit_otherwise,
    mirrored_and_zoomed,
)


@pytest.mark.parametrize("seed", range(6))
def test_a_box_moves_with_what_it_is_around(seed: int) -> None:
    images = torch.zeros(4, 3, 96, 128)
    images[:, :, 40:56, 60:80] = 1.0
    box = np.array([[60, 40, 80, 56]], dtype=np.float32)
    changed, boxes, kept = mirrored_and_zoomed(images, [box] * 4, np.random.default_rng(seed))
    for image, moved, part in zip(changed, boxes, kept, strict=True):
        rows, columns = np.nonzero(image[0].numpy() > 0.5)
        if part[0] < 0.99:
            continue
        around = (columns.min(), rows.min(), columns.max() + 1, rows.max() + 1)
        assert moved[0] == pytest.approx(np.array(around), abs=1.0)


def test_what_is_cut_off_says_how_much_is_left() -> None:
    whole = np.array([[0.0, 0.0, 128.0, 96.0]], dtype=np.float32)
    _, boxes, kept = mirrored_and_zoomed(torch.zeros(32, 3, 96, 128), [whole] * 32, np.random.default_rng(0))
    moved, part = np.concatenate(boxes), np.concatenate(kept)
    assert (moved >= 0.0).all()
    assert (moved[:, 2:] <= (128.0, 96.0)).all()
    assert part.min() == pytest.approx(1.0 / ZOOM[1] ** 2, abs=0.1)
    assert part.max() == 1.0


def test_images_without_objects_are_changed_too() -> None:
    none = np.zeros((0, 4), dtype=np.float32)
    _, boxes, kept = mirrored_and_zoomed(torch.zeros(2, 3, 32, 32), [none] * 2, np.random.default_rng(0))
    assert [len(own) for own in (*boxes, *kept)] == [0, 0, 0, 0]


def test_other_light_stays_within_what_a_picture_can_hold() -> None:
    images = torch.rand(32, 3, 8, 8)
    changed = lit_otherwise(images, np.random.default_rng(0))
    assert float(changed.min()) >= 0.0
    assert float(changed.max()) <= 1.0
    assert not torch.equal(changed, images)
