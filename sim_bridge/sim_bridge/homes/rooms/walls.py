"""Walls, door openings and window panes around the rooms of a scene.

A wall stands on the edge that two rooms share, half of it in each room, in that room's paint: a box has one
colour, and the two sides of a wall differ. Where a room shares no edge with another, the outer half of the
wall belongs to the shell. Rooms need not fill a rectangle; what lies between them is outside.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from sim_bridge.homes.home import (
    DOOR_HEIGHT_M,
    WALL_HEIGHT_M,
    WALL_THICKNESS_M,
    Door,
    Room,
    Wall,
    Window,
)
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.rooms.outer_shell import outer_shell
from sim_bridge.homes.rooms.shell_check import check_doors, check_reach, check_rooms, check_windows
from sim_bridge.homes.rooms.wall_lines import SAME_LINE_M, shared_stretch
from sim_bridge.homes.scene import SceneDoor, SceneRoom, SceneWindow

HALF_WALL_M = WALL_THICKNESS_M / 2.0
PANE_M = 0.02


@dataclass(frozen=True, slots=True, kw_only=True)
class Shell:
    """A home without its furniture; `bounds` reaches to the outer faces of the outermost walls."""

    bounds: Rect
    rooms: tuple[Room, ...]
    doors: tuple[Door, ...]
    windows: tuple[Window, ...]
    walls: tuple[Wall, ...]


def build_shell(
    rooms: Sequence[SceneRoom], doors: Sequence[SceneDoor], windows: Sequence[SceneWindow]
) -> Shell:
    """The walls of a described home.

    Raises BadSceneError where rooms overlap or cannot be reached, and where a door or a window has no wall.
    """
    check_rooms(rooms)
    check_doors(rooms, doors)
    check_reach(rooms, doors)
    check_windows(rooms, doors, windows)
    areas = {room.name: room.area for room in rooms}
    insides = {name: area.grown(-HALF_WALL_M) for name, area in areas.items()}
    openings = tuple(_door(door, areas) for door in doors)
    room_walls = [wall for room in rooms for wall in _room_walls(room, openings)]
    return Shell(
        bounds=_around([area.grown(HALF_WALL_M) for area in areas.values()]),
        rooms=tuple(
            Room(
                name=room.name, kind=room.kind, inside=insides[room.name], floor=room.floor, walls=room.walls
            )
            for room in rooms
        ),
        doors=openings,
        windows=tuple(_window(window, insides[window.room]) for window in windows),
        walls=(*outer_shell(list(areas.values())), *room_walls),
    )


def _around(areas: Sequence[Rect]) -> Rect:
    return Rect(
        x_min_m=min(area.x_min_m for area in areas),
        y_min_m=min(area.y_min_m for area in areas),
        x_max_m=max(area.x_max_m for area in areas),
        y_max_m=max(area.y_max_m for area in areas),
    )


def _door(door: SceneDoor, areas: dict[str, Rect]) -> Door:
    """The opening through both halves of the wall; check_doors has seen that there is one."""
    first, second = door.rooms
    stretch = shared_stretch(areas[first], areas[second])
    if stretch is None:
        raise AssertionError(f"check_doors let a door pass that has no wall: {door!r}")
    middle_m = door.x_m if stretch.along_x else door.y_m
    half_m = door.width_m / 2.0
    opening = stretch.strip(round(middle_m - half_m, 6), round(middle_m + half_m, 6), HALF_WALL_M)
    return Door(rooms=door.rooms, opening=opening, along_x=stretch.along_x)


def _window(window: SceneWindow, inside: Rect) -> Window:
    """A thin pane that stands before the inner face of the wall."""
    low_m, high_m = window.from_m, window.to_m
    x, y, X, Y = inside.x_min_m, inside.y_min_m, inside.x_max_m, inside.y_max_m
    pane = {
        Side.SOUTH: (low_m, y, high_m, y + PANE_M),
        Side.NORTH: (low_m, Y - PANE_M, high_m, Y),
        Side.WEST: (x, low_m, x + PANE_M, high_m),
        Side.EAST: (X - PANE_M, low_m, X, high_m),
    }[window.side]
    return Window(
        room=window.room,
        side=window.side,
        pane=Rect(x_min_m=pane[0], y_min_m=pane[1], x_max_m=pane[2], y_max_m=pane[3]),
        z_min_m=window.sill_m,
        z_max_m=window.top_m,
    )


def _room_walls(room: SceneRoom, doors: Sequence[Door]) -> list[Wall]:
    """The half of each wall that faces the room, in the room's paint, with lintels over its doors."""
    inside = room.area.grown(-HALF_WALL_M)
    walls = []
    for side, strip in _ring(room.area, inside).items():
        along_x = side in (Side.SOUTH, Side.NORTH)
        openings = [
            door.opening
            for door in doors
            if room.name in door.rooms and door.along_x == along_x and door.opening.overlaps(strip)
        ]
        for base, over_door in _cut_strip(strip, openings, along_x):
            walls.append(
                Wall(
                    base=base,
                    z_min_m=DOOR_HEIGHT_M if over_door else 0.0,
                    z_max_m=WALL_HEIGHT_M,
                    material=room.walls,
                    hidden=side,
                )
            )
    return walls


def _ring(outer: Rect, inner: Rect) -> dict[Side, Rect]:
    """The four strips between two rectangles; the corners belong to south and north."""
    x, X, y, Y = outer.x_min_m, outer.x_max_m, outer.y_min_m, outer.y_max_m
    low, high = inner.y_min_m, inner.y_max_m
    return {
        Side.SOUTH: Rect(x_min_m=x, y_min_m=y, x_max_m=X, y_max_m=low),
        Side.NORTH: Rect(x_min_m=x, y_min_m=high, x_max_m=X, y_max_m=Y),
        Side.WEST: Rect(x_min_m=x, y_min_m=low, x_max_m=inner.x_min_m, y_max_m=high),
        Side.EAST: Rect(x_min_m=inner.x_max_m, y_min_m=low, x_max_m=X, y_max_m=high),
    }


def _cut_strip(strip: Rect, openings: list[Rect], along_x: bool) -> list[tuple[Rect, bool]]:
    """The strip in pieces, each with whether it lies over a door."""
    low_m, high_m = (strip.x_min_m, strip.x_max_m) if along_x else (strip.y_min_m, strip.y_max_m)
    spans = sorted((o.x_min_m, o.x_max_m) if along_x else (o.y_min_m, o.y_max_m) for o in openings)
    pieces = []
    at_m = low_m
    for start_m, end_m in spans:
        pieces += [(at_m, start_m, False), (start_m, end_m, True)]
        at_m = end_m
    pieces.append((at_m, high_m, False))
    cut = []
    for start_m, end_m, over_door in pieces:
        if end_m - start_m <= SAME_LINE_M:
            continue
        if along_x:
            piece = Rect(x_min_m=start_m, y_min_m=strip.y_min_m, x_max_m=end_m, y_max_m=strip.y_max_m)
        else:
            piece = Rect(x_min_m=strip.x_min_m, y_min_m=start_m, x_max_m=strip.x_max_m, y_max_m=end_m)
        cut.append((piece, over_door))
    return cut
