"""The place: map, furniture tinted by the belief, and what the camera saw at the end."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb
from matplotlib.patches import Polygon
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from robustnav_msgs_py.values import BeliefCloud, OccupancyMap, Pose2D
from robustnav_nodes.drawing.colors import (
    BELIEF_COLORS,
    BELIEF_SPAN,
    FLOOR,
    TIME_COLORS,
    UNKNOWN,
    UNTOLD,
    WALL,
    belief_norm,
)
from robustnav_nodes.search_space.candidates import MASKED_FROM


def shown(floor_map: OccupancyMap) -> tuple[float, float, float, float]:
    """What of the map is known, with a small margin: left, right, bottom, top in metres."""
    rows, columns = np.nonzero(floor_map.cells >= 0)
    if not rows.size:
        rows, columns = np.array([0, floor_map.height - 1]), np.array([0, floor_map.width - 1])
    cell, origin = floor_map.resolution_m, floor_map.origin
    margin_m = 0.02 * cell * max(np.ptp(rows), np.ptp(columns))
    return (
        origin.x_m + cell * columns.min() - margin_m,
        origin.x_m + cell * (columns.max() + 1) + margin_m,
        origin.y_m + cell * rows.min() - margin_m,
        origin.y_m + cell * (rows.max() + 1) + margin_m,
    )


def draw_map(
    axes: Axes, floor_map: OccupancyMap, candidates: OccupancyMap | None, belief: BeliefCloud | None
) -> None:
    """The map, and over it the candidate locations in the colours of the belief."""
    cells = floor_map.cells
    colors = np.empty((*cells.shape, 3), dtype=np.uint8)
    colors[:] = _bytes(WALL)
    colors[cells < 0] = _bytes(UNKNOWN)
    colors[(cells >= 0) & (cells < MASKED_FROM)] = _bytes(FLOOR)
    axes.imshow(colors, extent=_extent(floor_map), origin="lower", interpolation="nearest", zorder=0)
    if candidates is not None:
        tint = _tint(candidates, belief)
        axes.imshow(tint, extent=_extent(candidates), origin="lower", interpolation="nearest", zorder=1)
        return
    if belief is not None:
        x_m, y_m = belief.position_m[:, 0], belief.position_m[:, 1]
        ratio = _ratio(belief.probability)
        axes.scatter(x_m, y_m, c=ratio, s=14, marker="s", cmap=BELIEF_COLORS, norm=belief_norm(), zorder=1)


def _tint(candidates: OccupancyMap, belief: BeliefCloud | None) -> NDArray[np.uint8]:
    """RGBA, uint8 [height, width, 4]: each masked cell in the colour of the candidate nearest to it."""
    rows, columns = np.nonzero(candidates.cells >= MASKED_FROM)
    tint = np.zeros((*candidates.cells.shape, 4), dtype=np.uint8)
    if belief is None:
        tint[rows, columns] = (*_bytes(UNTOLD), 255)
        return tint
    x_m = candidates.origin.x_m + (columns + 0.5) * candidates.resolution_m
    y_m = candidates.origin.y_m + (rows + 0.5) * candidates.resolution_m
    _, nearest = cKDTree(belief.position_m[:, :2]).query(np.stack([x_m, y_m], axis=1))
    tint[rows, columns] = BELIEF_COLORS(belief_norm()(_ratio(belief.probability)), bytes=True)[nearest]
    return tint


def _ratio(probability: NDArray[np.float64]) -> NDArray[np.float64]:
    """How many times as likely as in a uniform belief."""
    return np.clip(probability * len(probability), 1.0 / BELIEF_SPAN, BELIEF_SPAN)


def _bytes(color: str) -> tuple[int, int, int]:
    red, green, blue = (round(255 * part) for part in to_rgb(color))
    return red, green, blue


def _extent(grid: OccupancyMap) -> tuple[float, float, float, float]:
    x_m, y_m = grid.origin.x_m, grid.origin.y_m
    return (x_m, x_m + grid.width * grid.resolution_m, y_m, y_m + grid.height * grid.resolution_m)


def draw_view(
    axes: Axes,
    floor_map: OccupancyMap,
    candidates: OccupancyMap | None,
    pose: Pose2D,
    half_view_rad: float,
    reach_m: float,
) -> None:
    """What a camera at `pose` sees up to `reach_m`, until a wall; furniture hides nothing."""
    bearings = pose.yaw_rad + np.linspace(-half_view_rad, half_view_rad, 121)
    steps_m = np.arange(0.0, reach_m, 0.5 * floor_map.resolution_m)
    x_m = pose.x_m + steps_m * np.cos(bearings)[:, None]
    y_m = pose.y_m + steps_m * np.sin(bearings)[:, None]
    hidden = _is_wall(floor_map, candidates, x_m, y_m)
    reach = np.where(hidden.any(axis=1), hidden.argmax(axis=1), len(steps_m) - 1)
    rays = np.arange(len(bearings))
    rim = np.stack([x_m[rays, reach], y_m[rays, reach]], axis=1)
    corners = np.vstack([(pose.x_m, pose.y_m), rim])
    axes.add_patch(Polygon(corners, color=TIME_COLORS(1.0), alpha=0.14, lw=0, zorder=2))


def _is_wall(
    floor_map: OccupancyMap,
    candidates: OccupancyMap | None,
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
) -> NDArray[np.bool_]:
    """Whether the map is occupied at each place, other than by furniture; outside the map it is."""
    occupied = _at(floor_map, x_m, y_m, outside=100) >= MASKED_FROM
    furniture = candidates is not None and _at(candidates, x_m, y_m, outside=0) >= MASKED_FROM
    return occupied & ~furniture


def _at(grid: OccupancyMap, x_m: NDArray[np.float64], y_m: NDArray[np.float64], *, outside: int) -> Any:
    """Values of `grid` at places."""
    column = np.floor((x_m - grid.origin.x_m) / grid.resolution_m).astype(int)
    row = np.floor((y_m - grid.origin.y_m) / grid.resolution_m).astype(int)
    inside = (column >= 0) & (column < grid.width) & (row >= 0) & (row < grid.height)
    values = grid.cells[np.clip(row, 0, grid.height - 1), np.clip(column, 0, grid.width - 1)]
    return np.where(inside, values, outside)
