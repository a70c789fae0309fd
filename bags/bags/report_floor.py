"""The map as a small picture for a page."""

import base64
import io
from dataclasses import dataclass

import numpy as np
from matplotlib.colors import to_rgb
from numpy.typing import NDArray
from PIL import Image

from bags.drawing.floor import shown
from robustnav_msgs_py.values import OccupancyMap
from robustnav_nodes.drawing.colors import FLOOR, UNKNOWN, WALL
from robustnav_nodes.search_space.candidates import MASKED_FROM

LARGEST_SIDE = 2000  # pixels; larger maps are drawn coarser


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorPicture:
    """png: base64, one pixel a cell; it spans `left_m` to `right_m` and `bottom_m` to `top_m` of the map.

    `shown_m` is what of it is known, with a small margin: left, right, bottom, top.
    """

    png: str
    left_m: float
    right_m: float
    bottom_m: float
    top_m: float
    shown_m: tuple[float, float, float, float]


def floor_picture(floor_map: OccupancyMap) -> FloorPicture:
    """Draw `floor_map`: walls over floor over what is unknown, where several cells become one pixel."""
    factor = -(-max(floor_map.width, floor_map.height) // LARGEST_SIDE)
    cells = _coarse(floor_map.cells, factor)
    colors = np.empty((*cells.shape, 3), dtype=np.uint8)
    colors[:] = _bytes(WALL)
    colors[cells < 0] = _bytes(UNKNOWN)
    colors[(cells >= 0) & (cells < MASKED_FROM)] = _bytes(FLOOR)
    content = io.BytesIO()
    Image.fromarray(colors[::-1]).convert("P", palette=Image.Palette.ADAPTIVE, colors=4).save(
        content, "PNG", optimize=True
    )
    rows, columns = cells.shape
    side_m = floor_map.resolution_m * factor
    return FloorPicture(
        png=base64.b64encode(content.getvalue()).decode("ascii"),
        left_m=floor_map.origin.x_m,
        right_m=floor_map.origin.x_m + columns * side_m,
        bottom_m=floor_map.origin.y_m,
        top_m=floor_map.origin.y_m + rows * side_m,
        shown_m=shown(floor_map),
    )


def _coarse(cells: NDArray[np.int8], factor: int) -> NDArray[np.int8]:
    """The largest of each `factor` x `factor` cells: a thin wall must not vanish."""
    if factor == 1:
        return cells
    rows, columns = (-(-size // factor) * factor for size in cells.shape)
    padded = np.full((rows, columns), -1, dtype=np.int8)
    padded[: cells.shape[0], : cells.shape[1]] = cells
    blocks = padded.reshape(rows // factor, factor, columns // factor, factor)
    return np.asarray(blocks.max(axis=(1, 3)), dtype=np.int8)


def _bytes(color: str) -> tuple[int, int, int]:
    red, green, blue = (round(255 * part) for part in to_rgb(color))
    return red, green, blue
