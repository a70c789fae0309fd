"""Furnishing: rooms get what they are for, nothing is in the way, and the robot still gets everywhere."""

import math
import time
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import pytest
import scipy.ndimage

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.carpentry import GAP_M
from sim_bridge.homes.free_floor import FreeFloor, door_zone, standing
from sim_bridge.homes.furnishing import PASSAGE_RADII_M, furnish
from sim_bridge.homes.furniture.catalogue import (
    KINDS,
    build_furniture,
    default_style,
    design,
)
from sim_bridge.homes.home import (
    WALL_HEIGHT_M,
    WALL_THICKNESS_M,
    Door,
    Furniture,
    Room,
    Wall,
    Window,
)
from sim_bridge.homes.materials import material
from sim_bridge.homes.placement import Spot, aligned, snapped
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.scene import SceneFurniture
from sim_bridge.homes.wishes import WISHES, wishes_of
from sim_bridge.robot.obstacles import ClearanceGrid

HALF_M = WALL_THICKNESS_M / 2.0
PAINT = material("white paint")
RESOLUTION_M = 0.05
REACH_M = 0.45
# Area (m2) and smallest side (m) between wall middles, as rooms are laid out.
SIZES = {
    "living room": (16.0, 24.0, 3.2),
    "kitchen": (9.0, 14.0, 2.6),
    "dining room": (10.0, 14.0, 2.8),
    "bedroom": (10.0, 15.0, 2.8),
    "children's room": (10.0, 15.0, 2.6),
    "bathroom": (5.5, 8.0, 2.0),
    "office": (8.0, 12.0, 2.4),
    "hallway": (5.0, 10.0, 1.4),
    "laundry room": (5.0, 7.0, 1.8),
    "storage room": (5.0, 7.0, 1.8),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Shell:
    bounds: Rect
    rooms: tuple[Room, ...]
    doors: tuple[Door, ...]
    windows: tuple[Window, ...]
    walls: tuple[Wall, ...]


def rect(x_min: float, y_min: float, x_max: float, y_max: float) -> Rect:
    return Rect(x_min_m=x_min, y_min_m=y_min, x_max_m=x_max, y_max_m=y_max)


def shell(
    areas: list[tuple[str, str, Rect]], doors: list[tuple[str, str, Rect, bool]], windows: list[Window]
) -> Shell:
    """Rooms (name, kind, area to the wall's middle) with full-height walls around them, cut at doors."""
    rooms = tuple(
        Room(name=name, kind=kind, inside=area.grown(-HALF_M), floor=PAINT, walls=PAINT)
        for name, kind, area in areas
    )
    openings = [opening for _, _, opening, _ in doors]
    walls = [
        Wall(base=base, z_min_m=0.0, z_max_m=WALL_HEIGHT_M, material=PAINT, hidden=Side.SOUTH)
        for _, _, area in areas
        for strip in ring(area.grown(HALF_M), area.grown(-HALF_M))
        for base in without(strip, openings)
    ]
    xs = [x for _, _, area in areas for x in (area.x_min_m, area.x_max_m)]
    ys = [y for _, _, area in areas for y in (area.y_min_m, area.y_max_m)]
    return Shell(
        bounds=rect(min(xs), min(ys), max(xs), max(ys)).grown(HALF_M),
        rooms=rooms,
        doors=tuple(Door(rooms=(a, b), opening=opening, along_x=along_x) for a, b, opening, along_x in doors),
        windows=tuple(windows),
        walls=tuple(walls),
    )


def ring(outer: Rect, inner: Rect) -> list[Rect]:
    return [
        rect(outer.x_min_m, outer.y_min_m, outer.x_max_m, inner.y_min_m),
        rect(outer.x_min_m, inner.y_max_m, outer.x_max_m, outer.y_max_m),
        rect(outer.x_min_m, inner.y_min_m, inner.x_min_m, inner.y_max_m),
        rect(inner.x_max_m, inner.y_min_m, outer.x_max_m, inner.y_max_m),
    ]


def without(strip: Rect, openings: list[Rect]) -> list[Rect]:
    """The strip of wall in pieces beside the openings that cut it."""
    along_x = strip.width_m > strip.depth_m
    at = strip.x_min_m if along_x else strip.y_min_m
    end = strip.x_max_m if along_x else strip.y_max_m
    spans = sorted(
        (o.x_min_m, o.x_max_m) if along_x else (o.y_min_m, o.y_max_m) for o in openings if o.overlaps(strip)
    )
    pieces = []
    for low, high in [*spans, (end, end)]:
        if low > at + 1e-6:
            pieces.append(
                rect(at, strip.y_min_m, low, strip.y_max_m)
                if along_x
                else rect(strip.x_min_m, at, strip.x_max_m, low)
            )
        at = high
    return pieces


def door_in_line_x(a: str, b: str, line_m: float, low_m: float) -> tuple[str, str, Rect, bool]:
    """A door 0.9 m wide in the wall x = line_m."""
    return a, b, rect(line_m - HALF_M, low_m, line_m + HALF_M, low_m + 0.9), False


def door_in_line_y(a: str, b: str, line_m: float, low_m: float) -> tuple[str, str, Rect, bool]:
    return a, b, rect(low_m, line_m - HALF_M, low_m + 0.9, line_m + HALF_M), True


def window(room: str, area: Rect, side: Side, low_m: float, high_m: float) -> Window:
    """A thin pane on the inner face of a south or north wall."""
    y = area.y_min_m + HALF_M if side is Side.SOUTH else area.y_max_m - HALF_M
    pane = rect(low_m, y - 0.01, high_m, y + 0.01)
    return Window(room=room, side=side, pane=pane, z_min_m=0.9, z_max_m=2.1)


def room_shell(seed: int, kind: str) -> Shell:
    """A room of a size that fits its kind, one or two doors to its sides and windows in its other walls."""
    rng = np.random.default_rng(seed)
    smallest, largest, min_side_m = SIZES[kind]
    area_m2 = rng.uniform(smallest, largest)
    shorter = snapped(max(min_side_m, math.sqrt(area_m2 / rng.uniform(1.0, 1.6))))
    longer = snapped(area_m2 / shorter)
    width, depth = (shorter, longer) if rng.random() < 0.5 else (longer, shorter)
    area = rect(0.0, 0.0, width, depth)
    side_m = 1.8
    areas = [("tested", kind, area)]
    doors = []
    for name, x_min, line in (("east", width, width), ("west", -side_m, 0.0)):
        if name == "west" and rng.random() < 0.5:
            break
        areas.append((name, "storage room", rect(x_min, 0.0, snapped(x_min + side_m), depth)))
        low = snapped(rng.uniform(0.2, depth - 0.9 - 0.2))
        doors.append(door_in_line_x("tested", name, line, low))
    windows = []
    for side in (Side.SOUTH, Side.NORTH):
        if rng.random() < 0.6:
            span_m = min(1.2, width - 0.8)
            low = snapped(rng.uniform(0.3, width - 0.3 - span_m))
            windows.append(window("tested", area, side, low, low + span_m))
    return shell(areas, doors, windows)


def hard_shell() -> Shell:
    """Ten rooms along a hallway."""
    south = [
        ("living room", 5.0),
        ("kitchen", 3.0),
        ("bathroom", 2.0),
        ("laundry room", 2.0),
        ("storage room", 2.0),
    ]
    north = [("bedroom", 3.4), ("dining room", 3.4), ("office", 3.2), ("children's room", 4.0)]
    areas, doors, windows = [], [], []
    hall = (3.8, 5.3)
    for row, low, high, line in ((south, 0.0, hall[0], hall[0]), (north, hall[1], 9.1, hall[1])):
        x = 0.0
        for kind, width in row:
            area = rect(x, low, snapped(x + width), high)
            areas.append((kind, kind, area))
            doors.append(door_in_line_y(kind, "hallway", line, snapped(x + 0.4)))
            side = Side.SOUTH if low == 0.0 else Side.NORTH
            windows.append(window(kind, area, side, x + 0.5, x + width - 0.5))
            x = snapped(x + width)
    areas.append(("hallway", "hallway", rect(0.0, hall[0], 14.0, hall[1])))
    return shell(areas, doors, windows)


def furnished(seed: int, home: Shell) -> tuple[Furniture, ...]:
    return tuple(build_furniture(piece) for piece in furnish(np.random.default_rng(seed), home))


def samples() -> list[tuple[str, Shell, tuple[Furniture, ...]]]:
    """Three sizes and shapes of room per kind, several seeds each, and two large homes."""
    found = []
    for kind in SIZES:
        for seed in range(9):
            home = room_shell(seed % 3, kind)
            try:
                found.append((f"{kind}, seed {seed}", home, furnished(seed, home)))
            except BadSceneError:
                continue
    found += [(f"large home, seed {seed}", hard_shell(), furnished(seed, hard_shell())) for seed in range(2)]
    return found


@pytest.fixture(scope="module")
def homes() -> list[tuple[str, Shell, tuple[Furniture, ...]]]:
    return samples()
