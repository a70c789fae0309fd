"""A small home built by hand, so that what the sensors do is tested whatever the generator makes."""

import pytest

from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.home import DOOR_HEIGHT_M, Door, Furniture, Home, Room, SmallObject, Wall, Window
from sim_bridge.homes.materials import Substance, material
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.scene import Look, Style
from sim_bridge.homes.shapes import Axis, Part, Vector3, ball, box, cylinder

HALF_M = 0.05


def rect(x_min_m: float, y_min_m: float, x_max_m: float, y_max_m: float) -> Rect:
    return Rect(x_min_m=x_min_m, y_min_m=y_min_m, x_max_m=x_max_m, y_max_m=y_max_m)


def walls_of(inside: Rect, door: Rect, paint: str) -> list[Wall]:
    """The walls of a room, with the door in that one which it touches."""
    out, inn = inside.grown(HALF_M), inside
    strips = {
        Side.SOUTH: rect(out.x_min_m, out.y_min_m, out.x_max_m, inn.y_min_m),
        Side.NORTH: rect(out.x_min_m, inn.y_max_m, out.x_max_m, out.y_max_m),
        Side.WEST: rect(out.x_min_m, inn.y_min_m, inn.x_min_m, inn.y_max_m),
        Side.EAST: rect(inn.x_max_m, inn.y_min_m, out.x_max_m, inn.y_max_m),
    }
    walls = []
    for side, strip in strips.items():
        pieces = [(strip, 0.0)]
        if strip.overlaps(door):
            x, X = strip.x_min_m, strip.x_max_m
            pieces = [
                (rect(x, strip.y_min_m, X, door.y_min_m), 0.0),
                (rect(x, door.y_min_m, X, door.y_max_m), DOOR_HEIGHT_M),
                (rect(x, door.y_max_m, X, strip.y_max_m), 0.0),
            ]
        walls += [
            Wall(base=base, z_min_m=z_m, z_max_m=2.5, material=material(paint), hidden=side)
            for base, z_m in pieces
        ]
    return walls


def piece(name: str, x_m: float, y_m: float, turns: int, parts: tuple[Part, ...]) -> Furniture:
    return Furniture(
        name=name,
        kind=name,
        room="kitchen",
        x_m=x_m,
        y_m=y_m,
        quarter_turns=turns,
        style=Style(width_m=1.0, main=material("oak wood"), accent=material("oak wood")),
        depth_m=0.8,
        width_m=1.2,
        height_m=0.8,
        tall=False,
        surfaces=(),
        parts=parts,
    )


def thing(instance: int, place_m: Vector3, yaw_rad: float, parts: tuple[Part, ...]) -> SmallObject:
    return SmallObject(
        instance=instance,
        label="mug",
        look=Look(colour="red", substance=Substance.CERAMIC),
        room="kitchen",
        furniture="table",
        surface=0,
        x_m=place_m[0],
        y_m=place_m[1],
        z_m=place_m[2],
        yaw_rad=yaw_rad,
        parts=parts,
    )


@pytest.fixture(scope="session")
def small_home() -> Home:
    """Two rooms with a door between; shapes of every kind, cylinders along every axis."""
    kitchen, bedroom = rect(0.05, 0.05, 3.95, 3.45), rect(4.05, 0.05, 7.95, 3.45)
    opening = rect(3.95, 1.2, 4.05, 2.2)
    oak, steel = material("oak wood"), material("silver metal")
    legs = tuple(
        box((x * 0.35, y * 0.55, 0.36), (0.05, 0.05, 0.72), material("walnut wood"))
        for x in (-1, 1)
        for y in (-1, 1)
    )
    table = (box((0.0, 0.0, 0.74), (0.8, 1.2, 0.04), oak), *legs)
    chest = (
        box((0.0, 0.0, 0.4), (0.4, 1.0, 0.8), material("blue checked fabric")),
        cylinder((0.22, 0.0, 0.6), 0.03, 0.4, steel, Axis.Y),
        cylinder((0.25, 0.3, 0.3), 0.06, 0.10, steel, Axis.X),
    )
    roll = cylinder((0.0, 0.0, 0.06), 0.12, 0.25, material("green striped plastic"), Axis.X)
    pot = (
        cylinder((0.0, 0.0, 0.1), 0.2, 0.2, material("red dotted ceramic")),
        ball((0.0, 0.0, 0.24), 0.08, steel),
        cylinder((0.0, 0.13, 0.12), 0.03, 0.1, steel, Axis.Y),
    )
    return Home(
        name="by hand",
        seed=None,
        bounds=rect(0.0, 0.0, 8.0, 3.5),
        rooms=(
            Room(
                name="kitchen",
                kind="kitchen",
                inside=kitchen,
                floor=material("cream tiles"),
                walls=material("cream paint"),
            ),
            Room(
                name="bedroom",
                kind="bedroom",
                inside=bedroom,
                floor=material("oak boards"),
                walls=material("#c8d4e0 paint"),
            ),
        ),
        doors=(Door(rooms=("kitchen", "bedroom"), opening=opening, along_x=False),),
        windows=(
            Window(
                room="bedroom",
                side=Side.EAST,
                pane=rect(7.95, 1.0, 7.97, 2.4),
                z_min_m=0.9,
                z_max_m=2.1,
            ),
        ),
        walls=(
            *walls_of(kitchen, opening, "cream paint"),
            *walls_of(bedroom, opening, "#c8d4e0 paint"),
        ),
        furniture=(piece("table", 2.4, 2.4, 0, table), piece("chest", 6.0, 0.35, 1, chest)),
        objects=(
            thing(0, (2.3, 2.2, 0.76), 0.7, (roll,)),
            thing(1, (2.5, 2.7, 0.76), -0.4, pot),
            thing(2, (6.1, 0.3, 0.80), 1.2, (ball((0.0, 0.0, 0.09), 0.18, material("orange plastic")),)),
        ),
        labels=("mug",),
        start=Pose2D(x_m=1.0, y_m=1.0),
    )


@pytest.fixture(scope="session")
def viewpoints() -> list[Pose2D]:
    """Where a robot may stand in the small home."""
    return [
        Pose2D(x_m=1.0, y_m=1.0, yaw_rad=0.8),
        Pose2D(x_m=1.2, y_m=2.6, yaw_rad=-0.2),
        Pose2D(x_m=3.5, y_m=1.7, yaw_rad=2.5),
        Pose2D(x_m=3.0, y_m=1.0, yaw_rad=1.9),
        Pose2D(x_m=2.2, y_m=0.6, yaw_rad=0.3),
        Pose2D(x_m=4.6, y_m=1.7, yaw_rad=-0.7),
        Pose2D(x_m=5.2, y_m=2.5, yaw_rad=-1.2),
        Pose2D(x_m=7.4, y_m=2.8, yaw_rad=-2.3),
        Pose2D(x_m=6.0, y_m=1.6, yaw_rad=-1.5),
        Pose2D(x_m=6.5, y_m=1.7, yaw_rad=3.1),
    ]
