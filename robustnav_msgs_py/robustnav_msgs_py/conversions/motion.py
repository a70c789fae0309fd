"""Poses, odometry, velocities and paths: geometry_msgs and nav_msgs."""

import math
from collections.abc import Sequence
from typing import Any

from robustnav_msgs_py.conversions.stamps import header, stamp_from_message
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.message_types import Odometry as OdometryMessage
from robustnav_msgs_py.message_types import Path, Point, Pose, PoseStamped, Quaternion, Twist, Vector3
from robustnav_msgs_py.values import Odometry, Pose2D, StampedPose, Velocity

_UNIT_TOLERANCE = 0.01


def quaternion(yaw: float) -> Quaternion:
    """A turn about z by `yaw` radians."""
    return Quaternion(x=0.0, y=0.0, z=math.sin(yaw / 2.0), w=math.cos(yaw / 2.0))


def yaw_rad(message: Any) -> float:
    """Yaw of a unit quaternion; refused when its length is not one (a forgotten orientation is all zeros)."""
    x, y, z, w = float(message.x), float(message.y), float(message.z), float(message.w)
    length = math.sqrt(x * x + y * y + z * z + w * w)
    if not abs(length - 1.0) <= _UNIT_TOLERANCE:
        raise BadMessageError(f"an orientation must have length 1, not {length:.3g}; use w = 1 for no turn")
    if x == 0.0 and y == 0.0:
        return 2.0 * math.atan2(z, w) if w >= 0.0 else 2.0 * math.atan2(-z, -w)
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def pose_to_message(pose: StampedPose) -> PoseStamped:
    """A PoseStamped on the floor."""
    return PoseStamped(header=header(pose.stamp_ns, pose.frame_id), pose=_pose_to_message(pose.pose))


def pose_from_message(message: Any) -> StampedPose:
    """Read a PoseStamped or a PoseWithCovarianceStamped; height, roll and pitch are dropped."""
    pose = getattr(message.pose, "pose", message.pose)
    return StampedPose(
        pose=_pose_from_message(pose),
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )


def odometry_to_message(odometry: Odometry) -> OdometryMessage:
    """An Odometry without covariances."""
    message = OdometryMessage(
        header=header(odometry.stamp_ns, odometry.frame_id), child_frame_id=odometry.child_frame_id
    )
    message.pose.pose = _pose_to_message(odometry.pose)
    message.twist.twist = velocity_to_message(
        Velocity(linear_m_s=odometry.linear_m_s, angular_rad_s=odometry.angular_rad_s)
    )
    return message


def odometry_from_message(message: Any) -> Odometry:
    """Read an Odometry; refused when the pose is not finite."""
    velocity = velocity_from_message(message.twist.twist)
    return Odometry(
        pose=_pose_from_message(message.pose.pose),
        linear_m_s=velocity.linear_m_s,
        angular_rad_s=velocity.angular_rad_s,
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
        child_frame_id=message.child_frame_id,
    )


def velocity_to_message(velocity: Velocity) -> Twist:
    """A Twist of a differential drive."""
    return Twist(
        linear=Vector3(x=float(velocity.linear_m_s), y=0.0, z=0.0),
        angular=Vector3(x=0.0, y=0.0, z=float(velocity.angular_rad_s)),
    )


def velocity_from_message(message: Any) -> Velocity:
    """Read linear.x and angular.z; refused when they are not finite."""
    return Velocity(linear_m_s=float(message.linear.x), angular_rad_s=float(message.angular.z))


def path_to_message(poses: Sequence[Pose2D], stamp_ns: int, frame_id: str = "map") -> Path:
    """A path through `poses`; no poses is an empty path."""
    stamped = [
        pose_to_message(StampedPose(pose=pose, stamp_ns=stamp_ns, frame_id=frame_id)) for pose in poses
    ]
    return Path(header=header(stamp_ns, frame_id), poses=stamped)


def path_from_message(message: Any) -> tuple[Pose2D, ...]:
    """The poses of a path."""
    return tuple(_pose_from_message(stamped.pose) for stamped in message.poses)


def _pose_to_message(pose: Pose2D) -> Pose:
    return Pose(
        position=Point(x=float(pose.x_m), y=float(pose.y_m), z=0.0), orientation=quaternion(pose.yaw_rad)
    )


def _pose_from_message(message: Any) -> Pose2D:
    return Pose2D(
        x_m=float(message.position.x), y_m=float(message.position.y), yaw_rad=yaw_rad(message.orientation)
    )
