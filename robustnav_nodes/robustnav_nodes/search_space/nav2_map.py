"""Floor maps in the files of Nav2's map server: a YAML file beside an image."""

import math
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from numpy.typing import NDArray
from PIL import Image

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Float64, OccupancyMap, Pose2D

_IMAGE_FORMATS = ("PPM", "PNG", "BMP")  # PPM is Pillow's name for the family that PGM belongs to
_DEEP_GREY = ("I", "I;16", "I;16B", "I;16L")
_FREE, _OCCUPIED, _UNKNOWN = 0, 100, -1

# What `write_nav2_map` writes. The grey of unknown cells is 0.1961 occupied: just above _FREE_THRESH.
_FREE_GREY, _OCCUPIED_GREY, _UNKNOWN_GREY = 254, 0, 205
_OCCUPIED_THRESH, _FREE_THRESH = 0.65, 0.196


class MapMode(StrEnum):
    """How grey becomes occupancy: three values, three values with a scale between, or the value itself."""

    TRINARY = "trinary"
    SCALE = "scale"
    RAW = "raw"


@dataclass(frozen=True, slots=True, kw_only=True)
class _Description:
    """What the YAML file says; thresholds are of 0 (free) .. 1 (occupied)."""

    image: Path
    resolution_m: float
    origin: Pose2D
    negate: bool
    occupied_thresh: float
    free_thresh: float
    mode: MapMode


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Picture:
    """grey: float64 [height, width], 0 black .. 1 white; alpha: the same, 1 opaque, None without one."""

    grey: Float64
    alpha: Float64 | None


def read_nav2_map(yaml_path: Path) -> OccupancyMap:
    """The map that Nav2's map server would publish for `yaml_path`, in frame "map", stamp 0.

    The image (PGM, PNG or BMP) lies where the YAML file says, seen from the YAML file; its top row is the
    one of largest y. `mode` may be missing: trinary. An origin with a yaw is refused: every map here is
    aligned with its frame.

    Raises BadFileError, with a sentence that says what to do, where a file is missing or cannot be read, a
    key is missing or of the wrong kind, the thresholds cross, or the image is none.
    """
    description = _read_description(yaml_path)
    picture = _read_picture(description.image, yaml_path)
    return OccupancyMap(
        cells=np.ascontiguousarray(_occupancy(picture, description)[::-1]),
        resolution_m=description.resolution_m,
        origin=description.origin,
    )


def write_nav2_map(floor_map: OccupancyMap, yaml_path: Path) -> None:
    """Write `floor_map` as a trinary map: `yaml_path`, and a PGM of the same name beside it.

    Cells up to 25 are written as free, from 65 as occupied, others as unknown; frame and stamp are not kept.
    Raises BadFileError where either file is there already or cannot be written.
    """
    image_path = yaml_path.with_suffix(".pgm")
    cells = floor_map.cells[::-1]
    grey = np.full(cells.shape, _UNKNOWN_GREY, dtype=np.uint8)
    grey[(cells >= 0) & (cells <= 25)] = _FREE_GREY
    grey[cells >= 65] = _OCCUPIED_GREY
    description = {
        "image": image_path.name,
        "mode": str(MapMode.TRINARY),
        "resolution": float(floor_map.resolution_m),
        "origin": [float(floor_map.origin.x_m), float(floor_map.origin.y_m), 0.0],
        "negate": 0,
        "occupied_thresh": _OCCUPIED_THRESH,
        "free_thresh": _FREE_THRESH,
    }
    for path in (yaml_path, image_path):
        if path.exists():
            raise BadFileError(f"{str(path)!r} exists already: remove it, or give the map another name")
    try:
        with image_path.open("xb") as file:
            Image.fromarray(grey).save(file, format="PPM")
        with yaml_path.open("x", encoding="utf-8") as file:
            yaml.safe_dump(description, file, sort_keys=False, default_flow_style=None)
    except OSError as error:
        raise BadFileError(f"cannot write the map {str(yaml_path)!r}: {error.strerror}") from error


# The YAML file.


def _read_description(path: Path) -> _Description:
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BadFileError(f"cannot read the map {str(path)!r}: {error.strerror}") from error
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise BadFileError(f"the map {str(path)!r} is not YAML: {reason}") from error
    if not isinstance(content, dict):
        raise BadFileError(
            f"the map {str(path)!r} must hold keys such as 'image' and 'resolution', not {_short(content)}; "
            "give the YAML file that belongs to the image"
        )
    resolution_m = _number(content, "resolution", path)
    if resolution_m <= 0.0:
        raise BadFileError(
            f"'resolution' in {str(path)!r} is {resolution_m!r}; it must be the metres per pixel, above 0"
        )
    free_thresh, occupied_thresh = (_number(content, key, path) for key in ("free_thresh", "occupied_thresh"))
    if not 0.0 <= free_thresh < occupied_thresh <= 1.0:
        raise BadFileError(
            f"'free_thresh' is {free_thresh!r} and 'occupied_thresh' is {occupied_thresh!r} in "
            f"{str(path)!r}; they must lie in 0..1, free_thresh below occupied_thresh"
        )
    return _Description(
        image=path.parent / _text(content, "image", path),
        resolution_m=resolution_m,
        origin=_origin(content, path),
        negate=_flag(content, "negate", path),
        occupied_thresh=occupied_thresh,
        free_thresh=free_thresh,
        mode=_mode(content, path),
    )


def _origin(content: dict[Any, Any], path: Path) -> Pose2D:
    origin = _value(content, "origin", path)
    if not isinstance(origin, list) or len(origin) != 3:
        raise BadFileError(f"'origin' in {str(path)!r} must be [x, y, yaw], not {_short(origin)}")
    x_m, y_m, yaw_rad = (_finite(value, "origin", path) for value in origin)
    if yaw_rad != 0.0:
        raise BadFileError(
            f"'origin' in {str(path)!r} has yaw {yaw_rad!r} rad; rotated maps are not supported: turn the "
            "image instead, and write a yaw of 0"
        )
    return Pose2D(x_m=x_m, y_m=y_m)


def _mode(content: dict[Any, Any], path: Path) -> MapMode:
    mode = content.get("mode", MapMode.TRINARY)
    try:
        return MapMode(mode)
    except ValueError as error:
        known = ", ".join(MapMode)
        raise BadFileError(f"'mode' in {str(path)!r} is {_short(mode)}; it must be one of {known}") from error


def _text(content: dict[Any, Any], key: str, path: Path) -> str:
    value = _value(content, key, path)
    if not isinstance(value, str) or not value or "\0" in value:
        raise BadFileError(f"{key!r} in {str(path)!r} is {_short(value)}; it must be the name of a file")
    return value


def _flag(content: dict[Any, Any], key: str, path: Path) -> bool:
    value = _value(content, key, path)
    if not isinstance(value, int):  # a bool is one
        raise BadFileError(f"{key!r} in {str(path)!r} is {_short(value)}; it must be 0 or 1")
    return bool(value)


def _number(content: dict[Any, Any], key: str, path: Path) -> float:
    return _finite(_value(content, key, path), key, path)


def _finite(value: Any, key: str, path: Path) -> float:
    try:
        # YAML 1.1, which PyYAML reads, takes 5e-2 for a text; the map server takes it for a number.
        number = math.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise BadFileError(f"{key!r} in {str(path)!r} holds {_short(value)}; it must be a finite number")
    return number


def _value(content: dict[Any, Any], key: str, path: Path) -> Any:
    if key not in content:
        raise BadFileError(f"the map {str(path)!r} has no {key!r}: add it, as Nav2's map server wants it")
    return content[key]


def _short(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


# The image.


def _read_picture(path: Path, yaml_path: Path) -> _Picture:
    try:
        with Image.open(path, formats=_IMAGE_FORMATS) as image:
            if image.mode in _DEEP_GREY:
                return _Picture(grey=np.asarray(image, dtype=np.float64) / 65535.0, alpha=None)
            has_alpha = "A" in image.getbands() or "transparency" in image.info
            pixels = np.asarray(image.convert("RGBA"))
    except FileNotFoundError as error:
        raise BadFileError(
            f"there is no image {str(path)!r}, which 'image' in {str(yaml_path)!r} names"
        ) from error
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise BadFileError(
            f"the image {str(path)!r}, which 'image' in {str(yaml_path)!r} names, cannot be read: {error}; "
            "it must be a PGM, PNG or BMP image"
        ) from error
    grey = pixels[:, :, :3].sum(axis=2, dtype=np.uint16) / (3.0 * 255.0)
    return _Picture(grey=grey, alpha=pixels[:, :, 3] / 255.0 if has_alpha else None)


def _occupancy(picture: _Picture, description: _Description) -> NDArray[np.int8]:
    """int8 [height, width], rows as in the image, by the rules of Nav2's map server."""
    grey, mode = picture.grey, description.mode
    if mode is MapMode.RAW:
        value = np.floor(255.0 * grey + 0.5)
        return np.where(value <= _OCCUPIED, value, _UNKNOWN).astype(np.int8)
    if mode is MapMode.TRINARY and picture.alpha is not None:
        grey = (3.0 * grey + picture.alpha) / 4.0
    occupied = grey if description.negate else 1.0 - grey
    free_thresh, occupied_thresh = description.free_thresh, description.occupied_thresh
    if mode is MapMode.SCALE:
        between = np.rint((occupied - free_thresh) / (occupied_thresh - free_thresh) * 100.0)
    else:
        between = np.full(occupied.shape, float(_UNKNOWN))
    cells = np.where(occupied > occupied_thresh, _OCCUPIED, np.where(occupied < free_thresh, _FREE, between))
    if mode is MapMode.SCALE and picture.alpha is not None:
        cells[picture.alpha < 1.0] = _UNKNOWN
    return cells.astype(np.int8)
