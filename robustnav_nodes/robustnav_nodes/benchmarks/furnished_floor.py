"""Furnished floors drawn by seed: rooms, doors, furniture that holds objects, furniture that hides."""

import math
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from robustnav_msgs_py.values import Bool, OccupancyMap, Pose2D

CELL_M = 0.1
_WALL = 2  # cells, as thick as a candidate location is wide
_DOOR = 9  # cells
_SIDE = 2  # cells of a candidate location; furniture is drawn in these
_ROBOT_REACH = 3  # cells around a place to stand; with less, the lattice of poses may miss the way
_TRIES = 4000


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorStyle:
    """How a floor is drawn.

    rooms, area_m2: drawn evenly from the two bounds; filled: part of the floor that low furniture, which
    holds objects, should cover; tall: part that tall furniture, which hides what is behind it, should cover.
    """

    rooms: tuple[int, int]
    area_m2: tuple[float, float]
    filled: float
    tall: float


@dataclass(frozen=True, slots=True)
class _Room:
    """A rectangle of cells, its last row and column not included."""

    row: int
    column: int
    height: int
    width: int

    @property
    def slices(self) -> tuple[slice, slice]:
        return (slice(self.row, self.row + self.height), slice(self.column, self.column + self.width))


def draw_floor(style: FloorStyle, rng: np.random.Generator) -> tuple[OccupancyMap, OccupancyMap]:
    """Map and candidate mask, both with cells of 0.1 m. All free floor that a robot fits on is connected."""
    rooms_wanted = int(rng.integers(style.rooms[0], style.rooms[1] + 1))
    area_m2 = rng.uniform(*style.area_m2)
    aspect = rng.uniform(1.0, 1.5)
    width = _even(math.sqrt(area_m2 * aspect) / CELL_M)
    height = _even(math.sqrt(area_m2 / aspect) / CELL_M)
    while True:
        walls = np.ones((height + 2 * _WALL, width + 2 * _WALL), dtype=np.bool_)
        whole = _Room(row=_WALL, column=_WALL, height=height, width=width)
        walls[whole.slices] = False
        doorways = np.zeros_like(walls)
        rooms = _divide(whole, rooms_wanted, walls, doorways, rng)
        if _is_connected(walls):  # not where a later wall met an earlier door
            break
    low, tall = np.zeros_like(walls), np.zeros_like(walls)
    _furnish(rooms, walls, doorways, low, tall, style, rng)

    occupied = (walls | low | tall).astype(np.int8) * np.int8(100)
    masked = low.astype(np.int8) * np.int8(100)
    origin = Pose2D(x_m=0.0, y_m=0.0)
    floor_map = OccupancyMap(cells=occupied, resolution_m=CELL_M, origin=origin)
    return floor_map, OccupancyMap(cells=masked, resolution_m=CELL_M, origin=origin)


def _even(cells: float) -> int:
    return _SIDE * max(1, round(cells / _SIDE))


def _divide(whole: _Room, count: int, walls: Bool, doorways: Bool, rng: np.random.Generator) -> list[_Room]:
    """Cut the largest room in two, with a door between the halves, until there are `count`."""
    rooms = [whole]
    while len(rooms) < count:
        rooms.sort(key=lambda room: room.height * room.width)
        room = rooms.pop()
        along_rows = room.height >= room.width
        length = room.height if along_rows else room.width
        across = room.width if along_rows else room.height
        cut = _even(length * rng.uniform(0.35, 0.65))
        door = int(rng.integers(_SIDE, across - _DOOR - _SIDE + 1))
        span = (slice(cut, cut + _WALL), slice(None))
        gap = (slice(cut - 4, cut + _WALL + 4), slice(door, door + _DOOR))
        inside, kept_free = walls[room.slices], doorways[room.slices]
        if not along_rows:
            inside, kept_free = inside.T, kept_free.T
        inside[span] = True
        inside[gap] = False
        kept_free[gap] = True
        first, second = cut, length - cut - _WALL
        if along_rows:
            rooms.append(_Room(room.row, room.column, first, room.width))
            rooms.append(_Room(room.row + cut + _WALL, room.column, second, room.width))
        else:
            rooms.append(_Room(room.row, room.column, room.height, first))
            rooms.append(_Room(room.row, room.column + cut + _WALL, room.height, second))
    return rooms


def _furnish(
    rooms: list[_Room],
    walls: Bool,
    doorways: Bool,
    low: Bool,
    tall: Bool,
    style: FloorStyle,
    rng: np.random.Generator,
) -> None:
    """Put pieces where they leave the floor connected until enough of it is covered."""
    floor = int(np.count_nonzero(~walls))
    weight = np.array([room.height * room.width for room in rooms], dtype=np.float64)
    weight /= weight.sum()
    for _ in range(_TRIES):
        short_of_tall = bool(np.count_nonzero(tall) < style.tall * floor)
        short_of_low = bool(np.count_nonzero(low) < style.filled * floor)
        if not short_of_tall and not short_of_low:
            return
        room = rooms[int(rng.choice(len(rooms), p=weight))]
        piece = _piece(room, rng, is_tall=short_of_tall)
        taken = walls[piece] | doorways[piece] | low[piece] | tall[piece]
        if taken.any():
            continue
        blocked = walls | low | tall
        blocked[piece] = True
        if _is_connected(blocked):
            (tall if short_of_tall else low)[piece] = True


def _piece(room: _Room, rng: np.random.Generator, *, is_tall: bool) -> tuple[slice, slice]:
    """A rectangle in the room; two of three stand at a wall, tall ones always."""
    height = min(_SIDE * int(rng.integers(1, 7)), room.height)
    width = min(_SIDE * int(rng.integers(1, 7)), room.width)
    row = int(rng.integers(0, room.height - height + 1))
    column = int(rng.integers(0, room.width - width + 1))
    if is_tall or rng.random() < 2 / 3:
        wall = int(rng.integers(4))
        row = (0, room.height - height, row, row)[wall]
        column = (column, column, 0, room.width - width)[wall]
    row, column = room.row + row, room.column + column
    return slice(row, row + height), slice(column, column + width)


def _is_connected(blocked: Bool) -> bool:
    """Whether a robot can go from every place where it fits to every other."""
    room_to_stand = ~ndimage.binary_dilation(
        blocked, structure=np.ones((2 * _ROBOT_REACH + 1, 2 * _ROBOT_REACH + 1))
    )
    _, parts = ndimage.label(room_to_stand)
    return int(parts) == 1
