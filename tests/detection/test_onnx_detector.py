"""ONNX models that are built here and say what they were told to, depending on what they see."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import ColorImage
from robustnav_nodes.detection.pixel_detector import PixelDetector
from robustnav_nodes.detection.yolo_outputs import decoded

SIDE = 64
LABELS = ("mug", "book")
# cx, cy, w, h in the square; scores of a mug and a book. The second overlaps the first by 2/3.
SAID = np.array(
    [
        [32.0, 32.0, 20.0, 20.0, 0.9, 0.1],
        [34.0, 32.0, 20.0, 20.0, 0.8, 0.1],
        [10.0, 40.0, 8.0, 8.0, 0.0, 0.7],
        [50.0, 20.0, 8.0, 8.0, 0.2, 0.1],
        [50.0, 20.0, 0.0, 8.0, 0.9, 0.1],
    ],
    np.float32,
)


def model_that_says(path: Path, said: np.ndarray, *, sees: bool = False) -> Path:
    """A model whose output is `said`; its scores (of version 8) times the mean of red where it `sees`."""
    onnx = pytest.importorskip("onnx")
    from onnx import TensorProto, helper, numpy_helper

    weight = np.zeros((1, 3, 1, 1), np.float32)
    weight[0, 0] = 1.0
    factor = np.zeros_like(said)
    constant = said.copy()
    if sees:
        factor[:, 4:], constant[:, 4:] = said[:, 4:], 0.0
    nodes = [
        helper.make_node("Conv", ["image", "weight"], ["red"]),
        helper.make_node("GlobalAveragePool", ["red"], ["mean"]),
        helper.make_node("Reshape", ["mean", "shape"], ["flat"]),
        helper.make_node("Mul", ["flat", "factor"], ["part"]),
        helper.make_node("Add", ["part", "constant"], ["output0"]),
    ]
    initial = {"weight": weight, "factor": factor, "constant": constant, "shape": np.array([1, 1, 1])}
    graph = helper.make_graph(
        nodes,
        "tiny",
        [helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 3, SIDE, SIDE])],
        [helper.make_tensor_value_info("output0", TensorProto.FLOAT, list(said.shape))],
        [numpy_helper.from_array(value, name) for name, value in initial.items()],
    )
    made = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 13)])
    made.ir_version = 8
    onnx.save(made, path)
    return path


def detector(path: Path, **changes: Any) -> PixelDetector:
    pytest.importorskip("cv2")
    from robustnav_nodes.detection.onnx_detector import OnnxDetector

    chosen: dict[str, Any] = {"labels": LABELS, "score_min": 0.3, "nms_iou": 0.5, "input_size_px": SIDE}
    return OnnxDetector(path, **(chosen | changes))


def image(width: int, height: int, color: tuple[int, int, int] = (255, 0, 0)) -> ColorImage:
    pixels = np.full((height, width, 3), color, np.uint8)
    return ColorImage(pixels=pixels, stamp_ns=1, frame_id="c")


def version_8(rows: np.ndarray) -> np.ndarray:
    return rows.T[np.newaxis]


def version_5(rows: np.ndarray) -> np.ndarray:
    """Scores are the product of the fifth number and the class's."""
    split = np.concatenate([rows[:, :4], np.full((len(rows), 1), 0.9), rows[:, 4:] / 0.9], axis=1)
    return split[np.newaxis].astype(np.float32)


@pytest.mark.parametrize("layout", [version_8, version_5])
def test_boxes_of_both_layouts_come_back_in_the_image(tmp_path: Path, layout: Any) -> None:
    """An image twice as wide as high lies in the middle half of the square, at half its size."""
    found = detector(model_that_says(tmp_path / "m.onnx", layout(SAID))).detect(image(128, 64))
    assert found.label.tolist() == [0, 1]
    np.testing.assert_allclose(found.score, [0.9, 0.7], atol=1e-6)
    np.testing.assert_allclose(found.box_px, [[44, 12, 84, 52], [12, 40, 28, 56]], atol=1e-4)


def test_the_model_sees_rgb_in_0_to_1_with_grey_beside_it(tmp_path: Path) -> None:
    """A square image fills the square: full red is 1; one that is half grey has (1 + 114/255) / 2."""
    seeing = detector(model_that_says(tmp_path / "m.onnx", version_8(SAID), sees=True))
    np.testing.assert_allclose(seeing.detect(image(64, 64)).score, [0.9, 0.7], atol=1e-5)
    mean = (1.0 + 114.0 / 255.0) / 2.0
    np.testing.assert_allclose(seeing.detect(image(128, 64)).score, [0.9 * mean, 0.7 * mean], atol=1e-5)
    assert len(seeing.detect(image(64, 64, (0, 0, 255)))) == 0


def test_boxes_are_cut_off_at_the_edges_of_an_odd_image(tmp_path: Path) -> None:
    found = detector(model_that_says(tmp_path / "m.onnx", version_8(SAID))).detect(image(31, 7))
    assert (found.box_px >= 0).all()
    assert (found.box_px[:, 2] <= 31).all()
    assert (found.box_px[:, 3] <= 7).all()


def test_a_wrong_class_list_is_refused_when_the_model_is_read(tmp_path: Path) -> None:
    path = model_that_says(tmp_path / "m.onnx", version_8(SAID))
    with pytest.raises(BadFileError, match=r"output is \[1, 6, 5\]; with 3 class names.*\[1, 7, n\]"):
        detector(path, labels=("mug", "book", "pen"))


def test_a_truncated_model_is_refused(tmp_path: Path) -> None:
    path = model_that_says(tmp_path / "m.onnx", version_8(SAID))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with pytest.raises(BadFileError, match="is it whole"):
        detector(path)
    path.write_text("no model")
    with pytest.raises(BadFileError, match="is it whole"):
        detector(path)


def test_numbers_that_are_none_are_no_boxes() -> None:
    broken = SAID.copy()
    broken[0, 0], broken[1, 4] = np.nan, np.inf
    found = decoded([version_8(broken)], 2, 0.3)
    assert found.score.tolist() == pytest.approx([0.7])
