"""The belief over time, small enough for a page: which cells belong to which place, and a byte a place."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bags.search_run import Heard
from robustnav_msgs_py.values import BeliefCloud, OccupancyMap
from robustnav_nodes.drawing.colors import BELIEF_SPAN, belief_norm
from robustnav_nodes.search_space.candidates import MASKED_FROM

LARGEST_BYTES = 1_000_000  # of all beliefs of a report together
LARGEST_SIDE = 1200  # cells; finer grids are drawn coarser
MARGIN_M = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class BeliefLayout:
    """Where the places of a belief are drawn: a raster, its first row at the top.

    cells: base64 of uint32 [m], the raster's cells that belong to a place; places: base64 of uint32 [m],
    which one.
    """

    columns: int
    rows: int
    left_m: float
    bottom_m: float
    cell_m: float
    cells: str
    places: str


@dataclass(frozen=True, slots=True, kw_only=True)
class BeliefFrame:
    """The belief from `t_s` on. levels: base64 of uint8 [k], 0..255 along the colours of the belief."""

    t_s: float
    layout: int
    levels: str
    p_best: float


@dataclass(frozen=True, slots=True, kw_only=True)
class BeliefFilm:
    """All beliefs of a search; `told` is how many different ones the bag holds of which these are some."""

    layouts: tuple[BeliefLayout, ...]
    frames: tuple[BeliefFrame, ...]
    told: int


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Still:
    log_time_ns: int
    layout: int
    levels: NDArray[np.uint8]
    p_best: float


def belief_film(
    beliefs: Sequence[Heard[BeliefCloud]],
    times_s: Sequence[float],
    floor_map: OccupancyMap | None,
    candidates: OccupancyMap | None,
    candidate_size_m: float,
) -> BeliefFilm:
    """Film of `beliefs`, told at `times_s`; a belief that is said again is one frame.

    Where `candidates` masks cells, each belongs to the place nearest to it; elsewhere a place is a square.
    """
    layouts: dict[bytes, int] = {}
    drawn: list[BeliefLayout] = []
    stills: list[_Still] = []
    for heard in beliefs:
        places_m = heard.value.position_m[:, :2]
        key = places_m.tobytes()
        if key not in layouts:
            layouts[key] = len(drawn)
            drawn.append(_layout(places_m, floor_map, candidates, candidate_size_m))
        stills.append(_still(heard, layouts[key]))
    new = [
        index
        for index, still in enumerate(stills)
        if index == 0
        or still.layout != stills[index - 1].layout
        or not np.array_equal(still.levels, stills[index - 1].levels)
    ]
    kept = _thinned(new, sum(stills[index].levels.nbytes for index in new))
    frames = tuple(
        BeliefFrame(
            t_s=times_s[index],
            layout=stills[index].layout,
            levels=_packed(stills[index].levels),
            p_best=stills[index].p_best,
        )
        for index in kept
    )
    return BeliefFilm(layouts=tuple(drawn), frames=frames, told=len(new))


def _still(heard: Heard[BeliefCloud], layout: int) -> _Still:
    probability = heard.value.probability
    ratio = np.clip(probability * len(probability), 1.0 / BELIEF_SPAN, BELIEF_SPAN)
    levels = np.rint(255.0 * np.asarray(belief_norm()(ratio))).astype(np.uint8)
    return _Still(
        log_time_ns=heard.log_time_ns, layout=layout, levels=levels, p_best=float(probability.max())
    )


def _thinned(indices: Sequence[int], size_bytes: int) -> list[int]:
    """As many of `indices` as there is room for, evenly spread, the first and the last among them."""
    if size_bytes <= LARGEST_BYTES or len(indices) <= 2:
        return list(indices)
    count = max(2, len(indices) * LARGEST_BYTES // size_bytes)
    return [indices[place] for place in np.linspace(0, len(indices) - 1, count).round().astype(int)]


def _layout(
    places_m: NDArray[np.float32],
    floor_map: OccupancyMap | None,
    candidates: OccupancyMap | None,
    candidate_size_m: float,
) -> BeliefLayout:
    grid = candidates or floor_map
    if grid is not None:
        left_m, bottom_m, cell_m = grid.origin.x_m, grid.origin.y_m, grid.resolution_m
        columns, rows = grid.width, grid.height
    else:
        left_m, bottom_m = (float(low) - MARGIN_M for low in places_m.min(axis=0))
        width_m, height_m = (float(span) + 2 * MARGIN_M for span in np.ptp(places_m, axis=0))
        cell_m = candidate_size_m / 2.0
        columns, rows = int(np.ceil(width_m / cell_m)), int(np.ceil(height_m / cell_m))
    factor = -(-max(columns, rows) // LARGEST_SIDE)
    cell_m, columns, rows = cell_m * factor, -(-columns // factor), -(-rows // factor)
    if candidates is not None:
        at = np.argwhere(candidates.cells >= MASKED_FROM) // factor
        row, column = np.unique(at, axis=0).T if len(at) else (np.zeros(0, int), np.zeros(0, int))
        reach_m = np.inf
    else:
        row, column = (axis.ravel() for axis in np.indices((rows, columns)))
        reach_m = candidate_size_m / 2.0 + 1e-6
    middle_m = np.stack([left_m + (column + 0.5) * cell_m, bottom_m + (row + 0.5) * cell_m], axis=1)
    _, nearest = cKDTree(places_m).query(middle_m, p=np.inf, distance_upper_bound=reach_m)
    held = nearest < len(places_m)
    cells = (rows - 1 - row[held]) * columns + column[held]
    return BeliefLayout(
        columns=columns,
        rows=rows,
        left_m=left_m,
        bottom_m=bottom_m,
        cell_m=cell_m,
        cells=_packed(cells.astype("<u4")),
        places=_packed(nearest[held].astype("<u4")),
    )


def _packed(values: NDArray[np.uint8] | NDArray[np.uint32]) -> str:
    return base64.b64encode(values.tobytes()).decode("ascii")
