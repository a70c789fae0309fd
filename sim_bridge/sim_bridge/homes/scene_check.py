"""Whether a home holds together: nothing overlaps or floats, and the robot gets everywhere."""

from collections.abc import Iterator

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.floor_plan import RESOLUTION_M
from sim_bridge.homes.furnishing import PASSAGE_RADII_M
from sim_bridge.homes.home import Furniture, Home, Rect, SmallObject
from sim_bridge.robot.obstacles import ClearanceGrid, Obstacles

MIN_ROOMS = 3
MIN_DOOR_M = 0.90
# From where a robot can stand to the furniture that it must look at.
REACH_M = 0.45
TOLERANCE_M = 1e-6


def check_home(home: Home) -> None:
    """Raise BadSceneError, with the first thing that is wrong in a sentence, unless the home is sound."""
    problem = next(_problems(home), None)
    if problem is not None:
        raise BadSceneError(f"home {home.name!r}: {problem}")


def _problems(home: Home) -> Iterator[str]:
    if len(home.rooms) < MIN_ROOMS:
        yield f"it has {len(home.rooms)} rooms; it needs {MIN_ROOMS}"
    for door in home.doors:
        if door.width_m < MIN_DOOR_M - TOLERANCE_M:
            yield f"the door between {door.rooms} is {door.width_m:.2f} m wide; it must be {MIN_DOOR_M} m"
    yield from _furniture_problems(home)
    yield from _object_problems(home)
    yield from _floor_problems(home)


def _furniture_problems(home: Home) -> Iterator[str]:
    insides = {room.name: room.inside for room in home.rooms}
    for at, piece in enumerate(home.furniture):
        inside = insides.get(piece.room)
        if inside is None or not inside.contains(piece.footprint):
            yield f"the {piece.name} does not stand in the {piece.room}"
        for other in home.furniture[:at]:
            if piece.footprint.overlaps(other.footprint):
                yield f"the {piece.name} and the {other.name} overlap"


def _object_problems(home: Home) -> Iterator[str]:
    pieces = {piece.name: piece for piece in home.furniture}
    for at, thing in enumerate(home.objects):
        name = f"{thing.colour_name} {thing.label} (object {thing.instance})"
        if thing.instance != at:
            yield f"the {name} is number {at} in the list; instances count from 0"
        if thing.label not in home.labels:
            yield f"the {name} is of a class that labels {home.labels} lack"
        piece = pieces.get(thing.furniture)
        if piece is None or not _stands_on(thing, piece):
            yield f"the {name} does not stand on the {thing.furniture}"
        for other in home.objects[:at]:
            if thing.furniture == other.furniture and thing.footprint.overlaps(other.footprint):
                yield f"the {name} and object {other.instance} overlap"


def _stands_on(thing: SmallObject, piece: Furniture) -> bool:
    return piece.carries and any(
        abs(surface.height_m - thing.z_m) < TOLERANCE_M
        and piece.in_map(surface.area).grown(TOLERANCE_M).contains(thing.footprint)
        for surface in piece.surfaces
    )


def _floor_problems(home: Home) -> Iterator[str]:
    rects = home.obstacles()
    start_m = (home.start.x_m, home.start.y_m)
    if Obstacles(rects, home.bounds).clearance_m(*start_m) < max(PASSAGE_RADII_M):
        yield f"the robot cannot start at ({start_m[0]:.2f}, {start_m[1]:.2f}): something is in the way"
    grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(rects)
    for radius_m in PASSAGE_RADII_M:
        regions = grid.regions(radius_m)
        if regions != 1:
            yield f"the floor falls into {regions} parts for a robot of {radius_m} m radius"
    for piece in home.furniture:
        if piece.carries and not _can_be_approached(grid, piece.footprint):
            yield f"the robot cannot get near the {piece.name}"


def _can_be_approached(grid: ClearanceGrid, footprint: Rect) -> bool:
    near = footprint.grown(REACH_M)
    rows = (grid.y_m >= near.y_min_m) & (grid.y_m <= near.y_max_m)
    columns = (grid.x_m >= near.x_min_m) & (grid.x_m <= near.x_max_m)
    return bool((grid.cells_m[rows][:, columns] >= max(PASSAGE_RADII_M)).any())
