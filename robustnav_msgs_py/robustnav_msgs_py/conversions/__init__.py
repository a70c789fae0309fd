"""Pure pairs value <-> standard message; the only place that knows a message's fields.

`x_to_message(value)` and `x_from_message(message)` are inverse and exact. `x_from_message` reads fields by
name, so it takes rclpy's messages and those that rosbags decodes alike; a message that does not hold what
its type promises is refused with a BadMessageError.
"""

from robustnav_msgs_py.conversions.camera import (
    camera_from_message,
    camera_to_message,
    color_from_message,
    color_to_message,
    depth_from_message,
    depth_to_message,
)
from robustnav_msgs_py.conversions.clouds import (
    belief_from_message,
    belief_to_message,
    detections_from_message,
    detections_to_message,
    visible_from_message,
    visible_to_message,
)
from robustnav_msgs_py.conversions.flags import flag_from_message, flag_to_message
from robustnav_msgs_py.conversions.grids import map_from_message, map_to_message
from robustnav_msgs_py.conversions.markers import (
    detections_to_markers,
    objects_from_message,
    objects_to_message,
)
from robustnav_msgs_py.conversions.motion import (
    odometry_from_message,
    odometry_to_message,
    path_from_message,
    path_to_message,
    pose_from_message,
    pose_to_message,
    velocity_from_message,
    velocity_to_message,
)
from robustnav_msgs_py.conversions.scan import scan_from_message, scan_to_message
from robustnav_msgs_py.conversions.stamps import (
    NANOSECONDS,
    clock_from_message,
    clock_to_message,
    stamp_from_message,
    stamp_to_message,
)
from robustnav_msgs_py.conversions.status import (
    record_from_message,
    record_to_message,
    status_from_message,
    status_to_message,
)
from robustnav_msgs_py.conversions.text import (
    labels_from_message,
    labels_to_message,
    text_from_message,
    text_to_message,
)
from robustnav_msgs_py.conversions.transforms import (
    Transform,
    camera_transform,
    planar_transform,
    tf_available,
    tf_message,
    transform_from_message,
    transform_to_message,
)
from robustnav_msgs_py.conversions.vision import detections_to_vision, vision_available

__all__ = [
    "NANOSECONDS",
    "Transform",
    "belief_from_message",
    "belief_to_message",
    "camera_from_message",
    "camera_to_message",
    "camera_transform",
    "clock_from_message",
    "clock_to_message",
    "color_from_message",
    "color_to_message",
    "depth_from_message",
    "depth_to_message",
    "detections_from_message",
    "detections_to_markers",
    "detections_to_message",
    "detections_to_vision",
    "flag_from_message",
    "flag_to_message",
    "labels_from_message",
    "labels_to_message",
    "map_from_message",
    "map_to_message",
    "objects_from_message",
    "objects_to_message",
    "odometry_from_message",
    "odometry_to_message",
    "path_from_message",
    "path_to_message",
    "planar_transform",
    "pose_from_message",
    "pose_to_message",
    "record_from_message",
    "record_to_message",
    "scan_from_message",
    "scan_to_message",
    "stamp_from_message",
    "stamp_to_message",
    "status_from_message",
    "status_to_message",
    "text_from_message",
    "text_to_message",
    "tf_available",
    "tf_message",
    "transform_from_message",
    "transform_to_message",
    "velocity_from_message",
    "velocity_to_message",
    "visible_from_message",
    "visible_to_message",
    "vision_available",
]
