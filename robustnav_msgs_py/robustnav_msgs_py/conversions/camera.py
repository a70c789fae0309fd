"""Images and the camera's model: sensor_msgs/Image, sensor_msgs/CameraInfo."""

import math
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.conversions.arrays import from_array, to_array
from robustnav_msgs_py.conversions.stamps import header, stamp_from_message
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.message_types import CameraInfo, Image
from robustnav_msgs_py.values import CameraModel, ColorImage, DepthImage

_COLOR_ENCODINGS = {"rgb8": 3, "bgr8": 3, "rgba8": 4, "bgra8": 4, "mono8": 1}
_DEPTH_ENCODINGS: dict[str, "np.dtype[Any]"] = {"32FC1": np.dtype(np.float32), "16UC1": np.dtype(np.uint16)}
_MILLIMETRES_PER_METRE = 1000.0
_BIG_ENDIAN_HERE = sys.byteorder == "big"


def color_to_message(image: ColorImage) -> Image:
    """An rgb8 image."""
    height, width, channels = image.pixels.shape
    return Image(
        header=header(image.stamp_ns, image.frame_id),
        height=height,
        width=width,
        encoding="rgb8",
        is_bigendian=int(_BIG_ENDIAN_HERE),
        step=width * channels,
        data=to_array(image.pixels),
    )


def color_from_message(message: Any) -> ColorImage:
    """Read rgb8, bgr8, rgba8, bgra8 or mono8 as RGB."""
    channels = _COLOR_ENCODINGS.get(message.encoding)
    if channels is None:
        raise BadMessageError(
            f"a colour image has encoding {message.encoding!r}; known are {', '.join(_COLOR_ENCODINGS)}"
        )
    pixels = _rows(message, np.dtype(np.uint8), channels)
    if channels == 1:
        pixels = np.repeat(pixels, 3, axis=2)
    elif message.encoding.startswith("bgr"):
        pixels = pixels[:, :, 2::-1]
    return ColorImage(
        pixels=np.ascontiguousarray(pixels[:, :, :3]),
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )


def depth_to_message(image: DepthImage) -> Image:
    """A 32FC1 depth image."""
    height, width = image.depth_m.shape
    return Image(
        header=header(image.stamp_ns, image.frame_id),
        height=height,
        width=width,
        encoding="32FC1",
        is_bigendian=int(_BIG_ENDIAN_HERE),
        step=width * image.depth_m.itemsize,
        data=to_array(image.depth_m.view(np.uint8)),
    )


def depth_from_message(message: Any) -> DepthImage:
    """Read 32FC1 (metres) or 16UC1 (millimetres, 0 invalid; REP-118) depth."""
    dtype = _DEPTH_ENCODINGS.get(message.encoding)
    if dtype is None:
        raise BadMessageError(
            f"a depth image has encoding {message.encoding!r}; known are {', '.join(_DEPTH_ENCODINGS)}"
        )
    depth = _rows(message, dtype, 1)[:, :, 0]
    if dtype == np.uint16:
        depth = np.where(depth == 0, np.nan, depth / _MILLIMETRES_PER_METRE)
    return DepthImage(
        depth_m=np.ascontiguousarray(depth, dtype=np.float32),
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )


def camera_to_message(camera: CameraModel) -> CameraInfo:
    """A CameraInfo without distortion."""
    return CameraInfo(
        header=header(camera.stamp_ns, camera.frame_id),
        height=camera.height,
        width=camera.width,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=[camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0],
        r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p=[camera.fx, 0.0, camera.cx, 0.0, 0.0, camera.fy, camera.cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def camera_from_message(message: Any) -> CameraModel:
    """Read the pinhole part of a CameraInfo; distorted images must be rectified first."""
    k = [float(item) for item in message.k]
    if not all(math.isfinite(item) for item in k):
        raise BadMessageError(f"camera_info has k = {k}; a calibrated camera has finite numbers")
    return CameraModel(
        width=int(message.width),
        height=int(message.height),
        fx=k[0],
        fy=k[4],
        cx=k[2],
        cy=k[5],
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )


def _rows(message: Any, dtype: "np.dtype[Any]", channels: int) -> NDArray[Any]:
    """An image's samples [height, width, channels], without the padding at the end of each row."""
    height, width, step = int(message.height), int(message.width), int(message.step)
    row_bytes = width * channels * dtype.itemsize
    where = f"{message.encoding} image of {width} x {height} pixels"
    if height == 0 or width == 0:
        raise BadMessageError(f"a {where} shows nothing")
    if step < row_bytes:
        raise BadMessageError(f"a {where} has step {step}; a row needs at least {row_bytes} bytes")
    data = from_array(message.data, np.uint8)
    if data.size != height * step:
        raise BadMessageError(
            f"a {where} has {data.size} bytes of data; step {step} asks for {height * step}"
        )
    samples = np.ascontiguousarray(data.reshape(height, step)[:, :row_bytes]).view(dtype)
    if bool(message.is_bigendian) != _BIG_ENDIAN_HERE and dtype.itemsize > 1:
        samples = samples.byteswap()
    return samples.reshape(height, width, channels)
