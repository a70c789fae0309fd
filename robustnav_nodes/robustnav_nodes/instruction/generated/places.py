"""Places to stand in a dwelling, and which of them a straight walk joins: what walks are made of."""

from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.generated.dwelling import Dwelling

CLEARANCE_M = 0.28  # of a place
PASSAGE_M = 0.2  # of a straight walk
SPACING_M = 1.2
STEP_M = (1.0, 3.2)  # shortest and longest walk between two places
_GRID_M = 0.15
_SAMPLE_M = 0.1
_AT_DOORS_M = 0.35  # how far from its middle the place at a door may be


@dataclass(frozen=True, slots=True, kw_only=True)
class Places:
    """`xy_m` [P, 2]; `edges` pairs of numbers, each once, with their length."""

    xy_m: Float64
    edges: tuple[tuple[int, int, float], ...]


def places_of(dwelling: Dwelling, rng: np.random.Generator) -> Places:
    """Places about SPACING_M apart, one near each door first; none where nobody can stand."""
    blocked = dwelling.footprints()
    points = _floor(dwelling)
    points = points[_clearance_m(points, blocked) >= CLEARANCE_M]
    # Every grid point once, in an order of chance, those near doors first.
    order = rng.permutation(len(points))
    doors = np.array([door.centre_m[:2] for door in dwelling.doors]).reshape(-1, 2)
    at_door = np.zeros(len(points), dtype=np.bool_)
    if len(doors) and len(points):
        away = np.linalg.norm(points[:, None] - doors, axis=2).min(axis=1)
        at_door = away <= _AT_DOORS_M
    order = np.concatenate([order[at_door[order]], order[~at_door[order]]])
    chosen: list[int] = []
    taken = np.zeros(len(points), dtype=np.bool_)
    for at in order.tolist():
        if not taken[at]:
            chosen.append(at)
            taken |= np.linalg.norm(points - points[at], axis=1) < SPACING_M
    xy = points[chosen] + rng.uniform(-0.03, 0.03, size=(len(chosen), 2))
    return Places(xy_m=xy, edges=_edges(xy, blocked))


def _floor(dwelling: Dwelling) -> Float64:
    """Points on a grid over all rooms and doorways, [n, 2]."""
    low = np.min([room.low_m for room in dwelling.rooms], axis=0)
    high = np.max([room.high_m for room in dwelling.rooms], axis=0)
    x, y = (np.arange(low[k] + _GRID_M, high[k], _GRID_M) for k in range(2))
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    floor = [(*room.low_m, *room.high_m) for room in dwelling.rooms]
    floor += [(*door.low_m[:2], *door.high_m[:2]) for door in dwelling.doors]
    inside = np.zeros(len(grid), dtype=np.bool_)
    for area in floor:
        inside |= (grid >= area[:2]).all(axis=1) & (grid <= area[2:]).all(axis=1)
    return np.asarray(grid[inside])


def _clearance_m(points: Float64, blocked: Float64) -> Float64:
    """Distance of each point from the nearest rectangle, [n]."""
    nearest = np.full(len(points), np.inf)
    for area in blocked:
        beyond = np.maximum(np.maximum(area[:2] - points, points - area[2:]), 0.0)
        np.minimum(nearest, np.hypot(beyond[:, 0], beyond[:, 1]), out=nearest)
    return nearest


def _edges(xy: Float64, blocked: Float64) -> tuple[tuple[int, int, float], ...]:
    length = np.linalg.norm(xy[:, None] - xy, axis=2)
    first, second = np.nonzero(np.triu((length >= STEP_M[0]) & (length <= STEP_M[1]), k=1))
    if not len(first):
        return ()
    shares = np.linspace(0.0, 1.0, int(STEP_M[1] / _SAMPLE_M) + 1)
    ways = xy[first][:, None] + shares[:, None] * (xy[second] - xy[first])[:, None]
    clear = _clearance_m(ways.reshape(-1, 2), blocked) >= PASSAGE_M
    free = clear.reshape(len(first), -1).min(axis=1)
    return tuple(
        (a, b, float(length[a, b]))
        for a, b, is_free in zip(first.tolist(), second.tolist(), free.tolist(), strict=True)
        if is_free
    )
