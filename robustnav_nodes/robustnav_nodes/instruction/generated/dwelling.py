"""A home as an instruction speaks of it: rooms, and things in boxes. Where it comes from is not known here.

Metres in one frame, z up, the floor at 0. Doors are things as well: openings that join two rooms.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from robustnav_msgs_py.values import Float64

Vector3 = tuple[float, float, float]
DOOR = "door"
OVERHEAD_M = 1.3  # what begins above is walked under


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """A rectangle of floor between walls; `kind` is one of `room_words.WORDS`."""

    name: str
    kind: str
    low_m: tuple[float, float]
    high_m: tuple[float, float]

    def holds(self, x_m: float, y_m: float) -> bool:
        return self.low_m[0] <= x_m <= self.high_m[0] and self.low_m[1] <= y_m <= self.high_m[1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Thing:
    """What a detector may see and a person may name.

    `number` is its place in the dwelling's list; `looks` are words that are true of it ("wooden");
    `stands_on` the thing that carries it; `joins` the two rooms of a door.
    """

    number: int
    name: str
    room: str
    low_m: Vector3
    high_m: Vector3
    looks: tuple[str, ...] = ()
    stands_on: int | None = None
    joins: tuple[str, str] | None = None

    @property
    def centre_m(self) -> Vector3:
        low, high = self.low_m, self.high_m
        return (low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0, (low[2] + high[2]) / 2.0

    @property
    def is_in_the_way(self) -> bool:
        """Whether somebody who walks must keep off it."""
        return self.joins is None and self.low_m[2] < OVERHEAD_M and self.high_m[2] > 0.05

    @property
    def stands(self) -> bool:
        """Whether it stands on the floor, higher than a rug."""
        return self.is_in_the_way and self.low_m[2] <= 0.01 and self.high_m[2] > 0.25

    def away_m(self, x_m: float, y_m: float) -> float:
        """Distance on the floor from a point to the nearest side; 0 inside."""
        return math.hypot(
            max(self.low_m[0] - x_m, 0.0, x_m - self.high_m[0]),
            max(self.low_m[1] - y_m, 0.0, y_m - self.high_m[1]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Dwelling:
    """A furnished home. `walls` [W, 2, 3]: lowest and highest corner of each piece of wall, lintels too."""

    name: str
    rooms: tuple[Room, ...]
    things: tuple[Thing, ...]
    walls: Float64
    camera_m: float
    _rooms_by_name: dict[str, Room] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_rooms_by_name", {room.name: room for room in self.rooms})

    def room(self, name: str) -> Room:
        return self._rooms_by_name[name]

    def room_at(self, x_m: float, y_m: float) -> Room | None:
        """The room around a point; None in a doorway, a wall and outside."""
        return next((room for room in self.rooms if room.holds(x_m, y_m)), None)

    @property
    def doors(self) -> tuple[Thing, ...]:
        return tuple(thing for thing in self.things if thing.joins is not None)

    def footprints(self) -> Float64:
        """What walkers keep off, [F, 4]: x and y of the lowest, then of the highest corner."""
        walls = [(*low[:2], *high[:2]) for low, high in self.walls.tolist() if low[2] < OVERHEAD_M]
        things = [(*t.low_m[:2], *t.high_m[:2]) for t in self.things if t.is_in_the_way]
        return np.array([*walls, *things]).reshape(-1, 4)
