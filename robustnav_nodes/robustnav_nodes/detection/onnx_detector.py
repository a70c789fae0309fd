"""Any YOLO-style model in an ONNX file, through OpenCV."""

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import ColorImage
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.letterbox import GREY, Letterbox
from robustnav_nodes.detection.suppression import suppress
from robustnav_nodes.detection.yolo_outputs import Output, decoded


class OnnxDetector:
    """A PixelDetector. The model gets RGB in 0..1, letterboxed into a square; see `yolo_outputs`."""

    def __init__(
        self,
        path: Path,
        *,
        labels: Sequence[str],
        score_min: float,
        nms_iou: float,
        input_size_px: int,
    ) -> None:
        """Read the model and try it once. Raises BadFileError where it is none, or does not fit `labels`."""
        self.labels = tuple(labels)
        self._path = path
        self._score_min = score_min
        self._nms_iou = nms_iou
        self._side = input_size_px
        try:
            self._net = cv2.dnn.readNetFromONNX(str(path))
            self._outputs = self._net.getUnconnectedOutLayersNames()
        except cv2.error as error:
            raise BadFileError(
                f"cannot read the ONNX model {str(path)!r}; is it whole? {_said(error)}"
            ) from error
        grey = np.full((input_size_px, input_size_px, 3), GREY, dtype=np.uint8)
        try:
            decoded(self._run(grey), len(self.labels), self._score_min)
        except BadFileError as error:
            raise BadFileError(f"{str(path)!r}: {error}") from error

    def detect(self, image: ColorImage) -> Boxes:
        """See PixelDetector."""
        height, width = image.pixels.shape[:2]
        letterbox = Letterbox.of(width, height, self._side)
        outputs = self._run(letterbox.filled(image.pixels))
        found = decoded(outputs, len(self.labels), self._score_min)
        inside = Boxes(box_px=letterbox.back(found.box_px), score=found.score, label=found.label)
        return suppress(inside, self._nms_iou)

    def _run(self, square: NDArray[np.uint8]) -> list[Output]:
        self._net.setInput(cv2.dnn.blobFromImage(square, scalefactor=1.0 / 255.0))
        try:
            return [np.asarray(output, dtype=np.float32) for output in self._net.forward(self._outputs)]
        except cv2.error as error:
            raise BadFileError(
                f"the ONNX model does not run on {self._side} x {self._side} pixels; "
                f"is input_size_px what it was made for? {_said(error)}"
            ) from error


def _said(error: cv2.error) -> str:
    """What OpenCV says, in a line."""
    text = " ".join(str(error).split())
    return text if len(text) <= 200 else text[:197] + "..."
