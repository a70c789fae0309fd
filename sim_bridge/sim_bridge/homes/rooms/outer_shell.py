"""The outer halves of the outer walls: what lies within half a wall of a room, and in none.

The plan is cut along all lines at which something begins or ends. The pieces that belong to the shell are put
together again, first to rows and then to blocks, so that they cover it once, with all corners closed.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sim_bridge.homes.home import WALL_HEIGHT_M, WALL_THICKNESS_M, Wall
from sim_bridge.homes.materials import Material, Substance
from sim_bridge.homes.rect import Rect, Side

HALF_WALL_M = WALL_THICKNESS_M / 2.0
SHELL = Material(substance=Substance.PAINT, colour="#bfbdb8")
# Lines are told apart down to a micrometre, as in Rect.overlaps.
DIGITS = 6

# Rows low..high and columns low..high of the cut plan, and the side that leans on a room.
_Block = tuple[int, int, int, int, Side]


def outer_shell(areas: Sequence[Rect]) -> list[Wall]:
    """Walls around rooms that do not overlap; `areas` reach to the middles of the walls."""
    grown = [area.grown(HALF_WALL_M) for area in areas]
    xs = _lines([x for rect in (*areas, *grown) for x in (rect.x_min_m, rect.x_max_m)])
    ys = _lines([y for rect in (*areas, *grown) for y in (rect.y_min_m, rect.y_max_m)])
    rooms = _covered(areas, xs, ys)
    shell = _covered(grown, xs, ys) & ~rooms
    blocks: list[_Block] = []
    for row in range(len(ys) - 1):
        for low, high in _runs(shell[row]):
            side = _leaning(rooms, shell, row, low, high, xs)
            below = (row, low, high, side)
            at = next((at for at, block in enumerate(blocks) if block[1:] == below), None)
            if at is None:
                blocks.append((row, row + 1, low, high, side))
            else:
                blocks[at] = (blocks[at][0], row + 1, low, high, side)
    return [
        Wall(
            base=Rect(x_min_m=xs[left], y_min_m=ys[bottom], x_max_m=xs[right], y_max_m=ys[top]),
            z_min_m=0.0,
            z_max_m=WALL_HEIGHT_M,
            material=SHELL,
            hidden=side,
        )
        for bottom, top, left, right, side in blocks
    ]


def _lines(values_m: Sequence[float]) -> list[float]:
    return sorted({round(value_m, DIGITS) for value_m in values_m})


def _covered(areas: Sequence[Rect], xs: Sequence[float], ys: Sequence[float]) -> NDArray[np.bool_]:
    """Which pieces of the cut plan the rectangles cover, [rows, columns]."""
    cells = np.zeros((len(ys) - 1, len(xs) - 1), dtype=np.bool_)
    for area in areas:
        rows = slice(ys.index(round(area.y_min_m, DIGITS)), ys.index(round(area.y_max_m, DIGITS)))
        columns = slice(xs.index(round(area.x_min_m, DIGITS)), xs.index(round(area.x_max_m, DIGITS)))
        cells[rows, columns] = True
    return cells


def _runs(row: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Where the row is set: first column, and the one after the last."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], row, [False])).astype(np.int8)))
    return [(int(low), int(high)) for low, high in zip(edges[::2], edges[1::2], strict=True)]


def _leaning(
    rooms: NDArray[np.bool_],
    shell: NDArray[np.bool_],
    row: int,
    low: int,
    high: int,
    xs: Sequence[float],
) -> Side:
    """The side of a row of pieces that nobody sees, the one with most of a room behind it."""
    room, built = np.pad(rooms, 1), np.pad(rooms | shell, 1)
    beside = {
        Side.SOUTH: np.s_[row, low + 1 : high + 1],
        Side.NORTH: np.s_[row + 2, low + 1 : high + 1],
        Side.WEST: np.s_[row + 1, low : low + 1],
        Side.EAST: np.s_[row + 1, high + 1 : high + 2],
    }
    widths_m = np.array([b - a for a, b in pairwise(xs[low : high + 1])])

    def behind_m(side: Side) -> tuple[bool, float]:
        cells = beside[side]
        lengths_m = widths_m if side in (Side.SOUTH, Side.NORTH) else np.array([HALF_WALL_M])
        return bool(built[cells].all()), float((room[cells] * lengths_m).sum())

    return max(Side, key=behind_m)
