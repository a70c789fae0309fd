"""Detections as vision_msgs/Detection3DArray, for tools that speak it."""

from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any

from robustnav_msgs_py.conversions.stamps import header
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.message_types import Point, Pose, Quaternion, Vector3
from robustnav_msgs_py.values import CameraModel, Detections

# Part of every ROS from apt, and of no wheel.
VISION_PACKAGE = "vision_msgs"


def vision_available() -> bool:
    """Whether there is a Detection3DArray to publish: in a ROS from apt, not among the wheels."""
    return find_spec(VISION_PACKAGE) is not None


def detections_to_vision(detections: Detections, labels: Sequence[str], camera: CameraModel) -> Any:
    """A vision_msgs/Detection3DArray; raises BadMessageError where there is no vision_msgs.

    Each has one hypothesis. The boxes are as wide and high as in the image and, as nobody knows how deep the
    objects are, as deep as wide.
    """
    try:
        from vision_msgs.msg import (
            BoundingBox3D,
            Detection3D,
            Detection3DArray,
            ObjectHypothesis,
            ObjectHypothesisWithPose,
        )
    except ImportError as error:
        raise BadMessageError(
            f"there is no {VISION_PACKAGE} here ({error}), so nothing can go to detections/vision; "
            "it comes with ROS from apt"
        ) from error
    top = header(detections.stamp_ns, detections.frame_id)
    found = []
    rows = zip(detections.position_m, detections.box_px, detections.score, detections.label, strict=True)
    for (x, y, z), (u_min, v_min, u_max, v_max), score, label in rows:
        pose = Pose(position=Point(x=float(x), y=float(y), z=float(z)), orientation=Quaternion(w=1.0))
        width_m, height_m = float((u_max - u_min) * z / camera.fx), float((v_max - v_min) * z / camera.fy)
        result = ObjectHypothesisWithPose(
            hypothesis=ObjectHypothesis(class_id=labels[int(label)], score=float(score))
        )
        result.pose.pose = pose
        size = Vector3(x=width_m, y=height_m, z=width_m)
        found.append(
            Detection3D(header=top, results=[result], bbox=BoundingBox3D(center=pose, size=size), id="")
        )
    return Detection3DArray(header=top, detections=found)
