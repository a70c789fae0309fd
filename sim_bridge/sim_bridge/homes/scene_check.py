"""Whether a home holds together: nothing overlaps or floats, and the robot gets everywhere."""

from collections.abc import Iterator

import scipy.ndimage

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.furniture.carpentry import GAP_M
from sim_bridge.homes.furniture.furnishing import PASSAGE_RADII_M
from sim_bridge.homes.home import Furniture, Home, Room, SmallObject
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles
from sim_bridge.homes.rect import Rect

# The smallest robot that a home must let through, with the distance that it keeps.
ROBOT_RADIUS_M = min(PASSAGE_RADII_M)
# From where a robot can stand to the furniture that it must look at.
REACH_M = 0.45
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
    for at, piece in enumerate(home.furniture):
        if piece.name in names:
            yield f"two pieces of furniture are called {piece.name!r}; give each a name of its own"
        names.add(piece.name)
        inside = insides.get(piece.room)
        if inside is None:
            yield f"the {piece.name} is said to be in {piece.room!r}, which is no room of it"
        elif not inside.contains(piece.footprint):
            yield (
                f"the {piece.name} reaches through a wall of the {piece.room}: it covers "
                f"{_span(piece.footprint)}, the floor is {_span(inside)}"
            )
        for door in home.doors:
            if piece.footprint.overlaps(door.opening):
                yield f"the {piece.name} stands in the door between {' and '.join(door.rooms)}"
        for other in home.furniture[:at]:
            if piece.footprint.overlaps(other.footprint):
                yield f"the {piece.name} and the {other.name} overlap"


def _object_problems(home: Home) -> Iterator[str]:
    pieces = {piece.name: piece for piece in home.furniture}
    rooms = {room.name: room for room in home.rooms}
    for at, thing in enumerate(home.objects):
        name = f"{thing.look.colour} {thing.label} (object {thing.instance})"
        if thing.instance != at:
            yield f"the {name} is number {at} in the list; instances count from 0"
        if thing.label not in home.labels:
            yield f"the {name} is of a class that the labels {', '.join(home.labels)} lack"
        piece = pieces.get(thing.furniture)
        if piece is None or not _stands_on(thing, piece):
            yield f"the {name} does not stand on the {thing.furniture}: all of it must be on one surface"
        elif piece.surfaces[thing.surface].hangs and not _at_wall(thing, rooms[piece.room]):
            yield f"the {name} hangs in the air: no wall is behind the {piece.name}"
        for other in home.objects[:at]:
            if _same_place(thing, other) and thing.footprint.overlaps(other.footprint):
                yield f"the {name} and the {other.look.colour} {other.label} overlap"


def _stands_on(thing: SmallObject, piece: Furniture) -> bool:
    if not piece.carries or not 0 <= thing.surface < len(piece.surfaces):
        return False
    surface = piece.surfaces[thing.surface]
    area = piece.in_map(surface.area).grown(TOLERANCE_M)
    return abs(surface.height_m - thing.z_m) < TOLERANCE_M and area.contains(thing.footprint)


def _at_wall(thing: SmallObject, room: Room) -> bool:
    """Whether the object is as near to a wall of its room as what hangs is."""
    return not room.inside.grown(-GAP_M / 2.0).contains(thing.footprint)


def _same_place(thing: SmallObject, other: SmallObject) -> bool:
    return (thing.furniture, thing.surface) == (other.furniture, other.surface)


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
