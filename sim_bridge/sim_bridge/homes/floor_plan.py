"""The maps that the robot is given: the floor plan, and the mask of cells that can hold an object."""

from collections.abc import Iterable

import numpy as np

from robustnav_msgs_py.values import OccupancyMap, Pose2D
from sim_bridge.homes.home import Home
from sim_bridge.homes.rect import Rect

FREE, OCCUPIED, UNKNOWN = 0, 100, -1
RESOLUTION_M = 0.05
# Unknown floor around the home.
MARGIN_M = 0.60


def floor_plan(home: Home, stamp_ns: int = 0) -> OccupancyMap:
    """The home at 0.05 m: walls and furniture occupied, floor and doorways free, outside unknown."""
    floor = [room.inside for room in home.rooms] + [door.opening for door in home.doors]
    areas = [(rect, FREE) for rect in floor] + [(rect, OCCUPIED) for rect in home.solid()]
    return _drawn(home, UNKNOWN, areas, stamp_ns)


def candidate_mask(home: Home, stamp_ns: int = 0) -> OccupancyMap:
    """The cells that can hold an object: 100 on low furniture that carries objects, and where objects hang on
    the wall behind it; 0 elsewhere.

    It has the floor plan's cells, because it also tells which furniture is too low to hide what is behind
    it: a coarser mask either leaves a rim of it that seems to hide, or lies over walls.
    """
    carriers = [piece for piece in home.furniture if piece.carries]
    areas = [piece.footprint for piece in carriers]
    areas += [piece.in_map(place.area) for piece in carriers for place in piece.surfaces if place.hangs]
    return _drawn(home, FREE, [(area, OCCUPIED) for area in areas], stamp_ns)


def _drawn(home: Home, ground: int, areas: Iterable[tuple[Rect, int]], stamp_ns: int) -> OccupancyMap:
    """A map of `ground` with every cell that an area touches, with more than its edge, set to its value."""
    frame = home.bounds.grown(MARGIN_M)
    cells = np.full((_cells(frame.depth_m), _cells(frame.width_m)), ground, dtype=np.int8)
    for area, value in areas:
        rows = _span(area.y_min_m - frame.y_min_m, area.y_max_m - frame.y_min_m)
        columns = _span(area.x_min_m - frame.x_min_m, area.x_max_m - frame.x_min_m)
        cells[rows, columns] = value
    origin = Pose2D(x_m=round(frame.x_min_m, 6), y_m=round(frame.y_min_m, 6))
    return OccupancyMap(cells=cells, resolution_m=RESOLUTION_M, origin=origin, stamp_ns=stamp_ns)


def _cells(length_m: float) -> int:
    return int(np.ceil(length_m / RESOLUTION_M - 1e-6))


def _span(low_m: float, high_m: float) -> slice:
    return slice(int(np.floor(low_m / RESOLUTION_M + 1e-6)), _cells(high_m))
