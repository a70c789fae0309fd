"""The tree of frames: map -> odom -> base_link -> the sensors', as geometry_msgs and tf2_msgs."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

from robustnav_msgs_py.conversions.stamps import header, stamp_from_message
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.message_types import Quaternion, TransformStamped, Vector3
from robustnav_msgs_py.message_types import Transform as TransformMessage
from robustnav_msgs_py.values import Pose2D

# Part of every ROS from apt, and of no wheel.
TF_PACKAGE = "tf2_msgs"
UNIT_TOLERANCE = 1e-3

BASE_FRAME = "base_link"
OPTICAL_FRAME = "camera_optical_frame"


@dataclass(frozen=True, slots=True, kw_only=True)
class Transform:
    """Where frame `child` is in frame `parent`: its origin, and its turn as a unit quaternion x, y, z, w."""

    parent: str
    child: str
    stamp_ns: int = 0
    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0
    quaternion: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        if not self.parent or not self.child or self.parent == self.child:
            raise BadMessageError(f"a transform joins two frames, not {self.parent!r} and {self.child!r}")
        # Names with a slash in front were tf1's; tf2 refuses them.
        if self.parent.startswith("/") or self.child.startswith("/"):
            raise BadMessageError(
                f"frames are named without a slash in front, not {self.parent!r} and {self.child!r}"
            )
        if not all(map(math.isfinite, (self.x_m, self.y_m, self.z_m, *self.quaternion))):
            raise BadMessageError(f"a transform must be finite: {self!r}")
        length = math.hypot(*self.quaternion)
        if abs(length - 1.0) > UNIT_TOLERANCE:
            raise BadMessageError(f"a turn's quaternion must have length 1, not {length:.3g}: {self!r}")


def planar_transform(parent: str, child: str, pose: Pose2D, stamp_ns: int, z_m: float = 0.0) -> Transform:
    """A frame that stands upright at `pose`, `z_m` above its parent's floor: odom, base_link, a laser."""
    half_rad = pose.yaw_rad / 2.0
    return Transform(
        parent=parent,
        child=child,
        stamp_ns=stamp_ns,
        x_m=pose.x_m,
        y_m=pose.y_m,
        z_m=z_m,
        quaternion=(0.0, 0.0, math.sin(half_rad), math.cos(half_rad)),
    )


def camera_transform(
    mount: CameraMount, stamp_ns: int, parent: str = BASE_FRAME, child: str = OPTICAL_FRAME
) -> Transform:
    """The optical frame (z forward, x right, y down) of a camera that is mounted so."""
    # Roll by -(90 degrees + pitch) about x, then yaw by -90 degrees about z.
    half_rad = (math.pi / 2.0 + mount.pitch_rad) / 2.0
    part, rest = math.sin(half_rad) * math.sqrt(0.5), math.cos(half_rad) * math.sqrt(0.5)
    return Transform(
        parent=parent,
        child=child,
        stamp_ns=stamp_ns,
        x_m=mount.x_m,
        z_m=mount.z_m,
        quaternion=(-part, part, -rest, rest),
    )


def transform_to_message(transform: Transform) -> TransformStamped:
    """A TransformStamped."""
    x, y, z, w = (float(part) for part in transform.quaternion)
    return TransformStamped(
        header=header(transform.stamp_ns, transform.parent),
        child_frame_id=transform.child,
        transform=TransformMessage(
            translation=Vector3(x=float(transform.x_m), y=float(transform.y_m), z=float(transform.z_m)),
            rotation=Quaternion(x=x, y=y, z=z, w=w),
        ),
    )


def transform_from_message(message: Any) -> Transform:
    """Read a TransformStamped; refused when it is not finite or turns by what is no unit quaternion."""
    place, turn = message.transform.translation, message.transform.rotation
    return Transform(
        parent=message.header.frame_id,
        child=message.child_frame_id,
        stamp_ns=stamp_from_message(message.header.stamp),
        x_m=float(place.x),
        y_m=float(place.y),
        z_m=float(place.z),
        quaternion=(float(turn.x), float(turn.y), float(turn.z), float(turn.w)),
    )


def tf_available() -> bool:
    """Whether there is a TFMessage to publish on /tf: in a ROS from apt, not among the wheels."""
    return find_spec(TF_PACKAGE) is not None


def tf_message(transforms: Iterable[Transform]) -> Any:
    """A tf2_msgs/TFMessage for /tf or /tf_static. Raises BadMessageError where there is no tf2_msgs."""
    try:
        from tf2_msgs.msg import TFMessage
    except ImportError as error:
        raise BadMessageError(
            f"there is no {TF_PACKAGE} here ({error}), so nothing can go to /tf; it comes with ROS from apt"
        ) from error
    return TFMessage(transforms=[transform_to_message(transform) for transform in transforms])
