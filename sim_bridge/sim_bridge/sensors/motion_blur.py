"""Motion blur: from where pictures are taken while the shutter is open, and their mean."""

import math
from collections.abc import Sequence

import numpy as np

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import CameraModel, ColorImage, Pose2D, Velocity

# Less motion than this in the image is not seen.
STILL_PX = 0.5
# Odd, so that the picture in the middle is from the pose that the stamp means: the depth is of that one.
FEW_PICTURES, MOST_PICTURES = 3, 5
FEW_PICTURES_PX = 3.0
# How near the things are whose motion matters when the robot drives straight on.
NEAR_THINGS_M = 1.0


def image_motion_px(velocity: Velocity, exposure_s: float, model: CameraModel) -> float:
    """How far, at most, the image of things 1 m away and farther moves while the shutter is open.

    The image of everything moves by fx for each radian of a turn; driving on, what is in a corner moves
    outwards by its distance from the middle for each metre that it is away.
    """
    turn_px = model.fx * abs(velocity.angular_rad_s) * exposure_s
    corner_px = math.hypot(model.width, model.height) / 2.0
    drive_px = corner_px * abs(velocity.linear_m_s) * exposure_s / NEAR_THINGS_M
    return turn_px + drive_px


def blur_poses(pose: Pose2D, velocity: Velocity, exposure_s: float, model: CameraModel) -> tuple[Pose2D, ...]:
    """Where the robot is at 1, 3 or 5 moments of an exposure whose middle finds it at `pose`.

    One where the image moves by less than half a pixel. In the order of time; `pose` is in the middle.
    The robot goes along the arc that `velocity` makes.
    """
    motion_px = image_motion_px(velocity, exposure_s, model)
    if motion_px < STILL_PX:
        return (pose,)
    count = FEW_PICTURES if motion_px <= FEW_PICTURES_PX else MOST_PICTURES
    times_s = [((number + 0.5) / count - 0.5) * exposure_s for number in range(count)]
    return tuple(_moved(pose, velocity, time_s) if time_s else pose for time_s in times_s)


def mean_image(images: Sequence[ColorImage]) -> ColorImage:
    """The mean of pictures of one size, with the stamp and frame of the one in the middle.

    Raises BadMessageError where there are none, or of several sizes.
    """
    if not images:
        raise BadMessageError("the mean of no pictures is not a picture: give at least one")
    middle = images[len(images) // 2]
    if len(images) == 1:
        return middle
    total = np.full(middle.pixels.shape, len(images) // 2, dtype=np.uint16)
    for image in images:
        if image.pixels.shape != total.shape:
            raise BadMessageError(
                f"pictures of {image.pixels.shape} and {total.shape} have no mean: take them with one camera"
            )
        total += image.pixels
    mean = (total // np.uint16(len(images))).astype(np.uint8)
    return ColorImage(pixels=mean, stamp_ns=middle.stamp_ns, frame_id=middle.frame_id)


def _moved(pose: Pose2D, velocity: Velocity, time_s: float) -> Pose2D:
    """The pose `time_s` later (earlier where negative), along an arc: its chord has the mean heading."""
    half_turn_rad = velocity.angular_rad_s * time_s / 2.0
    bend = math.sin(half_turn_rad) / half_turn_rad if half_turn_rad else 1.0
    chord_m = velocity.linear_m_s * time_s * bend
    heading_rad = pose.yaw_rad + half_turn_rad
    return Pose2D(
        x_m=pose.x_m + chord_m * math.cos(heading_rad),
        y_m=pose.y_m + chord_m * math.sin(heading_rad),
        yaw_rad=math.remainder(pose.yaw_rad + 2.0 * half_turn_rad, math.tau),
    )
