"""What is wrong with rooms, doors and windows that a person described: one sentence per mistake."""

import difflib
import math
from collections.abc import Sequence
from itertools import combinations

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import DOOR_HEIGHT_M, WALL_HEIGHT_M, WALL_THICKNESS_M
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.rooms.room_programmes import ROOM_KINDS
from sim_bridge.homes.rooms.wall_lines import Stretch, edge, outer_stretches, shared_stretch
from sim_bridge.homes.scene import SceneDoor, SceneRoom, SceneWindow

MIN_ROOM_SIDE_M, MAX_ROOM_SIDE_M = 1.0, 50.0
# The rectangle around all rooms: maps and ways have a cell for every 0.05 m of it.
MAX_HOME_M2 = 5000.0
MIN_DOOR_M = 0.6
# So far may a door's middle be written beside the wall line.
DOOR_OFF_LINE_M = 0.001
SLACK_M = 1e-6
HALF_WALL_M = WALL_THICKNESS_M / 2.0


def check_rooms(rooms: Sequence[SceneRoom]) -> None:
    """Raise BadSceneError for no rooms, one of an unknown kind or size, and two of one name or place."""
    if not rooms:
        raise BadSceneError("a home needs a room, and this one has none; describe at least one")
    for room in rooms:
        if room.kind not in ROOM_KINDS:
            near = difflib.get_close_matches(room.kind, ROOM_KINDS, n=1)
            hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(ROOM_KINDS)}"
            raise BadSceneError(
                f"room {room.name!r} is of the kind {room.kind!r:.80}, which no room is; {hint}"
            )
        for side_m in (room.area.width_m, room.area.depth_m):
            if not MIN_ROOM_SIDE_M - SLACK_M <= side_m <= MAX_ROOM_SIDE_M:
                raise BadSceneError(
                    f"room {room.name!r} is {room.area.width_m:.2f} m x {room.area.depth_m:.2f} m; "
                    f"its sides must be {MIN_ROOM_SIDE_M}..{MAX_ROOM_SIDE_M} m"
                )
    width_m = max(room.area.x_max_m for room in rooms) - min(room.area.x_min_m for room in rooms)
    depth_m = max(room.area.y_max_m for room in rooms) - min(room.area.y_min_m for room in rooms)
    if width_m * depth_m > MAX_HOME_M2 + SLACK_M:
        raise BadSceneError(
            f"the home is {width_m:.2f} m x {depth_m:.2f} m; make it smaller, {MAX_HOME_M2:g} m2 is the most"
        )
    for first, second in combinations(rooms, 2):
        if first.name == second.name:
            raise BadSceneError(f"two rooms are called {first.name!r}; give each a name of its own")
        if first.area.overlaps(second.area, SLACK_M):
            a, b = first.area, second.area
            along_x_m = min(a.x_max_m, b.x_max_m) - max(a.x_min_m, b.x_min_m)
            along_y_m = min(a.y_max_m, b.y_max_m) - max(a.y_min_m, b.y_min_m)
            raise BadSceneError(
                f"rooms {first.name!r} and {second.name!r} overlap by {along_x_m:.2f} m x {along_y_m:.2f} m; "
                "rooms side by side share an edge and no floor"
            )


def check_doors(rooms: Sequence[SceneRoom], doors: Sequence[SceneDoor]) -> None:
    """Raise BadSceneError where a door has no wall that it fits into, or two doors overlap."""
    areas = {room.name: room.area for room in rooms}
    spans: list[tuple[SceneDoor, Rect]] = []
    for door in doors:
        which = f"the door between {door.rooms[0]!r} and {door.rooms[1]!r}"
        for name in door.rooms:
            _check_named(which, name, areas)
        if not MIN_DOOR_M - SLACK_M <= door.width_m < math.inf:
            raise BadSceneError(f"{which} is {door.width_m:.2f} m wide; make it {MIN_DOOR_M} m or wider")
        stretch = shared_stretch(areas[door.rooms[0]], areas[door.rooms[1]])
        if door.rooms[0] == door.rooms[1] or stretch is None:
            raise BadSceneError(f"{which} has no wall: these rooms share no edge; let their areas touch")
        _check_in_wall(which, door, stretch)
        half_m = door.width_m / 2.0
        middle_m = door.x_m if stretch.along_x else door.y_m
        opening = stretch.strip(middle_m - half_m, middle_m + half_m, HALF_WALL_M)
        for other, taken in spans:
            if taken.overlaps(opening, SLACK_M):
                raise BadSceneError(
                    f"{which} at ({door.x_m:.2f}, {door.y_m:.2f}) overlaps that between {other.rooms[0]!r} "
                    f"and {other.rooms[1]!r} at ({other.x_m:.2f}, {other.y_m:.2f}); move one of them"
                )
        spans.append((door, opening))


def check_reach(rooms: Sequence[SceneRoom], doors: Sequence[SceneDoor]) -> None:
    """Raise BadSceneError where a room has no door, or cannot be reached from the first room."""
    if len(rooms) == 1:
        return
    for room in rooms:
        if not any(room.name in door.rooms for door in doors):
            raise BadSceneError(f"room {room.name!r} has no door; give it one to a room beside it")
    reached = {rooms[0].name}
    # Every round adds at least one room, or there are no more to add.
    for _ in rooms:
        reached |= {name for door in doors if reached & set(door.rooms) for name in door.rooms}
    cut_off = [repr(room.name) for room in rooms if room.name not in reached]
    if cut_off:
        raise BadSceneError(
            f"{', '.join(cut_off)} cannot be reached from {rooms[0].name!r} through doors; add a door"
        )


def check_windows(
    rooms: Sequence[SceneRoom], doors: Sequence[SceneDoor], windows: Sequence[SceneWindow]
) -> None:
    """Raise BadSceneError where a window has no outer wall that it fits into, or two windows overlap."""
    areas = {room.name: room.area for room in rooms}
    for number, window in enumerate(windows):
        which = f"the {window.side} window of {window.room!r} from {window.from_m:.2f} to {window.to_m:.2f} m"
        _check_named(which, window.room, areas)
        if not window.from_m < window.to_m:
            raise BadSceneError(f"{which} ends before it begins; write the lower number first")
        if not 0.0 <= window.sill_m < window.top_m <= WALL_HEIGHT_M:
            raise BadSceneError(
                f"{which} has its sill at {window.sill_m:.2f} m, its top at {window.top_m:.2f} m; the sill "
                f"must be lower than the top, and both within the wall's {WALL_HEIGHT_M} m"
            )
        area = areas[window.room]
        whole = edge(area, window.side)
        for door in doors:
            if window.room in door.rooms and _lies_under(door, whole, window):
                raise BadSceneError(
                    f"{which} lies over the door between {door.rooms[0]!r} and {door.rooms[1]!r}, which is "
                    f"{DOOR_HEIGHT_M} m high; move it to an outer wall"
                )
        if (
            not whole.low_m + HALF_WALL_M - SLACK_M
            <= window.from_m
            < window.to_m
            <= (whole.high_m - HALF_WALL_M + SLACK_M)
        ):
            raise BadSceneError(
                f"{which} leaves its wall, which reaches from {whole.low_m + HALF_WALL_M:.2f} to "
                f"{whole.high_m - HALF_WALL_M:.2f} m inside"
            )
        _check_outer(which, window, area, [other.area for other in rooms if other.name != window.room])
        for other in windows[:number]:
            if (other.room, other.side) == (window.room, window.side) and (
                max(other.from_m, window.from_m) < min(other.to_m, window.to_m) - SLACK_M
            ):
                raise BadSceneError(
                    f"{which} overlaps that from {other.from_m:.2f} to {other.to_m:.2f} m; move one of them"
                )


def _check_named(which: str, name: str, areas: dict[str, Rect]) -> None:
    if name not in areas:
        raise BadSceneError(f"{which} names a room {name!r} that is not there; there are {', '.join(areas)}")


def _check_in_wall(which: str, door: SceneDoor, stretch: Stretch) -> None:
    across_m, along_m = (door.y_m, door.x_m) if stretch.along_x else (door.x_m, door.y_m)
    line, way = ("y", "x") if stretch.along_x else ("x", "y")
    if not abs(across_m - stretch.line_m) <= DOOR_OFF_LINE_M:
        raise BadSceneError(
            f"{which} has its middle at {line} = {across_m:.2f} m, and the wall between these rooms is at "
            f"{line} = {stretch.line_m:.2f} m; move it there"
        )
    low_m, high_m = stretch.low_m + HALF_WALL_M, stretch.high_m - HALF_WALL_M
    from_m, to_m = along_m - door.width_m / 2.0, along_m + door.width_m / 2.0
    if not (low_m - SLACK_M <= from_m and to_m <= high_m + SLACK_M):
        raise BadSceneError(
            f"{which} opens from {way} = {from_m:.2f} to {to_m:.2f} m, and the wall that they share has room "
            f"from {low_m:.2f} to {high_m:.2f} m; move it or make it narrower"
        )


def _lies_under(door: SceneDoor, wall: Stretch, window: SceneWindow) -> bool:
    across_m, along_m = (door.y_m, door.x_m) if wall.along_x else (door.x_m, door.y_m)
    half_m = door.width_m / 2.0
    return (
        abs(across_m - wall.line_m) <= DOOR_OFF_LINE_M
        and window.from_m < along_m + half_m
        and along_m - half_m < window.to_m
    )


def _check_outer(which: str, window: SceneWindow, area: Rect, others: Sequence[Rect]) -> None:
    free = outer_stretches(area, Side(window.side), others)
    if not any(
        stretch.low_m - SLACK_M <= window.from_m and window.to_m <= stretch.high_m + SLACK_M
        for stretch in free
    ):
        where = ", ".join(f"{stretch.low_m:.2f}..{stretch.high_m:.2f} m" for stretch in free)
        raise BadSceneError(
            f"{which} is in an inner wall; on that side the room has "
            + (f"outer walls along {where}" if free else "no outer wall")
        )
