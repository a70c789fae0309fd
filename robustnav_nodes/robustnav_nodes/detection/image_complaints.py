"""What is wrong with an image that can be looked at all the same, in a sentence for people."""

import numpy as np

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import CameraModel, ColorImage, DepthImage

BLACK = 8  # of 255: a lit room has a brighter spot


def color_complaint(image: ColorImage) -> str:
    """Why nothing can be seen in the image; "" where something can."""
    brightest = int(image.pixels.max())
    if brightest <= BLACK:
        return (
            f"the image is black, {brightest} of 255 at its brightest; is the lens covered or the light off?"
        )
    return ""


def depth_complaint(image: DepthImage) -> str:
    """Why nothing can be placed by the depth; "" where something can."""
    depth_m = image.depth_m
    if not (np.isfinite(depth_m) & (depth_m > 0.0)).any():
        return (
            f"none of the {depth_m.size} depth values is valid; nothing in this image can be placed. "
            "Is the depth camera on, and its encoding 32FC1 in metres or 16UC1 in millimetres?"
        )
    return ""


def check_registered(color: ColorImage, camera: CameraModel) -> None:
    """Raises BadMessageError where the image is not of the camera's size: its boxes would lie elsewhere."""
    height, width = color.pixels.shape[:2]
    if (width, height) != (camera.width, camera.height):
        raise BadMessageError(
            f"the colour image has {width} x {height} pixels, camera_info {camera.width} x {camera.height}; "
            "colour, depth and camera_info must be of one size (registered)"
        )
