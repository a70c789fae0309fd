"""Blur images so strongly that nobody can be known on them, and tell which messages are images."""

import io
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter

IMAGE, COMPRESSED = "sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"
# Other types that hold what a camera saw; these cannot be blurred here and are taken out instead.
VIDEO = frozenset(
    {
        "foxglove_msgs/msg/CompressedImage",
        "foxglove_msgs/msg/CompressedVideo",
        "foxglove_msgs/msg/RawImage",
        "ffmpeg_image_transport_msgs/msg/FFMPEGPacket",
        "theora_image_transport/msg/Packet",
        "stereo_msgs/msg/DisparityImage",
    }
)
CLOUD = "sensor_msgs/msg/PointCloud2"
# How the name of a colour stands among the fields of a cloud: its length with the closing NUL, then it.
COLOR_FIELDS = (b"\x04\0\0\0rgb\0", b"\x05\0\0\0rgba\0")
FIELDS_WITHIN_BYTES = 1024
BLOCK_PX, MOST_BLOCKS = 8, 40  # blocks are at least that wide, and an image has at most so many in a row
SIGMA_BLOCKS = 1.0
MOST_PIXELS = 50_000_000
ENCODINGS: dict[str, tuple[str, int]] = {
    "rgb8": ("u1", 3),
    "bgr8": ("u1", 3),
    "8UC3": ("u1", 3),
    "rgba8": ("u1", 4),
    "bgra8": ("u1", 4),
    "mono8": ("u1", 1),
    "8UC1": ("u1", 1),
    "mono16": ("u2", 1),
    "16UC1": ("u2", 1),
    "32FC1": ("f4", 1),
}


def is_image(message_type: str) -> bool:
    """Whether messages of this type are images."""
    return message_type in (IMAGE, COMPRESSED) or message_type in VIDEO


def may_hold_images(definition: str) -> bool:
    """Whether a message type with this text has images among its parts, as markers have for their texture."""
    held = {
        line.removeprefix("MSG: ").strip() for line in definition.splitlines() if line.startswith("MSG: ")
    }
    return bool(held & {name.replace("/msg/", "/") for name in {IMAGE, COMPRESSED, *VIDEO}})


def is_colored_cloud(message_type: str, data: bytes) -> bool:
    """Whether a message is a cloud of coloured points, which shows a room as an image does."""
    return message_type == CLOUD and any(name in data[:FIELDS_WITHIN_BYTES] for name in COLOR_FIELDS)


def redact_parts(message: Any, *, blur: bool) -> bool:
    """Empty, or blur, the images that are parts of the decoded message, in place; False where none is one."""
    is_changed = False
    for part in _parts(message):
        if is_image(part.__msgtype__):
            if len(part.data) and not (blur and blur_message(part.__msgtype__, part)):
                part.data = np.zeros(0, dtype=np.uint8)
            elif not len(part.data):
                continue
            is_changed = True
        else:
            is_changed = redact_parts(part, blur=blur) or is_changed
    return is_changed


def _parts(message: Any) -> Iterator[Any]:
    for item in fields(message):
        value = getattr(message, item.name)
        yield from (part for part in (value if isinstance(value, list) else [value]) if is_dataclass(part))


def blur_message(message_type: str, message: Any) -> bool:
    """Blur the decoded message in place; False where it is of a kind that cannot be blurred."""
    blurred = None
    if message_type == IMAGE:
        blurred = _blurred_rows(message)
    elif message_type == COMPRESSED:
        blurred = _blurred_file(bytes(message.data))
    if blurred is None:
        return False
    message.data = np.frombuffer(blurred, dtype=np.uint8)
    return True


def blurred(samples: NDArray[Any]) -> NDArray[Any]:
    """Blur [height, width, channels]: means of blocks, then a Gaussian over the blocks.

    What is not finite counts for nothing; where a whole neighbourhood is not, the result is NaN.
    """
    height, width, _ = samples.shape
    side = max(BLOCK_PX, -(-width // MOST_BLOCKS))
    if samples.dtype.kind == "f":
        valid = np.isfinite(samples)
        values, weights = _blocks(np.where(valid, samples, 0.0), side), _blocks(valid, side)
    else:
        values, weights = _blocks(samples, side), _blocks(np.ones((height, width, 1), dtype=np.uint8), side)
    sigma = (SIGMA_BLOCKS, SIGMA_BLOCKS, 0.0)
    values, weights = (gaussian_filter(part, sigma) for part in (values, weights))
    mean = np.full(values.shape, np.nan)
    np.divide(values, weights, out=mean, where=np.broadcast_to(weights > 1e-6, mean.shape))
    return mean.repeat(side, axis=0).repeat(side, axis=1)[:height, :width]


def _blocks(samples: NDArray[Any], side: int) -> NDArray[np.float64]:
    """Sums over blocks of `side` x `side`; those at the rim are smaller."""
    rows, columns = np.arange(0, samples.shape[0], side), np.arange(0, samples.shape[1], side)
    sums = np.add.reduceat(np.add.reduceat(samples, rows, axis=0, dtype=np.float64), columns, axis=1)
    return np.asarray(sums, dtype=np.float64)


def _blurred_rows(message: Any) -> bytes | None:
    kind, channels = ENCODINGS.get(message.encoding, ("", 0))
    height, width, step = int(message.height), int(message.width), int(message.step)
    if not kind or not height or not width:
        return None
    dtype = np.dtype((">" if message.is_bigendian else "<") + kind)
    row_bytes = width * channels * dtype.itemsize
    data = np.frombuffer(bytes(message.data), dtype=np.uint8)
    if step < row_bytes or data.size != height * step:
        return None
    samples = np.ascontiguousarray(data.reshape(height, step)[:, :row_bytes]).view(dtype)
    soft = blurred(samples.reshape(height, width, channels))
    if dtype.kind == "u":
        soft = np.rint(np.nan_to_num(soft))
    rows = np.zeros((height, step), dtype=np.uint8)  # what padded the rows goes, too
    rows[:, :row_bytes] = np.ascontiguousarray(soft.astype(dtype)).reshape(height, -1).view(np.uint8)
    return rows.tobytes()


def _blurred_file(content: bytes) -> bytes | None:
    try:
        with Image.open(io.BytesIO(content), formats=("JPEG", "PNG", "WEBP")) as picture:
            kind = str(picture.format)
            if picture.width * picture.height > MOST_PIXELS:
                return None
            pixels = np.asarray(picture.convert("RGB"))
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):  # what Pillow raises for others
        return None
    out = io.BytesIO()
    Image.fromarray(np.rint(blurred(pixels)).astype(np.uint8)).save(out, kind)
    return out.getvalue()
