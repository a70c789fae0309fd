"""Whether a home holds together: nothing overlaps or floats, and the robot gets everywhere."""

import math
from collections.abc import Iterator

import scipy.ndimage

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.furniture.furnishing import PASSAGE_RADII_M
from sim_bridge.homes.home import Furniture, Home, SmallObject
from sim_bridge.homes.objects.arrangement import HEADROOM_M, headroom_m
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles
from sim_bridge.homes.rect import Rect

# The smallest robot that a home must let through, with the distance that it keeps.
ROBOT_RADIUS_M = min(PASSAGE_RADII_M)
# From where a robot can stand to the furniture that it must look at.
REACH_M = 0.45
# What hangs has the inside of a wall so far behind its back: it may hang a little before the wall's face.
BEHIND_M = 0.045
TOLERANCE_M = 1e-6


def check_home(home: Home) -> None:
    """Raise BadSceneError, with the first thing that is wrong in a sentence, unless the home is sound."""
    _raise_first(home, _problems(home))


def check_passages(home: Home) -> None:
    """Raise BadSceneError unless also robots that keep more distance get everywhere, as in drawn homes."""
    _raise_first(home, _passage_problems(home))


def _raise_first(home: Home, problems: Iterator[str]) -> None:
    problem = next(problems, None)
    if problem is not None:
        raise BadSceneError(f"home {home.name!r}: {problem}")


def _problems(home: Home) -> Iterator[str]:
    yield from _furniture_problems(home)
    yield from _object_problems(home)
    yield from _floor_problems(home)


def _furniture_problems(home: Home) -> Iterator[str]:
    insides = {room.name: room.inside for room in home.rooms}
    names: set[str] = set()
    standing: dict[str, list[tuple[Furniture, Rect]]] = {}
    for piece in home.furniture:
        if piece.name in names:
            yield f"two pieces of furniture are called {piece.name!r}; give each a name of its own"
        names.add(piece.name)
        footprint, inside = piece.footprint, insides.get(piece.room)
        if inside is None:
            yield f"the {piece.name} is said to be in {piece.room!r}, which is no room of it"
        elif not inside.contains(footprint):
            yield (
                f"the {piece.name} reaches through a wall of the {piece.room}: it covers "
                f"{_span(footprint)}, the floor is {_span(inside)}"
            )
        for door in home.doors:
            if footprint.overlaps(door.opening):
                yield f"the {piece.name} stands in the door between {' and '.join(door.rooms)}"
        # All of a piece is in its room: it can meet no piece of another.
        neighbours = standing.setdefault(piece.room, [])
        for other, taken in neighbours:
            if footprint.overlaps(taken):
                yield f"the {piece.name} and the {other.name} overlap"
        neighbours.append((piece, footprint))


def _object_problems(home: Home) -> Iterator[str]:
    pieces = {piece.name: piece for piece in home.furniture}
    standing: dict[tuple[str, int], list[tuple[SmallObject, Rect]]] = {}
    for at, thing in enumerate(home.objects):
        name = f"{thing.look.colour} {thing.label} (object {thing.instance})"
        if thing.instance != at:
            yield f"the {name} is number {at} in the list; instances count from 0"
        if thing.label not in home.labels:
            yield f"the {name} is of a class that the labels {', '.join(home.labels)} lack"
        piece, footprint = pieces.get(thing.furniture), thing.footprint
        if piece is None or not _stands_on(thing, piece):
            yield f"the {name} does not stand on the {thing.furniture}: all of it must be on one surface"
        elif piece.surfaces[thing.surface].hangs:
            if not _hangs_on_a_wall(thing, piece, home):
                yield f"the {name} hangs in the air: no wall, or a door or window, is behind the {piece.name}"
        elif thing.size_m[2] > headroom_m(piece, piece.surfaces[thing.surface]) + HEADROOM_M + TOLERANCE_M:
            yield f"the {name} is too tall for the board above it; choose another surface of the {piece.name}"
        neighbours = standing.setdefault((thing.furniture, thing.surface), [])
        for other, taken in neighbours:
            if footprint.overlaps(taken):
                yield f"the {name} and the {other.look.colour} {other.label} overlap"
        neighbours.append((thing, footprint))


def _stands_on(thing: SmallObject, piece: Furniture) -> bool:
    if not piece.carries or not 0 <= thing.surface < len(piece.surfaces):
        return False
    surface = piece.surfaces[thing.surface]
    area = piece.in_map(surface.area).grown(TOLERANCE_M)
    return abs(surface.height_m - thing.z_m) < TOLERANCE_M and area.contains(thing.footprint)


def _hangs_on_a_wall(thing: SmallObject, piece: Furniture, home: Home) -> bool:
    """Whether a wall is right behind all of the object, and neither a door nor a window."""
    area, top_m = thing.footprint, thing.z_m + thing.size_m[2]
    if any(
        window.z_min_m < top_m and thing.z_m < window.z_max_m and area.grown(BEHIND_M).overlaps(window.pane)
        for window in home.windows
    ):
        return False
    ahead_x, ahead_y = (round(way) for way in (math.cos(piece.yaw_rad), math.sin(piece.yaw_rad)))
    xs = {0: (area.x_min_m, area.x_max_m), 1: (area.x_min_m,), -1: (area.x_max_m,)}[ahead_x]
    ys = {0: (area.y_min_m, area.y_max_m), 1: (area.y_min_m,), -1: (area.y_max_m,)}[ahead_y]
    behind = [(x_m - BEHIND_M * ahead_x, y_m - BEHIND_M * ahead_y) for x_m in xs for y_m in ys]
    return any(
        wall.z_min_m <= thing.z_m and top_m <= wall.z_max_m and all(wall.base.holds(*end) for end in behind)
        for wall in home.walls
    )


def _floor_problems(home: Home) -> Iterator[str]:
    rects = home.obstacles()
    start_m = (home.start.x_m, home.start.y_m)
    if Obstacles(rects, home.bounds).clearance_m(*start_m) < ROBOT_RADIUS_M:
        yield f"the robot cannot start at ({start_m[0]:.2f}, {start_m[1]:.2f}): something is in the way"
        return
    grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(rects)
    parts, _ = scipy.ndimage.label(grid.cells_m >= ROBOT_RADIUS_M)
    reached = parts == parts[grid.cell_of(*start_m)]
    for room in home.rooms:
        if not reached[grid.cells_in(room.inside)].any():
            yield f"the robot gets from its start not into the {room.name}: the way is shut or too narrow"


def _passage_problems(home: Home) -> Iterator[str]:
    rects = home.obstacles()
    start_m = (home.start.x_m, home.start.y_m)
    if Obstacles(rects, home.bounds).clearance_m(*start_m) < max(PASSAGE_RADII_M):
        yield f"a large robot cannot start at ({start_m[0]:.2f}, {start_m[1]:.2f})"
    grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(rects)
    for radius_m in PASSAGE_RADII_M:
        regions = grid.regions(radius_m)
        if regions != 1:
            yield f"the floor falls into {regions} parts for a robot of {radius_m} m radius"
    for piece in home.furniture:
        near = grid.cells_m[grid.cells_in(piece.footprint.grown(REACH_M))]
        if piece.carries and not (near >= max(PASSAGE_RADII_M)).any():
            yield f"the robot cannot get near the {piece.name}"


def _span(rect: Rect) -> str:
    return f"x {rect.x_min_m:.2f}..{rect.x_max_m:.2f}, y {rect.y_min_m:.2f}..{rect.y_max_m:.2f} m"
