"""The detector takes any image and its boxes lie inside; the matcher prefers what looks the same."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from robustnav_msgs_py.values import ColorImage, Float32  # noqa: E402
from robustnav_nodes.detection.learned.decoding import decode  # noqa: E402
from robustnav_nodes.detection.learned.detector import LearnedDetector  # noqa: E402
from robustnav_nodes.detection.learned.instance_matcher import InstanceMatcher  # noqa: E402
from robustnav_nodes.detection.learned.network import EMBEDDING  # noqa: E402
from robustnav_nodes.detection.learned.weights import Weights  # noqa: E402

RED, BLUE = (200, 20, 20), (20, 40, 200)


def image(height: int, width: int, seed: int = 0) -> ColorImage:
    pixels = np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)
    return ColorImage(pixels=pixels, stamp_ns=0, frame_id="camera")


@pytest.mark.parametrize("size", [(240, 320), (480, 640), (1, 1), (17, 333), (500, 3), (97, 101)])
def test_images_of_any_size_give_boxes_inside_of_them_best_first(
    untrained: Weights, size: tuple[int, int]
) -> None:
    boxes = LearnedDetector(untrained, score_min=0.0).detect(image(*size))
    assert (boxes.box_px[:, :2] >= 0.0).all()
    assert (boxes.box_px[:, 2:] <= np.array([size[1], size[0]], dtype=np.float32) + 1e-3).all()
    assert (np.diff(boxes.score) <= 0.0).all()
    assert set(boxes.label.tolist()) <= {0, 1}


def test_nothing_sure_enough_is_an_answer(untrained: Weights) -> None:
    black = ColorImage(pixels=np.zeros((240, 320, 3), dtype=np.uint8), stamp_ns=0, frame_id="camera")
    boxes = LearnedDetector(untrained, score_min=0.9).detect(black)
    assert len(boxes) == 0
    assert boxes.box_px.shape == (0, 4)


def test_the_same_image_gives_the_same_boxes(untrained: Weights) -> None:
    detector = LearnedDetector(untrained, score_min=0.0)
    first, second = detector.detect(image(240, 320)), detector.detect(image(240, 320))
    assert np.array_equal(first.box_px, second.box_px)
    assert np.array_equal(first.score, second.score)


def test_a_peak_becomes_the_box_around_its_cell_once() -> None:
    logits = torch.full((2, 8, 8), -9.0)
    logits[1, 3, 4] = 2.0
    logits[1, 3, 6] = 1.0  # another peak on the same object
    logits[0, 3, 4] = 1.5  # and another class
    reach = torch.full((4, 8, 8), 20.0)
    boxes = decode(logits, reach, 0.3)
    assert boxes.label.tolist() == [1, 0]
    assert boxes.box_px[0].tolist() == [-2.0, -6.0, 38.0, 34.0]
    assert boxes.score[0] == pytest.approx(1.0 / (1.0 + np.exp(-2.0)))


def test_embeddings_are_unit_vectors_and_no_boxes_give_none(untrained: Weights) -> None:
    detector = LearnedDetector(untrained)
    boxes = np.array([[0, 0, 20, 30], [-5, -5, 400, 300], [7, 7, 7, 7]], dtype=np.float32)
    looks = detector.embed(image(240, 320), boxes)
    assert looks.shape == (3, EMBEDDING)
    assert np.linalg.norm(looks, axis=1) == pytest.approx(np.ones(3), abs=1e-5)
    assert detector.embed(image(240, 320), boxes[:0]).shape == (0, EMBEDDING)


def two_things(left: tuple[int, int, int], right: tuple[int, int, int]) -> tuple[ColorImage, Float32]:
    pixels = np.full((100, 200, 3), 128, dtype=np.uint8)
    pixels[20:60, 20:60], pixels[20:60, 120:160] = left, right
    boxes = np.array([[20, 20, 60, 60], [120, 20, 160, 60]], dtype=np.float32)
    return ColorImage(pixels=pixels, stamp_ns=0, frame_id="camera"), boxes


def test_what_looks_the_same_scores_best_wherever_it_is(untrained: Weights) -> None:
    reference, boxes = two_things(RED, BLUE)
    matcher = InstanceMatcher(LearnedDetector(untrained), reference, boxes[0])
    swapped, _ = two_things(BLUE, RED)
    scores = matcher.scores(swapped, boxes)
    assert scores.argmax() == 1
    assert scores[1] == pytest.approx(1.0, abs=1e-3)
    assert ((scores >= 0.0) & (scores <= 1.0)).all()


def test_equal_looks_are_told_apart_by_height_where_it_is_known(untrained: Weights) -> None:
    seen, boxes = two_things(RED, RED)
    matcher = InstanceMatcher(LearnedDetector(untrained), seen, boxes[0], height_m=0.10)
    known = matcher.scores(seen, boxes, np.array([0.125, 0.10], dtype=np.float32))
    assert known[1] > known[0]
    unknown = matcher.scores(seen, boxes, np.array([np.nan, np.nan], dtype=np.float32))
    assert unknown == pytest.approx(1.0, abs=1e-4)
    never_known = InstanceMatcher(LearnedDetector(untrained), seen, boxes[0])
    heights = np.array([0.125, 0.10], dtype=np.float32)
    assert never_known.scores(seen, boxes, heights) == pytest.approx(1.0, abs=1e-4)


def test_what_is_mirrored_looks_the_same(untrained: Weights) -> None:
    seen = image(60, 80)
    mirrored = ColorImage(pixels=seen.pixels[:, ::-1].copy(), stamp_ns=0, frame_id="camera")
    box = np.array([[10, 10, 40, 50]], dtype=np.float32)
    other = np.array([[40, 10, 70, 50]], dtype=np.float32)
    detector = LearnedDetector(untrained)
    assert float(detector.embed(seen, box)[0] @ detector.embed(mirrored, other)[0]) > 1.0 - 1e-4
