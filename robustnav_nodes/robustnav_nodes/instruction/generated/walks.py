"""Walks from place to place: where somebody went, which way they faced, which rooms they came through."""

import heapq
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.generated.dwelling import Dwelling, Thing
from robustnav_nodes.instruction.generated.places import Places
from robustnav_nodes.instruction.trajectory import wrapped

PLACES = (4, 8)  # fewest and most places of a walk
SHORTEST_M = 4.5
P_STAYS = 0.15  # of walks that may end in the room where they start
P_ALONG = 0.35  # of walks that start facing the way
_A_STEP_COSTS_M = 0.9  # few long steps are walked rather than many short ones
_TRIES = 40
_SAMPLE_M = 0.08  # walls are thicker


@dataclass(frozen=True, slots=True, kw_only=True)
class Crossing:
    """Between two places a door is walked through: after place `after`, `at_m` metres into the walk."""

    after: int
    at_m: float
    door: Thing
    left: str
    entered: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Walk:
    """Places by their numbers, T of them, and what follows from them.

    `xy_m` [T, 2]; `yaw_in_rad`, `yaw_out_rad` [T], at the last place equal; `so_far_m` [T]; `rooms` [T],
    where a place stands in a doorway the room that is entered, else, at the end, the one that was left.
    """

    places: tuple[int, ...]
    xy_m: Float64
    yaw_in_rad: tuple[float, ...]
    yaw_out_rad: tuple[float, ...]
    so_far_m: tuple[float, ...]
    rooms: tuple[str, ...]
    crossings: tuple[Crossing, ...]

    def __len__(self) -> int:
        return len(self.places)

    @property
    def length_m(self) -> float:
        return self.so_far_m[-1]

    def turn_rad(self, at: int) -> float:
        return wrapped(self.yaw_out_rad[at] - self.yaw_in_rad[at])

    def bearing_rad(self, at: int, thing: Thing, yaw_rad: float) -> float:
        """Of the thing's middle as seen from place `at` with that yaw, positive to the left."""
        x, y, _ = thing.centre_m
        return wrapped(math.atan2(y - self.xy_m[at, 1], x - self.xy_m[at, 0]) - yaw_rad)

    def away_m(self, at: int, thing: Thing) -> float:
        return thing.away_m(float(self.xy_m[at, 0]), float(self.xy_m[at, 1]))


def draw_walks(
    dwelling: Dwelling,
    places: Places,
    count: int,
    rng: np.random.Generator,
    taken: frozenset[tuple[int, int]] = frozenset(),
) -> Iterator[Walk]:
    """At most `count` walks whose first and last places are no pair of `taken`, and no pair twice.

    Fewer where the dwelling is too small for them.
    """
    ways: dict[int, list[tuple[int, float]]] = defaultdict(list)
    for a, b, length in places.edges:
        ways[a].append((b, length))
        ways[b].append((a, length))
    used = set(taken)
    drawn = 0
    for _ in range(_TRIES * count):
        if drawn == count or len(ways) < 2:
            return
        start, end = (int(k) for k in rng.choice(sorted(ways), size=2, replace=False))
        if (start, end) in used:
            continue
        path = _shortest(ways, start, end, rng)
        if not PLACES[0] <= len(path) <= PLACES[1]:
            continue
        walk = walk_along(dwelling, places.xy_m, path, _start_yaw(places.xy_m, path, rng))
        if walk is None or walk.length_m < SHORTEST_M:
            continue
        if not walk.crossings and rng.random() >= P_STAYS:
            continue
        used.add((start, end))
        drawn += 1
        yield walk


def walk_along(dwelling: Dwelling, xy_m: Float64, path: Sequence[int], start_yaw_rad: float) -> Walk | None:
    """The walk through those places; None where it gets from room to room but by a door."""
    xy = xy_m[list(path)]
    yaws = [math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in pairwise(xy.tolist())]
    so_far = [0.0, *np.cumsum(np.linalg.norm(np.diff(xy, axis=0), axis=1)).tolist()]
    crossings = _crossings(dwelling, xy, so_far)
    if crossings is None:
        return None
    rooms = _rooms(dwelling, xy, so_far, crossings)
    if rooms is None:
        return None
    return Walk(
        places=tuple(path),
        xy_m=xy,
        yaw_in_rad=(start_yaw_rad, *yaws),
        yaw_out_rad=(*yaws, yaws[-1]),
        so_far_m=tuple(so_far),
        rooms=rooms,
        crossings=tuple(crossings),
    )


def _start_yaw(xy_m: Float64, path: Sequence[int], rng: np.random.Generator) -> float:
    """Along the way, against it, or anywhere."""
    x, y = xy_m[path[1]] - xy_m[path[0]]
    along = math.atan2(y, x)
    chance = rng.random()
    if chance < P_ALONG:
        return wrapped(along + rng.normal(0.0, 0.15))
    if chance < P_ALONG + 0.15:
        return wrapped(along + math.pi + rng.normal(0.0, 0.2))
    return float(rng.uniform(-math.pi, math.pi))


def _shortest(
    ways: dict[int, list[tuple[int, float]]], start: int, end: int, rng: np.random.Generator
) -> list[int]:
    """Dijkstra; every step costs a little more by chance, so that there is more than one way."""
    costs, came_from = {start: 0.0}, {start: start}
    queue = [(0.0, start)]
    while queue:
        cost, at = heapq.heappop(queue)
        if at == end:
            break
        if cost > costs[at]:
            continue
        for other, length in ways[at]:
            new = cost + length + _A_STEP_COSTS_M * rng.uniform(0.8, 1.2)
            if new < costs.get(other, math.inf):
                costs[other], came_from[other] = new, at
                heapq.heappush(queue, (new, other))
    if end not in came_from:
        return []
    path = [end]
    while path[-1] != start:
        path.append(came_from[path[-1]])
    return path[::-1]


def _crossings(dwelling: Dwelling, xy: Float64, so_far: Sequence[float]) -> list[Crossing] | None:
    found: list[Crossing] = []
    before = dwelling.room_at(*xy[0].tolist())
    left_at_m = 0.0
    samples = np.arange(0.0, so_far[-1] + _SAMPLE_M, _SAMPLE_M)
    way = np.stack([np.interp(samples, so_far, xy[:, k]) for k in range(2)], axis=1)
    for at_m, (x, y) in zip(samples.tolist(), way.tolist(), strict=True):
        room = dwelling.room_at(x, y)
        if room is None:
            continue
        if before is not None and room.name != before.name:
            middle_m = (left_at_m + at_m) / 2.0
            door = _door(dwelling, before.name, room.name, xy, so_far, middle_m)
            if door is None:
                return None
            after = int(np.searchsorted(so_far, middle_m, side="right")) - 1
            found.append(
                Crossing(
                    after=min(after, len(so_far) - 2),
                    at_m=middle_m,
                    door=door,
                    left=before.name,
                    entered=room.name,
                )
            )
        before, left_at_m = room, at_m
    return found


def _door(
    dwelling: Dwelling, left: str, entered: str, xy: Float64, so_far: Sequence[float], at_m: float
) -> Thing | None:
    x, y = (float(np.interp(at_m, so_far, xy[:, k])) for k in range(2))
    joins = {left, entered}
    return next(
        (door for door in dwelling.doors if set(door.joins or ()) == joins and door.away_m(x, y) < 0.1), None
    )


def _rooms(
    dwelling: Dwelling, xy: Float64, so_far: Sequence[float], crossings: Sequence[Crossing]
) -> tuple[str, ...] | None:
    found: list[str] = []
    for at, point in enumerate(xy.tolist()):
        room = dwelling.room_at(*point)
        if room is not None:
            found.append(room.name)
            continue
        near = [crossing for crossing in crossings if abs(crossing.at_m - so_far[at]) < 0.5]
        if near:
            found.append(near[0].entered)
        elif found:
            found.append(found[-1])
        else:
            return None
    return tuple(found)
