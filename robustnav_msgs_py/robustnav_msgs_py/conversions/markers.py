"""Objects and detections as visualization_msgs/MarkerArray, to look at and (objects) to read back."""

from collections.abc import Sequence
from typing import Any

from robustnav_msgs_py.conversions.motion import quaternion, yaw_rad
from robustnav_msgs_py.conversions.stamps import header
from robustnav_msgs_py.message_types import ColorRGBA, Duration, Marker, MarkerArray, Point, Pose, Vector3
from robustnav_msgs_py.values import Detections, ObjectInstance

_OBJECT_COLOR = ColorRGBA(r=0.2, g=0.6, b=0.9, a=0.7)
_DETECTION_COLOR = ColorRGBA(r=1.0, g=0.6, b=0.1, a=0.9)
_TEXT_HEIGHT_M = 0.12
_DETECTION_SIZE_M = 0.1


def objects_to_message(objects: Sequence[ObjectInstance], stamp_ns: int = 0) -> MarkerArray:
    """One cube per object; its namespace is the class, its id the instance, its text the attributes."""
    return MarkerArray(
        markers=[
            Marker(
                header=header(stamp_ns, "map"),
                ns=item.label,
                id=item.instance,
                type=Marker.CUBE,
                action=Marker.ADD,
                pose=Pose(
                    position=Point(x=float(item.x_m), y=float(item.y_m), z=float(item.z_m)),
                    orientation=quaternion(item.yaw_rad),
                ),
                scale=Vector3(x=float(item.size_m[0]), y=float(item.size_m[1]), z=float(item.size_m[2])),
                color=_OBJECT_COLOR,
                text="; ".join(f"{name}: {value}" for name, value in item.attributes),
            )
            for item in objects
        ]
    )


def objects_from_message(message: Any) -> tuple[ObjectInstance, ...]:
    """Read what `objects_to_message` wrote."""
    return tuple(
        ObjectInstance(
            instance=int(marker.id),
            label=marker.ns,
            x_m=float(marker.pose.position.x),
            y_m=float(marker.pose.position.y),
            z_m=float(marker.pose.position.z),
            yaw_rad=yaw_rad(marker.pose.orientation),
            size_m=(float(marker.scale.x), float(marker.scale.y), float(marker.scale.z)),
            attributes=_attributes(marker.text),
        )
        for marker in message.markers
    )


def _attributes(text: str) -> tuple[tuple[str, str], ...]:
    pairs = (pair.partition(": ") for pair in text.split("; ") if pair)
    return tuple((name, value) for name, separator, value in pairs if separator)


def detections_to_markers(detections: Detections, labels: Sequence[str], lifetime_s: int) -> MarkerArray:
    """A name and a ball per detection, in the optical frame; each fades after `lifetime_s`."""
    markers = []
    for index in range(len(detections)):
        x, y, z = (float(value) for value in detections.position_m[index])
        shared = {
            "header": header(detections.stamp_ns, detections.frame_id),
            "action": Marker.ADD,
            "id": index,
            "pose": Pose(position=Point(x=x, y=y, z=z), orientation=quaternion(0.0)),
            "color": _DETECTION_COLOR,
            "lifetime": Duration(sec=lifetime_s),
        }
        ball = Vector3(x=_DETECTION_SIZE_M, y=_DETECTION_SIZE_M, z=_DETECTION_SIZE_M)
        name = f"{labels[detections.label[index]]} {detections.score[index]:.2f}"
        markers.append(Marker(ns="place", type=Marker.SPHERE, scale=ball, **shared))
        markers.append(
            Marker(
                ns="name", type=Marker.TEXT_VIEW_FACING, scale=Vector3(z=_TEXT_HEIGHT_M), text=name, **shared
            )
        )
    return MarkerArray(markers=markers)
