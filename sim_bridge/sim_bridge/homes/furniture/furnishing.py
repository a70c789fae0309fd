"""A shell of rooms is furnished: every room gets what it is for, and the robot can still go everywhere."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.furniture.carpentry import Design
from sim_bridge.homes.furniture.catalogue import KINDS, design, draw_style
from sim_bridge.homes.furniture.free_floor import PASSAGE_RADII_M, FreeFloor, Shell, Standing, standing
from sim_bridge.homes.furniture.placement import (
    OPPOSITE_M,
    TABLE_GAP_M,
    Spot,
    along_row,
    around,
    at_walls,
    beside,
    corners_first,
    in_front,
    in_middle,
    opposite,
)
from sim_bridge.homes.furniture.wishes import (
    CERTAIN,
    DINING_TABLE,
    MIN_PIECES,
    MIN_PIECES_OF,
    Companion,
    How,
    Where,
    Wish,
    wishes_of,
)
from sim_bridge.homes.home import Room
from sim_bridge.homes.scene import SceneFurniture, Style

# Whether the robot still gets everywhere is asked of so many places that fit, for one piece.
WAY_CHECKS = 12
MIDDLE_TRIES = 40
# A room whose furniture stands in its own way is begun again so often.
ROOM_DRAWS = 10

__all__ = ["PASSAGE_RADII_M", "furnish"]


def furnish(rng: np.random.Generator, shell: Shell) -> tuple[SceneFurniture, ...]:
    """Furnish every room, named "KIND NUMBER" over the whole home.

    Raises BadSceneError where a room is too small for what it is for, or the bare floor is not in one piece
    for a robot of each of PASSAGE_RADII_M; draw again then.
    """
    floor = FreeFloor(shell)
    if not floor.is_one_piece():
        raise BadSceneError(
            f"the floor of {len(shell.rooms)} rooms is not in one piece for robots of {PASSAGE_RADII_M!r} m "
            "radius before any furniture is in; every room needs a door that is wide enough"
        )
    kinds = [room.kind for room in shell.rooms]
    for room in shell.rooms:
        _furnish_room(rng, floor, room, wishes_of(room.kind, kinds))
    if not any(piece.kind == "dining table" for piece in floor.pieces):
        for room in shell.rooms:
            if room.kind == "living room" and _grant(rng, floor, room, DINING_TABLE):
                break
    return _named(floor.pieces)


def _named(pieces: Iterable[Standing]) -> tuple[SceneFurniture, ...]:
    count: dict[str, int] = {}
    found = []
    for piece in pieces:
        count[piece.kind] = count.get(piece.kind, 0) + 1
        found.append(
            SceneFurniture(
                name=f"{piece.kind} {count[piece.kind]}",
                kind=piece.kind,
                room=piece.room,
                x_m=piece.spot.x_m,
                y_m=piece.spot.y_m,
                quarter_turns=piece.spot.quarter_turns,
                style=piece.style,
            )
        )
    return tuple(found)


def _furnish_room(rng: np.random.Generator, floor: FreeFloor, room: Room, wishes: tuple[Wish, ...]) -> None:
    before = floor.snapshot()
    for _ in range(ROOM_DRAWS):
        problem = _try_room(rng, floor, room, wishes)
        if problem is None:
            return
        floor.restore(before)
    raise BadSceneError(f"{problem} in {ROOM_DRAWS} draws; the room needs more floor, or fewer doors")


def _try_room(rng: np.random.Generator, floor: FreeFloor, room: Room, wishes: tuple[Wish, ...]) -> str | None:
    """Grant the wishes that come true; what went wrong, or None."""
    left = []
    for wish in wishes:
        if rng.random() >= wish.p:
            left.append(wish)
        elif not _grant(rng, floor, room, wish) and wish.p >= CERTAIN:
            return f"the {wish.kinds[0]} finds no place in the {room.name} ({room.inside.area_m2:.1f} m2)"
    # A room that chance, or a lack of places, has left too bare gets what it did not ask for.
    for wish in left:
        if not _is_bare(floor, room):
            break
        _grant(rng, floor, room, wish)
    if _is_bare(floor, room):
        return f"the {room.name} ({room.inside.area_m2:.1f} m2) has too few places for furniture"
    return None


def _is_bare(floor: FreeFloor, room: Room) -> bool:
    pieces = floor.in_room(room)
    few = len(pieces) < MIN_PIECES_OF.get(room.kind, MIN_PIECES)
    return few or not any(piece.carries for piece in pieces)


def _grant(rng: np.random.Generator, floor: FreeFloor, room: Room, wish: Wish) -> bool:
    """Place the wish's pieces and their companions; False where one of the pieces finds no place."""
    first = len(floor.pieces)
    if wish.how is How.ROW:
        granted = _place_row(rng, floor, room, wish.kinds)
    elif wish.how is How.FACING:
        granted = _place_facing(rng, floor, room, wish.kinds)
    else:
        granted = _place_alone(rng, floor, room, wish.kinds[0], wish.how)
    if granted:
        host = floor.pieces[first]
        for companion in wish.companions:
            _add_companions(rng, floor, room, companion, host)
    return granted


def _place_alone(
    rng: np.random.Generator, floor: FreeFloor, room: Room, kind: str, how: How = How.WALL
) -> bool:
    """At a wall, or in a corner or the middle where wanted and possible; narrow where it must be."""
    style = draw_style(rng, kind)
    for width_m in sorted({style.width_m, min(KINDS[kind].widths_m)}, reverse=True):
        fitted = replace(style, width_m=width_m)
        shape = design(kind, fitted)
        spots = at_walls(rng, room.inside, shape.depth_m, shape.width_m)
        if how is How.CORNER:
            spots = corners_first(spots, room.inside, shape.width_m)
        elif how is How.MIDDLE:
            spots = in_middle(rng, room.inside, shape.depth_m, shape.width_m, MIDDLE_TRIES) + spots
        if _put_first(floor, room, ([standing(kind, fitted, shape, room.name, spot)] for spot in spots)):
            return True
    return False


def _put_first(
    floor: FreeFloor, room: Room, groups: Iterable[list[Standing]], host: Standing | None = None
) -> bool:
    """Put the first group of pieces that fits and leaves the robot its ways."""
    checks = 0
    for group in groups:
        if checks == WAY_CHECKS:
            return False
        if all(floor.fits(room, piece, host) for piece in group):
            checks += 1
            if floor.put(room, group):
                return True
    return False


def _place_row(rng: np.random.Generator, floor: FreeFloor, room: Room, kinds: tuple[str, ...]) -> bool:
    """Side by side along one wall; where no wall is long enough, the last stands elsewhere, and so on."""
    styles = _matching_styles(rng, kinds)
    narrow = [
        replace(style, width_m=min(KINDS[kind].widths_m)) for kind, style in zip(kinds, styles, strict=True)
    ]
    for choice in (styles, narrow):
        members = list(zip(kinds, choice, strict=True))
        # Only the last may be tall, and then it ends the row at either side.
        if rng.random() < 0.5:
            members.reverse()
        if _put_first(floor, room, _rows(rng, room, members)):
            return True
    if len(kinds) == 1:
        return False
    return _place_row(rng, floor, room, kinds[:-1]) and _place_row(rng, floor, room, kinds[-1:])


def _rows(rng: np.random.Generator, room: Room, members: list[tuple[str, Style]]) -> Iterable[list[Standing]]:
    shapes = [design(kind, style) for kind, style in members]
    depths, widths = [shape.depth_m for shape in shapes], [shape.width_m for shape in shapes]
    for row in at_walls(rng, room.inside, max(depths), sum(widths)):
        yield [
            standing(kind, style, shape, room.name, spot)
            for (kind, style), shape, spot in zip(
                members, shapes, along_row(row, depths, widths), strict=True
            )
        ]


def _matching_styles(rng: np.random.Generator, kinds: tuple[str, ...]) -> list[Style]:
    """Styles of pieces that were bought together: the same materials wherever a kind comes in them."""
    styles: list[Style] = []
    for kind in kinds:
        entry, style = KINDS[kind], draw_style(rng, kind)
        main = next((other.main for other in styles if other.main in entry.mains), style.main)
        accent = next((other.accent for other in styles if other.accent in entry.accents), style.accent)
        styles.append(replace(style, main=main, accent=accent))
    return styles


def _place_facing(rng: np.random.Generator, floor: FreeFloor, room: Room, kinds: tuple[str, ...]) -> bool:
    """The second opposite the first, the third before the first; each alone where the room is too small."""
    styles = [draw_style(rng, kind) for kind in kinds]
    shapes = [design(kind, style) for kind, style in zip(kinds, styles, strict=True)]
    groups = list(_facing(rng, room, kinds, styles, shapes))
    if _put_first(floor, room, groups) or _put_first(floor, room, (group[:2] for group in groups)):
        return True
    if not all(_place_alone(rng, floor, room, kind) for kind in kinds[:2]):
        return False
    _place_alone(rng, floor, room, kinds[2], How.MIDDLE)
    return True


def _facing(
    rng: np.random.Generator, room: Room, kinds: tuple[str, ...], styles: list[Style], shapes: list[Design]
) -> Iterable[list[Standing]]:
    host, across, between = shapes
    for spot in at_walls(rng, room.inside, host.depth_m, host.width_m):
        ahead, floor_m = opposite(room.inside, spot, host.depth_m, across)
        if floor_m < TABLE_GAP_M + between.depth_m + OPPOSITE_M:
            continue
        spots = (spot, ahead, in_front(spot, host.depth_m, between, TABLE_GAP_M))
        yield [
            standing(kind, style, shape, room.name, place)
            for kind, style, shape, place in zip(kinds, styles, shapes, spots, strict=True)
        ]


def _add_companions(
    rng: np.random.Generator, floor: FreeFloor, room: Room, companion: Companion, host: Standing
) -> None:
    kind, style = companion.kind, draw_style(rng, companion.kind)
    shape = design(kind, style)
    for chance in companion.chances:
        if rng.random() >= chance:
            continue
        spots = _companion_spots(companion.where, host, shape)
        order = rng.permutation(len(spots))
        groups = ([standing(kind, style, shape, room.name, spots[at])] for at in order)
        _put_first(floor, room, groups, host)


def _companion_spots(where: Where, host: Standing, guest: Design) -> list[Spot]:
    if where is Where.AROUND:
        return around(host.spot, host.shape, guest)
    if where is Where.SIDE:
        return beside(host.spot, host.shape, guest)
    return [in_front(host.spot, host.shape.depth_m, guest)]
