"""A home's rooms, doors and windows by chance: draws until one is a home that people would build."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import WALL_THICKNESS_M
from sim_bridge.homes.rect import Rect, Side, snapped
from sim_bridge.homes.rooms.door_choice import DOOR_MARGIN_M, DOOR_WIDTHS_M, DoorPlace, choose_doors
from sim_bridge.homes.rooms.finishes import draw_finishes
from sim_bridge.homes.rooms.ground_plan import MAY_LIE_INSIDE, draw_ground_plan
from sim_bridge.homes.rooms.room_programmes import ProgrammeRoom
from sim_bridge.homes.rooms.wall_lines import Stretch, outer_stretches
from sim_bridge.homes.scene import SceneDoor, SceneRoom, SceneWindow

DRAWS = 20_000
# A door near the end of its wall leaves the rest of the wall to furniture.
P_DOOR_NEAR_END = 0.6
WINDOW_WIDTHS_M = (1.0, 1.8)
WINDOW_FROM_CORNER_M = 0.40
WINDOW_MARGIN_M = WINDOW_FROM_CORNER_M + WALL_THICKNESS_M / 2.0
P_SECOND_WINDOW = 0.5
BATHROOM_WINDOW_M = (0.6, 0.9)
BATHROOM_SILL_M = 1.4
WITHOUT_WINDOW = ("hallway", "storage room")


@dataclass(frozen=True, slots=True, kw_only=True)
class FloorLayout:
    """The rooms of a home in the order of its programme, and the doors and windows in their walls."""

    rooms: tuple[SceneRoom, ...]
    doors: tuple[SceneDoor, ...]
    windows: tuple[SceneWindow, ...]


def lay_out(rng: np.random.Generator, programme: Sequence[ProgrammeRoom]) -> FloorLayout:
    """Rooms that fill a rectangle whose lower left corner is the origin of `map`.

    Raises BadSceneError where no draw gives every room what it needs.
    """
    for _ in range(DRAWS):
        areas = draw_ground_plan(rng, programme)
        if areas is None or not _has_light(programme, areas):
            continue
        doors = choose_doors(rng, programme, areas)
        if doors is not None:
            return _finished(rng, programme, areas, doors)
    names = ", ".join(room.name for room in programme)
    raise BadSceneError(
        f"no ground plan for {names} came out of {DRAWS} draws; ask for other rooms or another seed"
    )


def _finished(
    rng: np.random.Generator,
    programme: Sequence[ProgrammeRoom],
    areas: Sequence[Rect],
    places: Sequence[DoorPlace],
) -> FloorLayout:
    finishes = draw_finishes(rng, programme)
    rooms = tuple(
        SceneRoom(name=room.name, kind=room.kind, area=area, floor=floor, walls=walls)
        for room, area, (floor, walls) in zip(programme, areas, finishes, strict=True)
    )
    doors = tuple(
        _door(rng, (rooms[place.rooms[0]].name, rooms[place.rooms[1]].name), place.stretch)
        for place in places
    )
    windows = tuple(window for room in rooms for window in _windows(rng, room, areas))
    return FloorLayout(rooms=rooms, doors=doors, windows=windows)


def _has_light(programme: Sequence[ProgrammeRoom], areas: Sequence[Rect]) -> bool:
    return all(
        room.kind in MAY_LIE_INSIDE or _walls_for_windows(area, areas)
        for room, area in zip(programme, areas, strict=True)
    )


def _walls_for_windows(area: Rect, areas: Sequence[Rect]) -> list[tuple[Side, Stretch]]:
    """The outer walls that have room for the smallest window."""
    others = [other for other in areas if other != area]
    needed_m = WINDOW_WIDTHS_M[0] + 2.0 * WINDOW_MARGIN_M
    return [
        (side, stretch)
        for side in Side
        for stretch in outer_stretches(area, side, others)
        if stretch.length_m >= needed_m - 1e-6
    ]


def _door(rng: np.random.Generator, rooms: tuple[str, str], stretch: Stretch) -> SceneDoor:
    width_m = float(rng.choice(DOOR_WIDTHS_M))
    low_m, spare_m = stretch.low_m + DOOR_MARGIN_M, stretch.length_m - 2.0 * DOOR_MARGIN_M - width_m
    share = float(rng.choice([0.0, 1.0])) if rng.random() < P_DOOR_NEAR_END else rng.random()
    # The ends of the opening lie on the grid, its middle may lie between.
    middle_m = round(snapped(low_m + share * spare_m) + width_m / 2.0, 6)
    x_m, y_m = (middle_m, stretch.line_m) if stretch.along_x else (stretch.line_m, middle_m)
    return SceneDoor(rooms=rooms, x_m=x_m, y_m=y_m, width_m=width_m)


def _windows(rng: np.random.Generator, room: SceneRoom, areas: Sequence[Rect]) -> list[SceneWindow]:
    """One window, or two in different outer walls; none where the room wants none or lies inside."""
    walls = _walls_for_windows(room.area, areas)
    if room.kind in WITHOUT_WINDOW or not walls:
        return []
    count = 2 if len(walls) > 1 and room.kind != "bathroom" and rng.random() < P_SECOND_WINDOW else 1
    chosen = [walls[int(at)] for at in rng.permutation(len(walls))[:count]]
    return [_window(rng, room, side, stretch) for side, stretch in chosen]


def _window(rng: np.random.Generator, room: SceneRoom, side: Side, stretch: Stretch) -> SceneWindow:
    bathroom = room.kind == "bathroom"
    narrowest_m, widest_m = BATHROOM_WINDOW_M if bathroom else WINDOW_WIDTHS_M
    low_m, high_m = stretch.low_m + WINDOW_MARGIN_M, stretch.high_m - WINDOW_MARGIN_M
    width_m = snapped(rng.uniform(narrowest_m, min(widest_m, snapped(high_m - low_m))))
    from_m = snapped(low_m + rng.random() * (high_m - low_m - width_m))
    to_m = snapped(from_m + width_m)
    if bathroom:
        return SceneWindow(room=room.name, side=side, from_m=from_m, to_m=to_m, sill_m=BATHROOM_SILL_M)
    return SceneWindow(room=room.name, side=side, from_m=from_m, to_m=to_m)
