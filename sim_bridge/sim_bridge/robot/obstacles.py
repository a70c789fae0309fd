"""How far the robot's middle is from walls and furniture: exactly, at a point, and on a grid of the floor."""

import math
from collections.abc import Sequence

import numpy as np
import scipy.ndimage

from robustnav_msgs_py.values import Float64
from sim_bridge.homes.home import Rect


class Obstacles:
    """The rectangles that a robot must not touch, within bounds that it must not leave. Immutable."""

    def __init__(self, rects: Sequence[Rect], bounds: Rect) -> None:
        self.bounds = bounds
        self._low = np.array([(rect.x_min_m, rect.y_min_m) for rect in rects]).reshape(-1, 2)
        self._high = np.array([(rect.x_max_m, rect.y_max_m) for rect in rects]).reshape(-1, 2)

    def clearance_m(self, x_m: float, y_m: float) -> float:
        """Distance from the point to the nearest obstacle or to the bounds; negative inside or outside."""
        bounds = self.bounds
        inside = min(x_m - bounds.x_min_m, bounds.x_max_m - x_m, y_m - bounds.y_min_m, bounds.y_max_m - y_m)
        if not len(self._low):
            return inside
        point = np.array((x_m, y_m))
        beyond = np.maximum(self._low - point, point - self._high)
        outside = np.maximum(beyond, 0.0)
        distance = np.hypot(outside[:, 0], outside[:, 1]) + np.minimum(beyond.max(axis=1), 0.0)
        return min(inside, float(distance.min()))

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
    """Clearance (m) at the centres of the cells of a grid over `bounds`; rows along y. Immutable."""

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
            cells_m = np.minimum(to_x[None, :], to_y[:, None])
        self.cells_m: Float64 = cells_m

    def with_rects(self, rects: Sequence[Rect]) -> "ClearanceGrid":
        """The grid with obstacles added."""
        cells_m = self.cells_m.copy()
        for rect in rects:
            beyond_x = np.maximum(rect.x_min_m - self.x_m, self.x_m - rect.x_max_m)[None, :]
            beyond_y = np.maximum(rect.y_min_m - self.y_m, self.y_m - rect.y_max_m)[:, None]
            distance = np.hypot(np.maximum(beyond_x, 0.0), np.maximum(beyond_y, 0.0))
            distance += np.minimum(np.maximum(beyond_x, beyond_y), 0.0)
            np.minimum(cells_m, distance, out=cells_m)
        return ClearanceGrid(self.bounds, self.resolution_m, cells_m)

    def regions(self, radius_m: float) -> int:
        """Into how many parts the floor falls for a robot of `radius_m`."""
        return int(scipy.ndimage.label(self.cells_m >= radius_m)[1])
