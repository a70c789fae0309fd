"""A piece of an image shows what its box is around, stretched to a square."""

import numpy as np
import pytest

pytest.importorskip("torch")

from robustnav_nodes.detection.learned.network import PATCH_PX
from robustnav_nodes.detection.learned.patches import AROUND, patches


def test_a_piece_shows_what_its_box_is_around() -> None:
    images = np.zeros((2, 100, 200, 3), dtype=np.uint8)
    images[1, 20:60, 100:140] = (255, 0, 0)
    images[1, 20:60, 140:180] = (0, 0, 255)
    box = np.array([[100.0, 20.0, 180.0, 60.0]], dtype=np.float32)
    piece = patches(images, [1], box)[0].numpy()
    assert piece.shape == (3, PATCH_PX, PATCH_PX)
    half = PATCH_PX // 2
    middle = slice(PATCH_PX // 4, 3 * PATCH_PX // 4)
    assert piece[0, middle, half - 8 : half - 2] == pytest.approx(1.0)
    assert piece[2, middle, half + 2 : half + 8] == pytest.approx(1.0)
    assert piece[:, 0, :] == pytest.approx(0.0)  # what lies around the box belongs to the piece
    shown = (piece.sum(axis=0) > 0.5).mean()
    assert shown == pytest.approx(1.0 / AROUND**2, abs=0.05)


def test_outside_of_the_image_its_edge_goes_on() -> None:
    images = np.full((1, 40, 40, 3), 200, dtype=np.uint8)
    box = np.array([[-20.0, -20.0, 10.0, 10.0], [30.0, 30.0, 31.0, 31.0]], dtype=np.float32)
    assert patches(images, [0, 0], box).numpy() == pytest.approx(200.0 / 255.0)


def test_no_boxes_are_no_pieces() -> None:
    images = np.zeros((1, 8, 8, 3), dtype=np.uint8)
    assert patches(images, [], np.zeros((0, 4), dtype=np.float32)).shape == (0, 3, PATCH_PX, PATCH_PX)
