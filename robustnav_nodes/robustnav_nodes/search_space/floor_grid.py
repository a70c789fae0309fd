"""A floor map sorted into free, occupied and unknown, in the form that compiled loops take."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import OccupancyMap
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

FREE, OCCUPIED, UNKNOWN = 0, 1, 2


class FloorGrid(NamedTuple):
    """Cells of the floor, in the frame of the map they came from.

    kind: uint8 [height, width], FREE, OCCUPIED or UNKNOWN; cell (row, column) begins at
    (x_m + column * resolution_m, y_m + row * resolution_m).
    """

    kind: NDArray[np.uint8]
    resolution_m: float
    x_m: float
    y_m: float


def floor_grid(floor_map: OccupancyMap, parameters: SearchSpaceParameters) -> FloorGrid:
    """Sort the cells of `floor_map`; values between the two thresholds count as unknown.

    Raises BadMapError where the thresholds cross or no cell is free.
    """
    free_up_to, occupied_from = parameters.free_threshold, parameters.occupied_threshold
    if free_up_to >= occupied_from:
        raise BadMapError(
            f"free_threshold is {free_up_to} and occupied_threshold is {occupied_from}: "
            "a cell would be both; set free_threshold below occupied_threshold"
        )
    cells = floor_map.cells
    kind = np.full(cells.shape, UNKNOWN, dtype=np.uint8)
    kind[(cells >= 0) & (cells <= free_up_to)] = FREE
    kind[cells >= occupied_from] = OCCUPIED
    if not np.any(kind == FREE):
        unknown = float(np.mean(cells < 0))
        raise BadMapError(
            f"the map of {floor_map.width} x {floor_map.height} cells has no free floor "
            f"({unknown:.0%} of it is unknown): map the place first, or check free_threshold ({free_up_to})"
        )
    origin = floor_map.origin
    return FloorGrid(
        kind=kind, resolution_m=float(floor_map.resolution_m), x_m=float(origin.x_m), y_m=float(origin.y_m)
    )
