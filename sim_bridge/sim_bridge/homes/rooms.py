"""How a home is cut into rooms, with doors between them and walls around them.

The ground plan is a rectangle that is cut again and again, as most flats look. Wall lines lie on a grid of
0.05 m, the resolution of the floor plan, so that the map shows walls exactly where they are.
"""

from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import DOOR_HEIGHT_M, WALL_HEIGHT_M, WALL_THICKNESS_M, Door, Rect, Room, Side, Wall
from sim_bridge.homes.shapes import Colour

GRID_M = 0.05
AREA_PER_ROOM_M2 = (13.0, 16.0)
ASPECT = (1.15, 1.6)
CUT_SHARE = (0.38, 0.62)
# Between wall lines; narrower than this, furniture leaves the robot no way.
MIN_SIDE_M = 2.8
DOOR_WIDTHS_M = (0.90, 0.95, 1.00)
DOOR_FROM_CORNER_M = 0.35
P_EXTRA_DOOR = 0.25
HALF_WALL_M = WALL_THICKNESS_M / 2.0
SHELL_COLOUR: Colour = (0.75, 0.74, 0.72)
COLOUR_SPREAD = 0.03
_OPPOSITE = {Side.SOUTH: Side.NORTH, Side.NORTH: Side.SOUTH, Side.WEST: Side.EAST, Side.EAST: Side.WEST}

# Largest room first. The names are what a person would say.
ROOM_PLANS: dict[int, tuple[tuple[str, str], ...]] = {
    3: (("living room", "living room"), ("bedroom", "bedroom"), ("kitchen", "kitchen")),
    4: (
        ("living room", "living room"),
        ("bedroom", "bedroom"),
        ("kitchen", "kitchen"),
        ("bathroom", "bathroom"),
    ),
    5: (
        ("living room", "living room"),
        ("bedroom", "bedroom"),
        ("kitchen", "kitchen"),
        ("study", "study"),
        ("bathroom", "bathroom"),
    ),
    6: (
        ("living room", "living room"),
        ("bedroom", "bedroom"),
        ("kitchen", "kitchen"),
        ("guest room", "bedroom"),
        ("study", "study"),
        ("bathroom", "bathroom"),
    ),
}
FLOOR_COLOURS: dict[str, Colour] = {
    "living room": (0.66, 0.47, 0.29),
    "bedroom": (0.45, 0.50, 0.62),
    "kitchen": (0.80, 0.78, 0.72),
    "bathroom": (0.56, 0.74, 0.78),
    "study": (0.47, 0.55, 0.42),
}
WALL_COLOURS: dict[str, Colour] = {
    "living room": (0.93, 0.87, 0.74),
    "bedroom": (0.76, 0.83, 0.92),
    "kitchen": (0.95, 0.93, 0.66),
    "bathroom": (0.80, 0.93, 0.93),
    "study": (0.80, 0.89, 0.76),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """Rooms, doors and walls; `bounds` reaches to the outer faces of the outer walls."""

    bounds: Rect
    rooms: tuple[Room, ...]
    doors: tuple[Door, ...]
    walls: tuple[Wall, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _SharedWall:
    """A straight stretch of wall line between two rooms: along x at y = line, or along y at x = line."""

    first: int
    second: int
    along_x: bool
    line_m: float
    low_m: float
    high_m: float


def snapped(length_m: float) -> float:
    """The nearest multiple of the grid, rounded so that equal lines compare equal."""
    return round(round(length_m / GRID_M) * GRID_M, 6)


def lay_out(rng: np.random.Generator, room_count: int) -> Layout:
    """Cut a ground plan into `room_count` rooms that doors connect.

    Raises BadSceneError where the draw cannot be cut into rooms that are wide enough; draw again then.
    """
    if room_count not in ROOM_PLANS:
        raise BadSceneError(f"a home has {min(ROOM_PLANS)}..{max(ROOM_PLANS)} rooms, not {room_count!r}")
    ground = _ground_plan(rng, room_count)
    cells = _cut(rng, ground, room_count)
    cells.sort(key=lambda cell: (-cell.area_m2, cell.x_min_m, cell.y_min_m))
    rooms = tuple(
        Room(
            name=name,
            kind=kind,
            inside=cell.grown(-HALF_WALL_M),
            floor_colour=_varied(rng, FLOOR_COLOURS[kind]),
            wall_colour=_varied(rng, WALL_COLOURS[kind]),
        )
        for (name, kind), cell in zip(ROOM_PLANS[room_count], cells, strict=True)
    )
    doors = _doors(rng, rooms, cells)
    bounds = ground.grown(HALF_WALL_M)
    walls = (*_shell(bounds), *(wall for room in rooms for wall in _room_walls(room, doors)))
    return Layout(bounds=bounds, rooms=rooms, doors=doors, walls=walls)


def _ground_plan(rng: np.random.Generator, room_count: int) -> Rect:
    area_m2 = room_count * rng.uniform(*AREA_PER_ROOM_M2)
    aspect = rng.uniform(*ASPECT)
    width_m = snapped((area_m2 * aspect) ** 0.5)
    return Rect(x_min_m=0.0, y_min_m=0.0, x_max_m=width_m, y_max_m=snapped(area_m2 / width_m))


def _cut(rng: np.random.Generator, ground: Rect, count: int) -> list[Rect]:
    """Cut the largest cell across its longer side until there are `count`."""
    cells = [ground]
    while len(cells) < count:
        cell = cells.pop(int(np.argmax([cell.area_m2 for cell in cells])))
        along_x = cell.width_m >= cell.depth_m
        length_m = max(cell.width_m, cell.depth_m)
        if length_m < 2.0 * MIN_SIDE_M:
            raise BadSceneError(f"a cell {length_m:.2f} m long cannot be cut into rooms {MIN_SIDE_M} m wide")
        cut_m = np.clip(rng.uniform(*CUT_SHARE) * length_m, MIN_SIDE_M, length_m - MIN_SIDE_M)
        x, y, X, Y = cell.x_min_m, cell.y_min_m, cell.x_max_m, cell.y_max_m
        if along_x:
            line_m = snapped(x + cut_m)
            cells.append(Rect(x_min_m=x, y_min_m=y, x_max_m=line_m, y_max_m=Y))
            cells.append(Rect(x_min_m=line_m, y_min_m=y, x_max_m=X, y_max_m=Y))
        else:
            line_m = snapped(y + cut_m)
            cells.append(Rect(x_min_m=x, y_min_m=y, x_max_m=X, y_max_m=line_m))
            cells.append(Rect(x_min_m=x, y_min_m=line_m, x_max_m=X, y_max_m=Y))
    return cells


def _doors(rng: np.random.Generator, rooms: tuple[Room, ...], cells: list[Rect]) -> tuple[Door, ...]:
    """A door through enough shared walls to reach every room, and now and then one more."""
    shared = [wall for wall in _shared_walls(cells) if wall.high_m - wall.low_m >= _door_needs_m()]
    # The living room is the first: walls towards it are tried first, as a hall would be.
    order = sorted(range(len(shared)), key=lambda at: (shared[at].first != 0, rng.random()))
    group = list(range(len(rooms)))
    doors = []
    for wall in (shared[at] for at in order):
        joins = group[wall.first] != group[wall.second]
        if not joins and rng.random() >= P_EXTRA_DOOR:
            continue
        doors.append(_door(rng, rooms, wall))
        old, new = group[wall.second], group[wall.first]
        group = [new if member == old else member for member in group]
    if len(set(group)) > 1:
        raise BadSceneError("some rooms share no wall that is long enough for a door")
    return tuple(doors)


def _door_needs_m() -> float:
    return max(DOOR_WIDTHS_M) + 2.0 * (DOOR_FROM_CORNER_M + HALF_WALL_M)


def _shared_walls(cells: list[Rect]) -> list[_SharedWall]:
    found = []
    for first, a in enumerate(cells):
        for second in range(first + 1, len(cells)):
            b = cells[second]
            for line_m, touches in (
                (a.x_max_m, a.x_max_m == b.x_min_m),
                (a.x_min_m, a.x_min_m == b.x_max_m),
            ):
                low_m, high_m = max(a.y_min_m, b.y_min_m), min(a.y_max_m, b.y_max_m)
                if touches and low_m < high_m:
                    found.append(_shared(first, second, False, line_m, low_m, high_m))
            for line_m, touches in (
                (a.y_max_m, a.y_max_m == b.y_min_m),
                (a.y_min_m, a.y_min_m == b.y_max_m),
            ):
                low_m, high_m = max(a.x_min_m, b.x_min_m), min(a.x_max_m, b.x_max_m)
                if touches and low_m < high_m:
                    found.append(_shared(first, second, True, line_m, low_m, high_m))
    return found


def _shared(
    first: int, second: int, along_x: bool, line_m: float, low_m: float, high_m: float
) -> _SharedWall:
    return _SharedWall(first=first, second=second, along_x=along_x, line_m=line_m, low_m=low_m, high_m=high_m)


def _door(rng: np.random.Generator, rooms: tuple[Room, ...], wall: _SharedWall) -> Door:
    width_m = float(rng.choice(DOOR_WIDTHS_M))
    margin_m = DOOR_FROM_CORNER_M + HALF_WALL_M
    spare_m = max(0.0, wall.high_m - wall.low_m - 2.0 * margin_m - width_m)
    start_m = snapped(wall.low_m + margin_m + rng.random() * spare_m)
    end_m = snapped(start_m + width_m)
    low_m, high_m = wall.line_m - HALF_WALL_M, wall.line_m + HALF_WALL_M
    if wall.along_x:
        opening = Rect(x_min_m=start_m, y_min_m=low_m, x_max_m=end_m, y_max_m=high_m)
    else:
        opening = Rect(x_min_m=low_m, y_min_m=start_m, x_max_m=high_m, y_max_m=end_m)
    return Door(
        rooms=(rooms[wall.first].name, rooms[wall.second].name), opening=opening, along_x=wall.along_x
    )


def _shell(bounds: Rect) -> tuple[Wall, ...]:
    """The outer half of the outer walls, which belongs to no room."""
    inner = bounds.grown(-HALF_WALL_M)
    return tuple(
        Wall(base=base, z_min_m=0.0, z_max_m=WALL_HEIGHT_M, colour=SHELL_COLOUR, hidden=_OPPOSITE[side])
        for side, base in _ring(bounds, inner).items()
    )


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


def _room_walls(room: Room, doors: tuple[Door, ...]) -> list[Wall]:
    """The half of each wall that faces the room, in the room's colour, with lintels over its doors.

    Each room owns its half because a box has one colour, and the two sides of a wall differ.
    """
    outer = room.inside.grown(HALF_WALL_M)
    walls = []
    for side, strip in _ring(outer, room.inside).items():
        along_x = side in (Side.SOUTH, Side.NORTH)
        openings = [
            door.opening for door in doors if door.along_x == along_x and door.opening.overlaps(strip)
        ]
        for base, over_door in _cut_strip(strip, openings, along_x):
            walls.append(
                Wall(
                    base=base,
                    z_min_m=DOOR_HEIGHT_M if over_door else 0.0,
                    z_max_m=WALL_HEIGHT_M,
                    colour=room.wall_colour,
                    hidden=side,
                )
            )
    return walls


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
        if end_m - start_m < GRID_M / 2.0:
            continue
        if along_x:
            piece = Rect(x_min_m=start_m, y_min_m=strip.y_min_m, x_max_m=end_m, y_max_m=strip.y_max_m)
        else:
            piece = Rect(x_min_m=strip.x_min_m, y_min_m=start_m, x_max_m=strip.x_max_m, y_max_m=end_m)
        cut.append((piece, over_door))
    return cut


def _varied(rng: np.random.Generator, colour: Colour) -> Colour:
    shift = rng.uniform(-COLOUR_SPREAD, COLOUR_SPREAD)
    red, green, blue = (float(np.clip(channel + shift, 0.0, 1.0)) for channel in colour)
    return red, green, blue
