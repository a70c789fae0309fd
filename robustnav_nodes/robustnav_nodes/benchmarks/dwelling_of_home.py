"""Simulated homes for `instruction.generated`: furniture, objects, doors and windows as things."""

from typing import TYPE_CHECKING

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.generated.dwelling import DOOR, Dwelling, Room, Thing, Vector3

if TYPE_CHECKING:  # the simulator stands on this package
    from sim_bridge.homes.home import Home, Wall
    from sim_bridge.homes.materials import Material
    from sim_bridge.homes.rect import Rect

# What a detector calls the kinds of furniture whose own name is not what people say.
_FURNITURE = {
    "sink unit": "sink",
    "washstand": "sink",
    "fridge": "refrigerator",
    "cupboard": "cabinet",
    "bathroom cabinet": "cabinet",
    "filing cabinet": "cabinet",
    "tv stand": "cabinet",
    "sideboard": "cabinet",
    "shoe bench": "bench",
    "mat": "rug",
    "single bed": "bed",
    "toy chest": "toy box",
    "sofa": "couch",
    "bookcase": "bookshelf",
    "low shelf": "shelf",
}
_OBJECTS = {"vase": "flower vase", "teddy": "teddy bear"}
# Words that people use of what something is made of, or of its colour.
_MADE_OF = {"wood": "wooden", "boards": "wooden", "leather": "leather", "metal": "metal", "glass": "glass"}
_WOODS = frozenset({"oak", "walnut", "cherry"})
_SAID_COLOURS = frozenset(
    {
        *("red", "blue", "green", "yellow", "white", "black", "brown", "grey", "orange", "purple", "pink"),
        *("turquoise", "beige", "silver", "gold"),
    }
)
_MAT_HEIGHT_M = 0.04
_CAMERA_M = (1.1, 1.6)
# A hallway with one of these may be where one comes in.
_ENTRANCE, _P_ENTRANCE = frozenset({"shoe bench"}), 0.4


def dwelling_of(home: "Home", rng: np.random.Generator) -> Dwelling:
    """The home as boxes with names; how high the camera is carried is drawn."""
    entrances = {
        piece.room for piece in home.furniture if piece.kind in _ENTRANCE and rng.random() < _P_ENTRANCE
    }
    rooms = tuple(
        Room(
            name=room.name,
            kind="entryway" if room.kind == "hallway" and room.name in entrances else room.kind,
            low_m=(room.inside.x_min_m, room.inside.y_min_m),
            high_m=(room.inside.x_max_m, room.inside.y_max_m),
        )
        for room in home.rooms
    )
    return Dwelling(
        name=home.name,
        rooms=rooms,
        things=_things(home),
        walls=_walls(home.walls),
        camera_m=round(float(rng.uniform(*_CAMERA_M)), 2),
    )


def _things(home: "Home") -> tuple[Thing, ...]:
    from sim_bridge.homes.home import DOOR_HEIGHT_M

    things: list[Thing] = []
    numbers: dict[str, int] = {}
    for piece in home.furniture:
        height = _MAT_HEIGHT_M if piece.kind == "mat" else piece.height_m
        numbers[piece.name] = len(things)
        things.append(
            _thing(
                len(things),
                _FURNITURE.get(piece.kind, piece.kind),
                piece.room,
                piece.footprint,
                (0.0, height),
                looks=_looks(piece.style.main),
            )
        )
    for item in home.objects:
        z = item.corners_m()[:, 2]
        things.append(
            _thing(
                len(things),
                _OBJECTS.get(item.label, item.label),
                item.room,
                item.footprint,
                (float(z.min()), float(z.max())),
                looks=_looks(item.look.material),
                stands_on=numbers[item.furniture],
            )
        )
    for window in home.windows:
        things.append(
            _thing(len(things), "window", window.room, window.pane, (window.z_min_m, window.z_max_m))
        )
    for door in home.doors:
        things.append(
            _thing(
                len(things),
                DOOR,
                door.rooms[0],
                door.opening,
                (0.0, DOOR_HEIGHT_M),
                looks=("open",),
                joins=door.rooms,
            )
        )
    return tuple(things)


def _thing(
    number: int,
    name: str,
    room: str,
    floor: "Rect",
    z_m: tuple[float, float],
    *,
    looks: tuple[str, ...] = (),
    stands_on: int | None = None,
    joins: tuple[str, str] | None = None,
) -> Thing:
    low: Vector3 = (floor.x_min_m, floor.y_min_m, z_m[0])
    high: Vector3 = (floor.x_max_m, floor.y_max_m, z_m[1])
    return Thing(
        number=number,
        name=name,
        room=room,
        low_m=low,
        high_m=high,
        looks=looks,
        stands_on=stands_on,
        joins=joins,
    )


def _looks(material: "Material") -> tuple[str, ...]:
    looks = []
    if material.substance in _MADE_OF:
        looks.append(_MADE_OF[material.substance])
    if material.colour in _SAID_COLOURS:
        looks.append(material.colour)
    elif material.colour in _WOODS:
        looks.append("brown")
    return tuple(looks)


def _walls(walls: "tuple[Wall, ...]") -> Float64:
    return np.array(
        [
            (
                (wall.base.x_min_m, wall.base.y_min_m, wall.z_min_m),
                (wall.base.x_max_m, wall.base.y_max_m, wall.z_max_m),
            )
            for wall in walls
        ]
    ).reshape(-1, 2, 3)
