"""Detections for tools that speak vision_msgs, where it is installed."""

import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robustnav_msgs_py.conversions.vision import VISION_PACKAGE, detections_to_vision, vision_available
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import CameraModel, Detections

CAMERA = CameraModel(width=64, height=48, fx=50.0, fy=50.0, cx=32.0, cy=24.0)
A_MUG = Detections(
    position_m=np.array([[0.5, -0.25, 2.0]], np.float32),
    score=np.array([0.75], np.float32),
    label=np.array([1], np.uint32),
    box_px=np.array([[10.0, 20.0, 20.0, 40.0]], np.float32),
    stamp_ns=7,
)


class _WithPose(SimpleNamespace):
    def __init__(self, **fields: Any) -> None:
        super().__init__(**fields, pose=SimpleNamespace())


def test_each_detection_is_a_hypothesis_in_a_box(monkeypatch: pytest.MonkeyPatch) -> None:
    if not vision_available():
        # Stands in for the package that only a ROS from apt has.
        package, messages = ModuleType(VISION_PACKAGE), ModuleType(f"{VISION_PACKAGE}.msg")
        for name in ("BoundingBox3D", "Detection3D", "Detection3DArray", "ObjectHypothesis"):
            setattr(messages, name, SimpleNamespace)
        messages.ObjectHypothesisWithPose = _WithPose  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, VISION_PACKAGE, package)
        monkeypatch.setitem(sys.modules, f"{VISION_PACKAGE}.msg", messages)
    array = detections_to_vision(A_MUG, ("book", "mug"), CAMERA)
    (found,) = array.detections
    assert array.header.stamp.nanosec == 7
    assert (found.results[0].hypothesis.class_id, found.results[0].hypothesis.score) == ("mug", 0.75)
    centre, size = found.bbox.center.position, found.bbox.size
    assert (centre.x, centre.y, centre.z) == (0.5, -0.25, 2.0)
    assert (size.x, size.y, size.z) == pytest.approx((0.4, 0.8, 0.4))


@pytest.mark.skipif(vision_available(), reason="there is a vision_msgs here")
def test_without_vision_msgs_a_sentence_says_so() -> None:
    with pytest.raises(BadMessageError, match="there is no vision_msgs here .* it comes with ROS from apt"):
        detections_to_vision(A_MUG, ("book", "mug"), CAMERA)
