"""One object alone is reported of its class: the one that looks like a picture."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("torch")

import cv2

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.parameters import build
from robustnav_msgs_py.values import ColorImage
from robustnav_nodes.detection.back_ends import make_detector, make_instance
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.learned.detector import LearnedDetector
from robustnav_nodes.detection.learned.wanted_instance import WantedInstance, read_picture
from robustnav_nodes.detection.learned.weights import Weights, load_weights
from robustnav_nodes.detection.parameters import DetectionParameters

MUG, BOOK = 0, 1  # also of those that come along
RED, BLUE = (200, 20, 20), (20, 40, 200)
UNKNOWN = np.full(3, np.nan, dtype=np.float32)


def picture(colour: tuple[int, int, int], height: int = 20, width: int = 20) -> ColorImage:
    pixels = np.full((height, width, 3), 255, dtype=np.uint8)
    pixels[1:-1, 1:-1] = colour
    return ColorImage(pixels=pixels, stamp_ns=0, frame_id="camera")


def shelf() -> tuple[ColorImage, Boxes]:
    """A red mug, a blue one, and a blue book."""
    pixels = np.full((40, 100, 3), 255, dtype=np.uint8)
    for left, colour in ((11, RED), (41, BLUE), (71, BLUE)):
        pixels[11:29, left : left + 18] = colour
    boxes = Boxes(
        box_px=np.array([[10, 10, 30, 30], [40, 10, 60, 30], [70, 10, 90, 30]], dtype=np.float32),
        score=np.full(3, 0.9, dtype=np.float32),
        label=np.array([MUG, MUG, BOOK], dtype=np.uint32),
    )
    return ColorImage(pixels=pixels, stamp_ns=0, frame_id="camera"), boxes


@pytest.mark.parametrize(("colour", "like", "unlike"), [(RED, 0, 1), (BLUE, 1, 0)])
def test_what_is_less_like_it_is_left_out_first_and_other_classes_never(
    colour: tuple[int, int, int], like: int, unlike: int
) -> None:
    wanted = WantedInstance(LearnedDetector(load_weights()), picture(colour), label="mug")
    image, boxes = shelf()
    kept = []
    for likeness_min in np.linspace(0.0, 1.0, 41):
        found = wanted.kept(image, boxes, UNKNOWN, float(likeness_min))
        kept.append([at for at in range(3) if boxes.box_px[at].tolist() in found.box_px.tolist()])
    assert kept[0] == [0, 1, 2]
    assert sorted([like, 2]) in kept
    assert sorted([unlike, 2]) not in kept
    assert kept[-1] == [2]


def test_an_image_without_boxes_is_none(untrained: Weights) -> None:
    wanted = WantedInstance(LearnedDetector(untrained), picture(RED), label="mug")
    image, boxes = shelf()
    assert len(wanted.kept(image, boxes[np.zeros(3, dtype=np.bool_)], UNKNOWN[:0], 0.5)) == 0


def test_where_nothing_of_the_class_is_found_the_picture_is_the_object(untrained: Weights) -> None:
    wanted = WantedInstance(LearnedDetector(untrained), picture(RED, 30, 50), label="book")
    assert wanted.label == BOOK
    assert wanted.told == "the book in the picture, all of it"


def test_a_finer_picture_shows_the_same_object() -> None:
    detector = LearnedDetector(load_weights())
    image, boxes = shelf()
    fine = ColorImage(pixels=image.pixels.repeat(4, axis=0).repeat(4, axis=1), stamp_ns=0, frame_id="camera")
    metres_per_px = np.full(3, 0.005, dtype=np.float32)
    looks = detector.embed(image, boxes.box_px, metres_per_px)
    finer = detector.embed(fine, 4.0 * boxes.box_px, metres_per_px / 4.0)
    assert ((looks * finer).sum(axis=1) > 0.99).all()


def test_which_object_is_meant_must_be_clear(untrained: Weights) -> None:
    detector = LearnedDetector(untrained)
    with pytest.raises(BadParameterError, match="say what it shows by instance_class"):
        WantedInstance(detector, picture(RED))
    with pytest.raises(BadParameterError, match="'unicorn' is no class of this detector; it knows mug, book"):
        WantedInstance(detector, picture(RED), label="unicorn")


def test_a_picture_that_is_none_is_named(tmp_path: Path) -> None:
    (tmp_path / "words.png").write_text("no picture")
    for path in (tmp_path / "words.png", tmp_path / "nowhere.png", tmp_path):
        with pytest.raises(BadFileError, match="is no picture that can be read"):
            read_picture(path)


def test_the_colours_of_a_picture_are_kept(tmp_path: Path) -> None:
    pixels = picture(RED).pixels
    cv2.imwrite(str(tmp_path / "red.png"), cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR))
    assert np.array_equal(read_picture(tmp_path / "red.png").pixels, pixels)


def test_parameters_ask_for_it(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "red.png"), cv2.cvtColor(picture(RED).pixels, cv2.COLOR_RGB2BGR))
    parameters = build(DetectionParameters, {"back_end": "learned"})
    detector = make_detector(parameters)
    assert make_instance(parameters, detector) is None
    asked = build(
        DetectionParameters,
        {"back_end": "learned", "instance_picture": str(tmp_path / "red.png"), "instance_class": "mug"},
    )
    wanted = make_instance(asked, detector)
    assert wanted is not None
    assert detector.labels[wanted.label] == "mug"


@pytest.mark.parametrize("back_end", ["onnx", "open_vocabulary"])
def test_only_the_learned_back_end_tells_one_from_another(back_end: str, untrained: Weights) -> None:
    parameters = build(DetectionParameters, {"back_end": back_end, "instance_picture": "mug.png"})
    with pytest.raises(BadParameterError, match=f"'{back_end}' cannot tell two objects of a class apart"):
        make_instance(parameters, LearnedDetector(untrained))
