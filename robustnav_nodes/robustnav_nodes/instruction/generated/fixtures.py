"""What lived-in homes have besides furniture: mirrors, curtains, a fireplace, a bin; drawn by chance.

They make the vocabulary of instructions as wide as people's. None stands where somebody walks through a door.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from robustnav_nodes.instruction.generated.dwelling import Dwelling, Room, Thing, Vector3

_TRIES = 12
_GAP_M = 0.02
_DOOR_SPACE_M = 0.7


class Where(Enum):
    """Where in a room a fixture belongs."""

    WALL = "against or on a wall"
    MIDDLE = "in the middle"
    CORNER = "in a corner"


@dataclass(frozen=True, slots=True, kw_only=True)
class Fixture:
    """A kind of fixture: how likely each kind of room has one, its extent and how high up it begins."""

    name: str
    rooms: dict[str, float]
    depth_m: float
    width_m: float
    height_m: float
    z_m: float = 0.0
    where: Where = Where.WALL
    looks: tuple[str, ...] = ()


def _everywhere(p: float) -> dict[str, float]:
    rooms = ("living room", "kitchen", "dining room", "bedroom", "children's room", "office", "hallway")
    return dict.fromkeys((*rooms, "entryway"), p)


FIXTURES = (
    Fixture(
        name="fireplace",
        rooms={"living room": 0.4, "dining room": 0.15},
        depth_m=0.35,
        width_m=1.2,
        height_m=1.15,
        looks=("stone", "brick", "white"),
    ),
    Fixture(
        name="piano",
        rooms={"living room": 0.15, "dining room": 0.1, "hallway": 0.05},
        depth_m=0.6,
        width_m=1.4,
        height_m=1.1,
        looks=("black", "upright", "grand"),
    ),
    Fixture(
        name="treadmill",
        rooms={"office": 0.15, "storage room": 0.2, "bedroom": 0.06},
        depth_m=1.5,
        width_m=0.7,
        height_m=1.2,
    ),
    Fixture(
        name="shower",
        rooms={"bathroom": 0.6},
        depth_m=0.85,
        width_m=0.85,
        height_m=2.0,
        where=Where.CORNER,
        looks=("glass", "walk-in"),
    ),
    Fixture(
        name="ottoman",
        rooms={"living room": 0.35, "bedroom": 0.2, "office": 0.1},
        depth_m=0.5,
        width_m=0.6,
        height_m=0.42,
        looks=("round", "leather", "small"),
    ),
    Fixture(name="dishwasher", rooms={"kitchen": 0.5}, depth_m=0.6, width_m=0.6, height_m=0.85),
    Fixture(
        name="bench",
        rooms={"hallway": 0.15, "bedroom": 0.2, "dining room": 0.2},
        depth_m=0.4,
        width_m=1.1,
        height_m=0.45,
        looks=("wooden", "long", "low"),
    ),
    Fixture(
        name="plant",
        rooms=_everywhere(0.25) | {"bathroom": 0.15},
        depth_m=0.4,
        width_m=0.4,
        height_m=1.2,
        where=Where.CORNER,
        looks=("tall", "green", "large", "leafy"),
    ),
    Fixture(
        name="statue",
        rooms={"hallway": 0.15, "living room": 0.15, "entryway": 0.25, "office": 0.08, "dining room": 0.08},
        depth_m=0.35,
        width_m=0.35,
        height_m=1.3,
        where=Where.CORNER,
        looks=("bronze", "marble", "tall"),
    ),
    Fixture(
        name="floor lamp",
        rooms={"living room": 0.5, "bedroom": 0.3, "office": 0.35, "children's room": 0.2, "hallway": 0.1},
        depth_m=0.35,
        width_m=0.35,
        height_m=1.6,
        where=Where.CORNER,
        looks=("tall", "standing", "bright"),
    ),
    Fixture(
        name="trash can",
        rooms={"kitchen": 0.6, "office": 0.5, "bathroom": 0.35, "laundry room": 0.3, "storage room": 0.3},
        depth_m=0.3,
        width_m=0.3,
        height_m=0.5,
        looks=("silver", "small", "black"),
    ),
    Fixture(
        name="basket",
        rooms={"laundry room": 0.6, "bathroom": 0.3, "bedroom": 0.25, "storage room": 0.3},
        depth_m=0.4,
        width_m=0.5,
        height_m=0.55,
        looks=("wicker", "woven", "large"),
    ),
    Fixture(
        name="column",
        rooms={"living room": 0.15, "entryway": 0.2, "dining room": 0.1},
        depth_m=0.3,
        width_m=0.3,
        height_m=2.4,
        where=Where.CORNER,
        looks=("white", "round", "square"),
    ),
    Fixture(
        name="mirror",
        rooms={"bathroom": 0.8, "bedroom": 0.4, "hallway": 0.4, "entryway": 0.6, "children's room": 0.2},
        depth_m=0.03,
        width_m=0.6,
        height_m=0.9,
        z_m=1.35,
        looks=("large", "round", "framed"),
    ),
    Fixture(
        name="picture",
        rooms=_everywhere(0.5) | {"bathroom": 0.2},
        depth_m=0.03,
        width_m=0.7,
        height_m=0.5,
        z_m=1.4,
        looks=("framed", "colorful", "large", "abstract"),
    ),
    Fixture(
        name="picture",
        rooms=_everywhere(0.3),
        depth_m=0.03,
        width_m=0.5,
        height_m=0.6,
        z_m=1.4,
        looks=("small", "framed"),
    ),
    Fixture(
        name="clock",
        rooms={"kitchen": 0.4, "office": 0.35, "living room": 0.3, "hallway": 0.2, "dining room": 0.25},
        depth_m=0.05,
        width_m=0.4,
        height_m=0.4,
        z_m=1.6,
        looks=("round", "large"),
    ),
    Fixture(
        name="towel",
        rooms={"bathroom": 0.7, "laundry room": 0.3, "kitchen": 0.15},
        depth_m=0.05,
        width_m=0.6,
        height_m=0.6,
        z_m=1.31,
        looks=("white", "blue", "striped"),
    ),
    Fixture(
        name="thermostat",
        rooms={"hallway": 0.4, "living room": 0.25, "dining room": 0.15},
        depth_m=0.04,
        width_m=0.2,
        height_m=0.2,
        z_m=1.4,
    ),
    Fixture(
        name="microwave",
        rooms={"kitchen": 0.55},
        depth_m=0.35,
        width_m=0.5,
        height_m=0.3,
        z_m=1.32,
        looks=("white", "black"),
    ),
    Fixture(
        name="chandelier",
        rooms={"dining room": 0.5, "living room": 0.25, "entryway": 0.3, "bedroom": 0.08},
        depth_m=0.6,
        width_m=0.6,
        height_m=0.5,
        z_m=1.9,
        where=Where.MIDDLE,
        looks=("large", "crystal", "hanging"),
    ),
    Fixture(
        name="ceiling fan",
        rooms={"bedroom": 0.35, "living room": 0.2, "office": 0.2, "children's room": 0.25},
        depth_m=1.1,
        width_m=1.1,
        height_m=0.3,
        z_m=2.1,
        where=Where.MIDDLE,
    ),
    Fixture(
        name="rug",
        rooms={"living room": 0.6, "bedroom": 0.4, "hallway": 0.45, "dining room": 0.3, "office": 0.3},
        depth_m=1.3,
        width_m=1.1,
        height_m=0.02,
        where=Where.MIDDLE,
        looks=("large", "patterned", "red", "grey", "soft"),
    ),
)
P_CURTAIN = 0.45
_CURTAINED = frozenset({"living room", "bedroom", "children's room", "dining room", "office"})


def with_fixtures(dwelling: Dwelling, rng: np.random.Generator) -> Dwelling:
    """The dwelling with what chance adds to each room."""
    things = list(dwelling.things)
    for room in dwelling.rooms:
        for fixture in FIXTURES:
            if rng.random() >= fixture.rooms.get(room.kind, 0.0):
                continue
            place = _place(room, fixture, things, rng)
            if place is not None:
                looks = fixture.looks
                look = (looks[int(rng.integers(len(looks)))],) if looks else ()
                things.append(_thing(len(things), fixture.name, room.name, place, look))
    for window in dwelling.things:
        has_curtain = window.name == "window" and dwelling.room(window.room).kind in _CURTAINED
        if has_curtain and rng.random() < P_CURTAIN:
            low, high = window.low_m, window.high_m
            # larger than the window, in front of it
            around = (
                (low[0] - 0.03, low[1] - 0.03, low[2] - 0.2),
                (high[0] + 0.03, high[1] + 0.03, high[2] + 0.1),
            )
            things.append(_thing(len(things), "curtain", window.room, around, ()))
    return replace(dwelling, things=tuple(things))


Box = tuple[Vector3, Vector3]


def _thing(number: int, name: str, room: str, box: Box, looks: tuple[str, ...]) -> Thing:
    return Thing(number=number, name=name, room=room, low_m=box[0], high_m=box[1], looks=looks)


def _place(room: Room, fixture: Fixture, things: Sequence[Thing], rng: np.random.Generator) -> Box | None:
    """A free place of that kind, or None."""
    for _, (x, y, depth, width) in zip(range(_TRIES), _drawn(room, fixture, rng), strict=False):
        box = (
            (x - depth / 2.0, y - width / 2.0, fixture.z_m),
            (x + depth / 2.0, y + width / 2.0, fixture.z_m + fixture.height_m),
        )
        inside = (
            room.low_m[0] <= box[0][0]
            and room.low_m[1] <= box[0][1]
            and box[1][0] <= room.high_m[0]
            and box[1][1] <= room.high_m[1]
        )
        if inside and not any(_meet(box, thing) for thing in things):
            return box
    return None


def _drawn(
    room: Room, fixture: Fixture, rng: np.random.Generator
) -> Iterator[tuple[float, float, float, float]]:
    """Places that could do: x and y of the middle, extents along x and y."""
    deep, wide = fixture.depth_m, fixture.width_m
    low, high = room.low_m, room.high_m
    while True:
        side = int(rng.integers(4))
        along_x = side >= 2  # the wall runs along x: the fixture's width does too
        size = (wide, deep) if along_x else (deep, wide)
        if fixture.where is Where.MIDDLE:
            x, y = ((low[k] + high[k]) / 2.0 + rng.normal(0.0, 0.15) for k in range(2))
        else:
            spare = [(low[k] + size[k] / 2.0 + _GAP_M, high[k] - size[k] / 2.0 - _GAP_M) for k in range(2)]
            if spare[0][0] > spare[0][1] or spare[1][0] > spare[1][1]:
                return
            x, y = (rng.uniform(*ends) for ends in spare)
            if fixture.where is Where.CORNER:
                x, y = (ends[int(rng.integers(2))] for ends in spare)
            elif along_x:
                y = spare[1][side % 2]
            else:
                x = spare[0][side % 2]
        yield float(x), float(y), size[0], size[1]


def _meet(box: Box, thing: Thing) -> bool:
    """Whether they overlap; a door needs the floor in front of it, up to any height."""
    low, high = thing.low_m, thing.high_m
    if thing.joins is not None:
        low = (low[0] - _DOOR_SPACE_M, low[1] - _DOOR_SPACE_M, low[2])
        high = (high[0] + _DOOR_SPACE_M, high[1] + _DOOR_SPACE_M, high[2])
    return all(box[0][k] < high[k] and low[k] < box[1][k] for k in range(3))
