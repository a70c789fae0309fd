"""Things that were moved into a home and that no map knows: they hide objects, and stand in the way."""

from collections.abc import Iterator
from itertools import chain

import numpy as np

from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.furniture.furnishing import PASSAGE_RADII_M
from sim_bridge.homes.home import Door, Furniture, Home, Room
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles
from sim_bridge.homes.occluders.designs import DESIGNS, pick
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene import Style
from sim_bridge.homes.scene_check import REACH_M

# How many of them stand between the middle of a room and what carries objects; the others stand anywhere.
P_HIDES = 0.8
# Where on the way from the room's middle (0) to the carrier's (1), and how far beside it.
HIDES_AT = (0.2, 0.9)
HIDES_BESIDE_M = 0.3
TRIES = 60
# Between an occluder and walls or furniture.
GAP_M = 0.05
START_FREE_M = 0.50
# How far into the room, on both sides, a doorway stays free.
DOOR_FREE_M = 0.50


def place_occluders(rng: np.random.Generator, home: Home, count: int) -> tuple[Furniture, ...]:
    """Move `count` things into the home; fewer where no more find a place.

    They are like furniture on which nothing stands, and they are not in the home's list.

    They stand on free floor, away from the start and from doorways; the floor stays in one piece for robots
    of all PASSAGE_RADII_M, and what carries objects can still be approached.
    """
    floor = _Floor(home)
    placed: list[Furniture] = []
    for _ in range(count):
        design = pick(rng, DESIGNS)(rng)
        hides = rng.random() < P_HIDES
        places = chain(_before_carriers(rng, home) if hides else (), _anywhere(rng, home))
        for x_m, y_m, turns in places:
            spot = _footprint(x_m, y_m, turns, design.size_m[0], design.size_m[1])
            if not floor.take(spot):
                continue
            number = sum(other.kind == design.kind for other in placed) + 1
            placed.append(
                Furniture(
                    name=f"{design.kind} {number}",
                    kind=design.kind,
                    room=next(room.name for room in home.rooms if room.inside.contains(spot)),
                    style=Style(
                        width_m=design.size_m[1],
                        main=design.parts[0].material,
                        accent=design.parts[-1].material,
                    ),
                    tall=True,
                    surfaces=(),
                    x_m=x_m,
                    y_m=y_m,
                    quarter_turns=turns,
                    depth_m=design.size_m[0],
                    width_m=design.size_m[1],
                    height_m=design.size_m[2],
                    parts=design.parts,
                )
            )
            break
    return tuple(placed)


class _Floor:
    """What floor is free; grows fuller with each thing that takes a spot."""

    def __init__(self, home: Home) -> None:
        self._home = home
        self._grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(home.obstacles())
        self._kept = [piece.footprint for piece in home.furniture]
        self._kept += [_doorway(door) for door in home.doors]
        self._carriers = [piece for piece in home.furniture if piece.carries]

    def take(self, spot: Rect) -> bool:
        """Put something there if that harms nothing; whether it was put there."""
        home = self._home
        wide = spot.grown(GAP_M)
        if not any(room.inside.contains(wide) for room in home.rooms):
            return False
        if any(wide.overlaps(other) for other in self._kept):
            return False
        from_start_m = Obstacles((spot,), home.bounds.grown(START_FREE_M)).clearance_m(
            home.start.x_m, home.start.y_m
        )
        if from_start_m < START_FREE_M:
            return False
        grid = self._grid.with_rects((spot,))
        if any(grid.regions(radius_m) != 1 for radius_m in PASSAGE_RADII_M):
            return False
        if not all(_is_approached(grid, piece) for piece in self._carriers):
            return False
        self._grid = grid
        self._kept.append(spot)
        return True


def _is_approached(grid: ClearanceGrid, piece: Furniture) -> bool:
    """Whether the widest robot can stand near the piece."""
    near = grid.cells_m[grid.cells_in(piece.footprint.grown(REACH_M))]
    return bool((near >= max(PASSAGE_RADII_M)).any())


def _doorway(door: Door) -> Rect:
    """The floor of a door and before it, on both sides."""
    opening = door.opening
    beyond_x, beyond_y = (0.0, DOOR_FREE_M) if door.along_x else (DOOR_FREE_M, 0.0)
    return Rect(
        x_min_m=opening.x_min_m - beyond_x,
        y_min_m=opening.y_min_m - beyond_y,
        x_max_m=opening.x_max_m + beyond_x,
        y_max_m=opening.y_max_m + beyond_y,
    )


def _before_carriers(rng: np.random.Generator, home: Home) -> Iterator[tuple[float, float, int]]:
    """Places x, y (m) and quarter turns between rooms' middles and carriers, broadside to the line."""
    rooms = {room.name: room for room in home.rooms}
    carriers = [piece for piece in home.furniture if piece.carries]
    for _ in range(TRIES if carriers else 0):
        piece = pick(rng, carriers)
        middle_m = rooms[piece.room].inside.centre_m
        along_x, along_y = piece.x_m - middle_m[0], piece.y_m - middle_m[1]
        share = rng.uniform(*HIDES_AT)
        aside_x, aside_y = rng.uniform(-HIDES_BESIDE_M, HIDES_BESIDE_M, size=2)
        turns = (0 if along_x < 0.0 else 2) if abs(along_x) > abs(along_y) else (1 if along_y < 0.0 else 3)
        yield (
            *_on_grid(middle_m[0] + share * along_x + aside_x, middle_m[1] + share * along_y + aside_y),
            turns,
        )


def _anywhere(rng: np.random.Generator, home: Home) -> Iterator[tuple[float, float, int]]:
    """Places in any room, larger rooms more often."""
    areas = np.array([room.inside.area_m2 for room in home.rooms])
    for _ in range(TRIES):
        room: Room = home.rooms[int(rng.choice(len(areas), p=areas / areas.sum()))]
        inside = room.inside
        x_m, y_m = rng.uniform(inside.x_min_m, inside.x_max_m), rng.uniform(inside.y_min_m, inside.y_max_m)
        yield (*_on_grid(x_m, y_m), int(rng.integers(4)))


def _on_grid(x_m: float, y_m: float) -> tuple[float, float]:
    """The point on the floor plan's grid: footprints there lose no floor to half-covered cells."""
    steps_x, steps_y = round(x_m / RESOLUTION_M), round(y_m / RESOLUTION_M)
    return round(steps_x * RESOLUTION_M, 6), round(steps_y * RESOLUTION_M, 6)


def _footprint(x_m: float, y_m: float, quarter_turns: int, depth_m: float, width_m: float) -> Rect:
    half_x, half_y = (
        (depth_m / 2.0, width_m / 2.0) if quarter_turns % 2 == 0 else (width_m / 2.0, depth_m / 2.0)
    )
    return Rect(x_min_m=x_m - half_x, y_min_m=y_m - half_y, x_max_m=x_m + half_x, y_max_m=y_m + half_y)
