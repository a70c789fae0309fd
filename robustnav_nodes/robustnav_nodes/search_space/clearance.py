"""Whether a round robot fits at a place, and on the straight way between two places."""

import math

import numpy as np
from numpy.typing import NDArray

from robustnav_nodes.search_space.compiled import compiled
from robustnav_nodes.search_space.floor_grid import FREE, FloorGrid


@compiled
def way_fits(grid: FloorGrid, ax_m: float, ay_m: float, bx_m: float, by_m: float, radius_m: float) -> bool:
    """True where a disc of `radius_m` can move straight from a to b (the same point: can stand there).

    Every cell that is not free, unknown ones included, blocks as a disc of half a cell around its centre;
    what lies outside the map blocks too.
    """
    height, width = grid.kind.shape
    resolution = grid.resolution_m
    reach = radius_m + 0.5 * resolution
    x_low, x_high = min(ax_m, bx_m) - grid.x_m, max(ax_m, bx_m) - grid.x_m
    y_low, y_high = min(ay_m, by_m) - grid.y_m, max(ay_m, by_m) - grid.y_m
    if x_low < radius_m or y_low < radius_m:
        return False
    if x_high > width * resolution - radius_m or y_high > height * resolution - radius_m:
        return False

    first_column = max(0, int(math.floor((x_low - reach) / resolution)))
    last_column = min(width - 1, int(math.floor((x_high + reach) / resolution)))
    first_row = max(0, int(math.floor((y_low - reach) / resolution)))
    last_row = min(height - 1, int(math.floor((y_high + reach) / resolution)))
    way_x, way_y = bx_m - ax_m, by_m - ay_m
    way_squared = way_x * way_x + way_y * way_y
    for row in range(first_row, last_row + 1):
        for column in range(first_column, last_column + 1):
            if grid.kind[row, column] == FREE:
                continue
            dx = grid.x_m + (column + 0.5) * resolution - ax_m
            dy = grid.y_m + (row + 0.5) * resolution - ay_m
            along = 0.0
            if way_squared > 0.0:
                along = min(1.0, max(0.0, (dx * way_x + dy * way_y) / way_squared))
            dx -= along * way_x
            dy -= along * way_y
            if dx * dx + dy * dy < reach * reach:
                return False
    return True


@compiled
def places_that_fit(
    grid: FloorGrid, columns: int, rows: int, spacing_m: float, radius_m: float
) -> NDArray[np.bool_]:
    """bool [rows, columns]: where a disc of `radius_m` can stand; the lattice begins half a spacing in."""
    fits = np.zeros((rows, columns), dtype=np.bool_)
    for row in range(rows):
        y_m = grid.y_m + (row + 0.5) * spacing_m
        for column in range(columns):
            x_m = grid.x_m + (column + 0.5) * spacing_m
            fits[row, column] = way_fits(grid, x_m, y_m, x_m, y_m, radius_m)
    return fits


@compiled
def ways_that_fit(
    grid: FloorGrid,
    x_m: NDArray[np.float64],
    y_m: NDArray[np.float64],
    begins: NDArray[np.int64],
    ends: NDArray[np.int64],
    radius_m: float,
) -> NDArray[np.bool_]:
    """bool [w]: whether a disc can move straight from place begins[i] to place ends[i] of (x_m, y_m)."""
    fits = np.zeros(len(begins), dtype=np.bool_)
    for way in range(len(begins)):
        a, b = begins[way], ends[way]
        fits[way] = way_fits(grid, x_m[a], y_m[a], x_m[b], y_m[b], radius_m)
    return fits
