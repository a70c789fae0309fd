"""How far the robot's middle is from walls and furniture: exactly, at a point, and on a grid of the floor."""

import math
from collections.abc import Sequence

import numpy as np
import scipy.ndimage

from robustnav_msgs_py.values import Float64
from sim_bridge.homes.rect import Rect

# On a grid, all clearances from here on are the same: no robot is so wide, and halls stay cheap.
FAR_M = 1.0
# The floor is looked at in squares of this side; each remembers which rectangles can be nearest in it.
SQUARE_M = 0.10
ROUNDING_M = 1e-9

# x_min_m, x_max_m, y_min_m, y_max_m
Sides = tuple[float, float, float, float]


class Obstacles:
    """The rectangles that a robot must not touch, within bounds that it must not leave.

    What it answers never changes; it only remembers, square by square, which few rectangles matter there.
    """

    def __init__(self, rects: Sequence[Rect], bounds: Rect) -> None:
        self.bounds = bounds
        self._low = np.array([(rect.x_min_m, rect.y_min_m) for rect in rects]).reshape(-1, 2)
        self._high = np.array([(rect.x_max_m, rect.y_max_m) for rect in rects]).reshape(-1, 2)
        self._sides = [(rect.x_min_m, rect.x_max_m, rect.y_min_m, rect.y_max_m) for rect in rects]
        self._near: dict[tuple[int, int], list[Sides]] = {}

    @property
    def corners_m(self) -> Float64:
        """The corners of all rectangles, [4 n, 2]."""
        low, high = self._low, self._high
        pairs = ((low, low), (low, high), (high, low), (high, high))
        return np.concatenate([np.stack([x[:, 0], y[:, 1]], axis=1) for x, y in pairs])

    def clearance_m(self, x_m: float, y_m: float) -> float:
        """Distance from the point to the nearest obstacle or to the bounds; negative inside or outside."""
        bounds = self.bounds
        nearest = min(x_m - bounds.x_min_m, bounds.x_max_m - x_m, y_m - bounds.y_min_m, bounds.y_max_m - y_m)
        # Squares are remembered only for the floor: there are endlessly many outside.
        candidates = self._candidates(x_m, y_m) if nearest >= 0.0 else self._sides
        for x_min_m, x_max_m, y_min_m, y_max_m in candidates:
            beyond_x = max(x_min_m - x_m, x_m - x_max_m)
            beyond_y = max(y_min_m - y_m, y_m - y_max_m)
            if beyond_x > 0.0 and beyond_y > 0.0:
                distance = math.hypot(beyond_x, beyond_y)
            else:
                distance = max(beyond_x, beyond_y)
            if distance < nearest:
                nearest = distance
        return nearest

    def _candidates(self, x_m: float, y_m: float) -> list[Sides]:
        """The sides of the rectangles that can be the nearest one somewhere in the point's square."""
        square = (math.floor(x_m / SQUARE_M), math.floor(y_m / SQUARE_M))
        near = self._near.get(square)
        if near is None:
            middle = (np.array(square) + 0.5) * SQUARE_M
            beyond = np.maximum(self._low - middle, middle - self._high)
            outside = np.maximum(beyond, 0.0)
            distance = np.hypot(outside[:, 0], outside[:, 1]) + np.minimum(beyond.max(axis=1), 0.0)
            # From the middle to a corner every distance changes by at most half the diagonal.
            reach = distance.min(initial=math.inf) + SQUARE_M * math.sqrt(2.0) + ROUNDING_M
            near = [self._sides[at] for at in np.nonzero(distance <= reach)[0].tolist()]
            self._near[square] = near
        return near

    def is_line_free(self, start_m: tuple[float, float], end_m: tuple[float, float], radius_m: float) -> bool:
        """Whether a disc of `radius_m` can be pushed straight from `start_m` to `end_m`."""
        length_m = math.dist(start_m, end_m)
        share, tolerance_m = 0.0, 1e-4
        while True:
            x_m = start_m[0] + share * (end_m[0] - start_m[0])
            y_m = start_m[1] + share * (end_m[1] - start_m[1])
            spare_m = self.clearance_m(x_m, y_m) - radius_m
            if spare_m < 0.0:
                return False
            # Nothing can be met within the clearance: the next place to look is that far ahead.
            if share * length_m + spare_m >= length_m:
                return self.clearance_m(*end_m) >= radius_m
            share += max(spare_m, tolerance_m) / length_m


class ClearanceGrid:
    """Clearance (m), up to FAR_M, at the centres of the cells of a grid over `bounds`; rows along y.

    Immutable.
    """

    def __init__(self, bounds: Rect, resolution_m: float, cells_m: Float64 | None = None) -> None:
        self.bounds = bounds
        self.resolution_m = resolution_m
        width = round(bounds.width_m / resolution_m)
        height = round(bounds.depth_m / resolution_m)
        self.x_m: Float64 = np.asarray(bounds.x_min_m + (np.arange(width) + 0.5) * resolution_m)
        self.y_m: Float64 = np.asarray(bounds.y_min_m + (np.arange(height) + 0.5) * resolution_m)
        if cells_m is None:
            to_x = np.minimum(self.x_m - bounds.x_min_m, bounds.x_max_m - self.x_m)
            to_y = np.minimum(self.y_m - bounds.y_min_m, bounds.y_max_m - self.y_m)
            cells_m = np.minimum(np.minimum(to_x, FAR_M)[None, :], to_y[:, None])
        self.cells_m: Float64 = cells_m

    def with_rects(self, rects: Sequence[Rect]) -> "ClearanceGrid":
        """The grid with obstacles added."""
        cells_m = self.cells_m.copy()
        reach_m = FAR_M + self.resolution_m
        for rect in rects:
            rows = _between(self.y_m, rect.y_min_m - reach_m, rect.y_max_m + reach_m)
            columns = _between(self.x_m, rect.x_min_m - reach_m, rect.x_max_m + reach_m)
            x_m, y_m = self.x_m[columns], self.y_m[rows]
            beyond_x = np.maximum(rect.x_min_m - x_m, x_m - rect.x_max_m)[None, :]
            beyond_y = np.maximum(rect.y_min_m - y_m, y_m - rect.y_max_m)[:, None]
            distance = np.hypot(np.maximum(beyond_x, 0.0), np.maximum(beyond_y, 0.0))
            distance += np.minimum(np.maximum(beyond_x, beyond_y), 0.0)
            window = cells_m[rows, columns]
            np.minimum(window, distance, out=window)
        return ClearanceGrid(self.bounds, self.resolution_m, cells_m)

    def cell_of(self, x_m: float, y_m: float) -> tuple[int, int]:
        """Row and column of the cell that holds a point of the bounds."""
        column = int((x_m - self.bounds.x_min_m) / self.resolution_m)
        row = int((y_m - self.bounds.y_min_m) / self.resolution_m)
        return min(row, len(self.y_m) - 1), min(column, len(self.x_m) - 1)

    def cells_in(self, rect: Rect) -> tuple[slice, slice]:
        """The rows and columns whose middles lie in a rectangle."""
        rows = _between(self.y_m, rect.y_min_m, rect.y_max_m)
        return rows, _between(self.x_m, rect.x_min_m, rect.x_max_m)

    def regions(self, radius_m: float) -> int:
        """Into how many parts the floor falls for a robot of `radius_m`."""
        return int(scipy.ndimage.label(self.cells_m >= radius_m)[1])


def _between(values_m: Float64, low_m: float, high_m: float) -> slice:
    """Which of the sorted values lie between the two."""
    return slice(int(np.searchsorted(values_m, low_m)), int(np.searchsorted(values_m, high_m, side="right")))
