"""Square lattice of places on the floor where the robot fits, and the straight ways between neighbours."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from robustnav_nodes.search_space.clearance import places_that_fit, ways_that_fit
from robustnav_nodes.search_space.floor_grid import FloorGrid

Int64 = NDArray[np.int64]

# One of each pair of opposite steps (columns, rows): a way is free in both directions or in none.
_HALF_OF_STEPS = np.array([[1, 0], [1, 1], [0, 1], [-1, 1]], dtype=np.int64)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Lattice:
    """Places where the robot fits, and which of their eight neighbours it can drive to.

    column, row: int64 [m], place on the lattice; x_m, y_m: float64 [m], in the map's frame;
    neighbour: int32 [m, 3, 3], the place at (row + i - 1, column + j - 1), -1 where the way is not free.
    """

    column: Int64
    row: Int64
    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    neighbour: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.x_m)

    def kept(self, keep: NDArray[np.bool_]) -> "Lattice":
        """The places where `keep` (bool [m]) holds, and the ways between them."""
        new_index = np.where(keep, np.cumsum(keep) - 1, -1).astype(np.int32)
        neighbour = self.neighbour[keep]
        neighbour = np.where(neighbour >= 0, new_index[neighbour], np.int32(-1))
        return Lattice(
            column=self.column[keep],
            row=self.row[keep],
            x_m=self.x_m[keep],
            y_m=self.y_m[keep],
            neighbour=neighbour,
        )

    def component(self, place: int, steps: Int64) -> NDArray[np.bool_]:
        """bool [m]: the places that can be reached from `place` by `steps` (int64 [s, 2]: columns, rows)."""
        count = len(self)
        links = self.neighbour[:, steps[:, 1] + 1, steps[:, 0] + 1]
        origin, which = np.nonzero(links >= 0)
        ends = links[origin, which]
        matrix = sparse.csr_matrix((np.ones(len(ends), dtype=np.int8), (origin, ends)), shape=(count, count))
        _, label = csgraph.connected_components(matrix, directed=False)
        return np.asarray(label == label[place], dtype=np.bool_)


def build_lattice(grid: FloorGrid, spacing_m: float, radius_m: float) -> Lattice:
    """Every place of the lattice where a robot of `radius_m` fits; none is a Lattice of length 0.

    The lattice begins half a spacing inside the map's corner, so that it depends on the map alone.
    """
    height, width = grid.kind.shape
    columns = int(width * grid.resolution_m / spacing_m)
    rows = int(height * grid.resolution_m / spacing_m)
    fits = places_that_fit(grid, columns, rows, spacing_m, radius_m)
    row, column = np.nonzero(fits)
    index = np.full((rows + 2, columns + 2), -1, dtype=np.int64)
    index[row + 1, column + 1] = np.arange(len(row))

    x_m = np.asarray(grid.x_m + (column + 0.5) * spacing_m, dtype=np.float64)
    y_m = np.asarray(grid.y_m + (row + 0.5) * spacing_m, dtype=np.float64)
    neighbour = np.full((len(row), 3, 3), -1, dtype=np.int32)
    neighbour[:, 1, 1] = np.arange(len(row))
    for step_column, step_row in _HALF_OF_STEPS:
        ends = index[row + 1 + step_row, column + 1 + step_column]
        begins = np.nonzero(ends >= 0)[0]
        ends = ends[begins]
        free = ways_that_fit(grid, x_m, y_m, begins, ends, radius_m)
        begins, ends = begins[free], ends[free]
        neighbour[begins, step_row + 1, step_column + 1] = ends
        neighbour[ends, 1 - step_row, 1 - step_column] = begins
    return Lattice(column=column, row=row, x_m=x_m, y_m=y_m, neighbour=neighbour)


def heading_steps(headings: int) -> Int64:
    """int64 [headings, 2]: columns and rows that a move forward goes, for headings 0, 1/headings turn, ...

    A move along the heading ends at the lattice place nearest to one spacing ahead; where two are as near
    (30 degrees: straight on, or diagonal), it is the diagonal one. So each coordinate moves where the
    heading's unit vector has at least a half of it, and a step back is the opposite step.
    """
    yaw_rad = np.arange(headings) * (math.tau / headings)
    unit = np.stack([np.cos(yaw_rad), np.sin(yaw_rad)], axis=1)
    at_least_half = np.abs(unit) > 0.5 - 1e-9
    return np.where(at_least_half, np.sign(unit), 0.0).astype(np.int64)
