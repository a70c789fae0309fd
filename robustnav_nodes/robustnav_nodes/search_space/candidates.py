"""Candidate locations H: the places that can hold the target, from a mask or, failing that, from the map."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Bool, Float32, Float64, OccupancyMap
from robustnav_nodes.search_space.compiled import compiled
from robustnav_nodes.search_space.floor_grid import FREE, OCCUPIED, FloorGrid
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

Int64 = NDArray[np.int64]

MASKED_FROM = 51  # mask cells above 50 count, as in a Nav2 filter mask


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidates:
    """The set H (thesis 3.2.1.3): k locations, each a square patch that can hold the target.

    x_m, y_m: float64 [k], the middle of what is covered of the patch, in the map's frame; size_m: its side.
    """

    x_m: Float64
    y_m: Float64
    size_m: float

    def __len__(self) -> int:
        return len(self.x_m)

    @property
    def position_m(self) -> Float32:
        """float32 [k, 3], on the floor (z = 0), as a BeliefCloud holds them."""
        return np.stack([self.x_m, self.y_m, np.zeros(len(self))], axis=1).astype(np.float32)


def candidates_from_mask(
    mask: OccupancyMap, grid: FloorGrid, parameters: SearchSpaceParameters
) -> Candidates:
    """Candidates where `mask` is above 50 and `grid` lies below it.

    A mask finer than `candidate_size_m` is gathered into patches of that size; a coarser one gives one
    candidate per cell. A mask drawn at the map's own resolution is best: its cells also say which furniture
    is too low to hide what is behind it.

    Raises BadMapError where no masked cell lies on the map, or there are more than `max_candidates`.
    """
    masked = mask.cells >= MASKED_FROM
    if not masked.any():
        raise BadMapError(
            f"the candidate mask of {mask.width} x {mask.height} cells has no cell above 50: nothing can "
            "hold the target; mark the furniture, or publish no mask to have candidates taken from the map"
        )
    found = _patches(masked, mask.resolution_m, mask.origin.x_m, mask.origin.y_m, parameters)
    height, width = grid.kind.shape
    column = np.floor((found.x_m - grid.x_m) / grid.resolution_m)
    row = np.floor((found.y_m - grid.y_m) / grid.resolution_m)
    on_map = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    if not on_map.any():
        raise BadMapError(
            f"the candidate mask marks x {found.x_m.min():.2f} .. {found.x_m.max():.2f} m, "
            f"y {found.y_m.min():.2f} .. {found.y_m.max():.2f} m, the map covers "
            f"x {grid.x_m:.2f} .. {grid.x_m + width * grid.resolution_m:.2f} m, "
            f"y {grid.y_m:.2f} .. {grid.y_m + height * grid.resolution_m:.2f} m: they do not overlap; "
            "give the mask the map's origin"
        )
    found = Candidates(x_m=found.x_m[on_map], y_m=found.y_m[on_map], size_m=found.size_m)
    return _within_limit(found, parameters)


def candidates_from_map(grid: FloorGrid, parameters: SearchSpaceParameters) -> Candidates:
    """Candidates where nobody publishes a mask: occupied cells that border free floor, walls included.

    Raises BadMapError where there are none, or more than `max_candidates`.
    """
    beside_free = ndimage.binary_dilation(grid.kind == FREE)
    rim = (grid.kind == OCCUPIED) & beside_free
    if not rim.any():
        raise BadMapError(
            "no occupied cell of the map borders free floor, so nothing can hold the target: "
            f"publish a candidate mask, or check occupied_threshold ({parameters.occupied_threshold})"
        )
    return _within_limit(_patches(rim, grid.resolution_m, grid.x_m, grid.y_m, parameters), parameters)


def see_through(mask: OccupancyMap, grid: FloorGrid) -> Bool:
    """bool [height, width] of `grid`: the cells whose middle lies in a masked cell; these hide nothing."""
    masked = mask.cells >= MASKED_FROM
    height, width = grid.kind.shape
    x_m = grid.x_m + (np.arange(width) + 0.5) * grid.resolution_m
    y_m = grid.y_m + (np.arange(height) + 0.5) * grid.resolution_m
    column = np.floor((x_m - mask.origin.x_m) / mask.resolution_m).astype(np.int64)
    row = np.floor((y_m - mask.origin.y_m) / mask.resolution_m).astype(np.int64)
    columns_on = np.nonzero((column >= 0) & (column < mask.width))[0]
    rows_on = np.nonzero((row >= 0) & (row < mask.height))[0]
    clear = np.zeros(grid.kind.shape, dtype=np.bool_)
    clear[np.ix_(rows_on, columns_on)] = masked[np.ix_(row[rows_on], column[columns_on])]
    return clear


def _patches(
    covered: Bool, resolution_m: float, x_m: float, y_m: float, parameters: SearchSpaceParameters
) -> Candidates:
    """Gather covered cells (bool [height, width], corner at x_m, y_m) into patches of the wanted size."""
    side = max(1, round(parameters.candidate_size_m / resolution_m))
    count, column_sum, row_sum = _gather(covered, side)
    filled = count >= max(1.0, parameters.candidate_fill * side * side)
    # A thin thing may fill no patch; where no filled patch adjoins, dropping it would lose it altogether.
    lonely = (count > 0) & ~ndimage.binary_dilation(filled, structure=np.ones((3, 3)))
    keep = filled | lonely
    return Candidates(
        x_m=x_m + (column_sum[keep] / count[keep] + 0.5) * resolution_m,
        y_m=y_m + (row_sum[keep] / count[keep] + 0.5) * resolution_m,
        size_m=side * resolution_m,
    )


@compiled
def _gather(covered: Bool, side: int) -> tuple[Int64, Int64, Int64]:
    """Per patch of `side` x `side` cells: how many are covered, and the sums of their columns and rows."""
    height, width = covered.shape
    shape = ((height + side - 1) // side, (width + side - 1) // side)
    count = np.zeros(shape, dtype=np.int64)
    column_sum = np.zeros(shape, dtype=np.int64)
    row_sum = np.zeros(shape, dtype=np.int64)
    for row in range(height):
        for column in range(width):
            if covered[row, column]:
                count[row // side, column // side] += 1
                column_sum[row // side, column // side] += column
                row_sum[row // side, column // side] += row
    return count, column_sum, row_sum


def _within_limit(found: Candidates, parameters: SearchSpaceParameters) -> Candidates:
    if len(found) > parameters.max_candidates:
        raise BadMapError(
            f"there are {len(found)} candidate locations of {found.size_m:g} m, more than max_candidates = "
            f"{parameters.max_candidates}: mark less in the candidate mask, crop the map, raise "
            f"candidate_size_m ({parameters.candidate_size_m:g} m) or raise max_candidates"
        )
    return found
