"""Which furniture a room wants, and where it finds its place without closing the robot's way."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.carpentry import Design
from sim_bridge.homes.furniture import BUILDERS
from sim_bridge.homes.home import Door, Furniture, Rect, Room
from sim_bridge.homes.rooms import Layout, snapped
from sim_bridge.robot.obstacles import ClearanceGrid

# Between furniture and anything else.
GAP_M = 0.10
DOOR_ZONE_M = 0.80
DOOR_ZONE_SIDE_M = 0.10
FREE_STANDING_M = 0.55
TRIES = 40
CERTAIN = 1.0
# The floor must be in one piece for robots of all these radii: ours with the distance that it keeps, and
# planners that keep more.
PASSAGE_RADII_M = (0.16, 0.18, 0.21, 0.25, 0.30)


@dataclass(frozen=True, slots=True, kw_only=True)
class Companion:
    """A piece that comes with another: `around` it, in `front` of it, or at its `side`."""

    kind: str
    where: str
    chances: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Wish:
    """A piece of furniture that a room has with probability `p`; certain ones must find a place."""

    kind: str
    p: float
    free_standing: bool = False
    companions: tuple[Companion, ...] = ()


CHAIR_AT_DESK = Companion(kind="chair", where="front", chances=(0.9,))
CHAIRS = Companion(kind="chair", where="around", chances=(1.0, 0.9, 0.6, 0.3))
NIGHTSTANDS = Companion(kind="nightstand", where="side", chances=(1.0, 0.5))
WISHES: dict[str, tuple[Wish, ...]] = {
    "kitchen": (
        Wish(kind="kitchen counter", p=CERTAIN),
        Wish(kind="fridge", p=CERTAIN),
        Wish(kind="dining table", p=0.95, free_standing=True, companions=(CHAIRS,)),
        Wish(kind="cupboard", p=0.6),
    ),
    "living room": (
        Wish(kind="sofa", p=CERTAIN),
        Wish(kind="tv stand", p=CERTAIN),
        Wish(kind="coffee table", p=0.9, free_standing=True),
        Wish(kind="bookcase", p=0.8),
        Wish(kind="armchair", p=0.6),
        Wish(kind="sideboard", p=0.7),
    ),
    "bedroom": (
        Wish(kind="bed", p=CERTAIN, companions=(NIGHTSTANDS,)),
        Wish(kind="wardrobe", p=CERTAIN),
        Wish(kind="dresser", p=0.7),
        Wish(kind="desk", p=0.3, companions=(CHAIR_AT_DESK,)),
    ),
    "bathroom": (
        Wish(kind="washstand", p=CERTAIN),
        Wish(kind="washing machine", p=0.8),
        Wish(kind="bathroom cabinet", p=0.7),
    ),
    "study": (
        Wish(kind="desk", p=CERTAIN, companions=(CHAIR_AT_DESK,)),
        Wish(kind="bookcase", p=0.9),
        Wish(kind="sideboard", p=0.7),
        Wish(kind="armchair", p=0.5),
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    """Where a design would stand: its middle, and which way its front looks."""

    x_m: float
    y_m: float
    quarter_turns: int


@dataclass(slots=True)
class _State:
    """What stands already; grows while a home is furnished."""

    grid: ClearanceGrid
    doors: tuple[Door, ...]
    placed: list[Furniture] = field(default_factory=list)
    # The floor that must stay free before a piece, by the piece's name.
    fronts: dict[str, Rect] = field(default_factory=dict)
    count: dict[str, int] = field(default_factory=dict)


def furnish(rng: np.random.Generator, layout: Layout, resolution_m: float) -> tuple[Furniture, ...]:
    """Furnish every room. Raises BadSceneError where a certain piece finds no place; draw again then."""
    low_walls = [wall.base for wall in layout.walls if wall.z_min_m == 0.0]
    grid = ClearanceGrid(layout.bounds, resolution_m).with_rects(low_walls)
    state = _State(grid, layout.doors)
    for room in layout.rooms:
        for wish in WISHES[room.kind]:
            if wish.p < CERTAIN and rng.random() >= wish.p:
                continue
            design = BUILDERS[wish.kind](rng)
            places = _free_standing(rng, room, design) if wish.free_standing else _at_wall(rng, room, design)
            piece = _try(state, room, design, places)
            if piece is None and wish.p >= CERTAIN:
                raise BadSceneError(f"the {wish.kind} finds no place in the {room.name}")
            if piece is not None:
                _add_companions(rng, state, room, wish, piece)
    return tuple(state.placed)


def _add_companions(rng: np.random.Generator, state: _State, room: Room, wish: Wish, host: Furniture) -> None:
    for companion in wish.companions:
        design = BUILDERS[companion.kind](rng)
        places = _PLACES[companion.where](design, host)
        for chance in companion.chances:
            if rng.random() < chance:
                order = rng.permutation(len(places))
                _try(state, room, design, iter([places[at] for at in order]), host)


def _at_wall(rng: np.random.Generator, room: Room, design: Design) -> Iterator[_Place]:
    """Places with the back to a wall."""
    inside = room.inside
    for _ in range(TRIES):
        turns = int(rng.integers(4))
        along_m = inside.depth_m if turns % 2 == 0 else inside.width_m
        spare_m = along_m - design.width_m - 2.0 * GAP_M
        if spare_m < 0.0:
            continue
        along = GAP_M + snapped(rng.uniform(0.0, spare_m)) + design.width_m / 2.0
        back = GAP_M + design.depth_m / 2.0
        x_m, y_m = (
            (inside.x_min_m + back, inside.y_min_m + along),
            (inside.x_min_m + along, inside.y_min_m + back),
            (inside.x_max_m - back, inside.y_min_m + along),
            (inside.x_min_m + along, inside.y_max_m - back),
        )[turns]
        yield _Place(x_m=x_m, y_m=y_m, quarter_turns=turns)


def _free_standing(rng: np.random.Generator, room: Room, design: Design) -> Iterator[_Place]:
    """Places in the middle of the room, with a way around."""
    for _ in range(TRIES):
        turns = int(rng.integers(2))
        size_x, size_y = (design.depth_m, design.width_m) if turns == 0 else (design.width_m, design.depth_m)
        spare_x = room.inside.width_m - size_x - 2.0 * FREE_STANDING_M
        spare_y = room.inside.depth_m - size_y - 2.0 * FREE_STANDING_M
        if spare_x < 0.0 or spare_y < 0.0:
            continue
        x_m = room.inside.x_min_m + FREE_STANDING_M + snapped(rng.uniform(0.0, spare_x)) + size_x / 2.0
        y_m = room.inside.y_min_m + FREE_STANDING_M + snapped(rng.uniform(0.0, spare_y)) + size_y / 2.0
        yield _Place(x_m=x_m, y_m=y_m, quarter_turns=turns)


def _in_front(design: Design, host: Furniture) -> list[_Place]:
    x_m, y_m = host.point_in_map((host.depth_m + design.depth_m) / 2.0 + GAP_M, 0.0)
    return [_aligned(design, _Place(x_m=x_m, y_m=y_m, quarter_turns=(host.quarter_turns + 2) % 4))]


def _around(design: Design, host: Furniture) -> list[_Place]:
    """Facing the host: two on each long side (along its y), one on each short side."""
    long_x = (host.depth_m + design.depth_m) / 2.0 + GAP_M
    short_y = (host.width_m + design.depth_m) / 2.0 + GAP_M
    seats = [(sign * long_x, y, 2 if sign > 0 else 0) for sign in (1, -1) for y in (-0.3, 0.3)]
    seats += [(0.0, short_y, 3), (0.0, -short_y, 1)]
    places = []
    for x, y, turns in seats:
        x_m, y_m = host.point_in_map(x, y)
        places.append(
            _aligned(design, _Place(x_m=x_m, y_m=y_m, quarter_turns=(host.quarter_turns + turns) % 4))
        )
    return places


def _beside(design: Design, host: Furniture) -> list[_Place]:
    """To the left and right, backs in one line."""
    back_x = (design.depth_m - host.depth_m) / 2.0
    side_y = (host.width_m + design.width_m) / 2.0 + GAP_M
    places = []
    for sign in (1, -1):
        x_m, y_m = host.point_in_map(back_x, sign * side_y)
        places.append(_aligned(design, _Place(x_m=x_m, y_m=y_m, quarter_turns=host.quarter_turns)))
    return places


_PLACES = {"front": _in_front, "around": _around, "side": _beside}


def _aligned(design: Design, place: _Place) -> _Place:
    """The place moved so that the footprint's edges lie on the floor plan's grid."""
    even = place.quarter_turns % 2 == 0
    half_x, half_y = (design.depth_m, design.width_m) if even else (design.width_m, design.depth_m)
    return _Place(
        x_m=snapped(place.x_m - half_x / 2.0) + half_x / 2.0,
        y_m=snapped(place.y_m - half_y / 2.0) + half_y / 2.0,
        quarter_turns=place.quarter_turns,
    )


def _try(
    state: _State, room: Room, design: Design, places: Iterator[_Place], host: Furniture | None = None
) -> Furniture | None:
    """Put the design on the first place that fits; None where none does."""
    for place in places:
        number = state.count.get(design.kind, 0) + 1
        piece = Furniture(
            name=f"{design.kind} {number}",
            kind=design.kind,
            room=room.name,
            x_m=round(place.x_m, 6),
            y_m=round(place.y_m, 6),
            quarter_turns=place.quarter_turns,
            depth_m=design.depth_m,
            width_m=design.width_m,
            height_m=design.height_m,
            tall=design.tall,
            surfaces=design.surfaces,
            parts=design.parts,
        )
        front = _front(piece, design.front_m)
        if not _fits(state, room, piece, front, host):
            continue
        grid = state.grid.with_rects((piece.footprint,))
        if any(grid.regions(radius_m) != 1 for radius_m in PASSAGE_RADII_M):
            continue
        state.grid = grid
        state.placed.append(piece)
        state.count[design.kind] = number
        if front is not None:
            state.fronts[piece.name] = front
        return piece
    return None


def _front(piece: Furniture, front_m: float) -> Rect | None:
    if front_m <= 0.0:
        return None
    x_m = piece.depth_m / 2.0
    return piece.in_map(
        Rect(x_min_m=x_m, y_min_m=-piece.width_m / 2.0, x_max_m=x_m + front_m, y_max_m=piece.width_m / 2.0)
    )


def _fits(state: _State, room: Room, piece: Furniture, front: Rect | None, host: Furniture | None) -> bool:
    footprint = piece.footprint
    if not room.inside.grown(-GAP_M).contains(footprint):
        return False
    if front is not None and not room.inside.contains(front):
        return False
    if any(footprint.overlaps(_door_zone(door)) for door in state.doors):
        return False
    kept = footprint.grown(GAP_M)
    for other in state.placed:
        zone = state.fronts.get(other.name)
        if kept.overlaps(other.footprint) or (front is not None and front.overlaps(other.footprint)):
            return False
        if zone is not None and other is not host and footprint.overlaps(zone):
            return False
    return True


def _door_zone(door: Door) -> Rect:
    """The floor on both sides of a door that furniture stays out of."""
    opening = door.opening
    beyond_x, beyond_y = (DOOR_ZONE_SIDE_M, DOOR_ZONE_M) if door.along_x else (DOOR_ZONE_M, DOOR_ZONE_SIDE_M)
    return Rect(
        x_min_m=opening.x_min_m - beyond_x,
        y_min_m=opening.y_min_m - beyond_y,
        x_max_m=opening.x_max_m + beyond_x,
        y_max_m=opening.y_max_m + beyond_y,
    )
