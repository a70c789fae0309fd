"""A rectangular ground plan, drawn from the inside out: a room in the middle, and strips of rooms around it.

The middle is the hallway where there is one. Every strip lies along a whole side of what is there already, so
that the plan is a rectangle at every step, and the first strips open onto the middle. Rooms go to the strips
by chance; the needs of each room decide which draws are kept. Wall lines lie on the grid.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from itertools import pairwise

import numpy as np

from sim_bridge.homes.home import WALL_THICKNESS_M
from sim_bridge.homes.rect import GRID_M, Rect, Side, snapped
from sim_bridge.homes.rooms.door_choice import are_joined, has_room_for_door, kinds_beside
from sim_bridge.homes.rooms.room_programmes import HALLWAY_FROM, MAX_ROOMS, ProgrammeRoom, RoomNeeds
from sim_bridge.homes.rooms.wall_lines import edge, shared_stretch

# How many rooms a strip is tried with: as many as are between so long and so short.
LONGEST_ROOM_M, SHORTEST_ROOM_M = 6.0, 2.4
# How often a strip is filled with other rooms before the plan counts as failed.
STRIP_TRIES = 10
MAX_PLAN_ASPECT = 1.75
# Areas are drawn this far within their bounds: moving walls to the grid changes them by less.
AREA_MARGIN = 0.04
# A hallway this wide has doors in its short sides too; others are narrow.
P_WIDE_HALLWAY = 0.8
WIDE_HALLWAY_M = (1.70, 2.0)
NARROW_HALLWAY_M = (1.50, 1.65)
P_TURNED = 0.5
# So little is no difference between two sides, areas or ratios.
ROUNDING = 1e-6
# Nobody is to sleep, cook or sit in a room without a window.
MAY_LIE_INSIDE = ("hallway", "storage room", "laundry room", "bathroom")


def draw_ground_plan(rng: np.random.Generator, programme: Sequence[ProgrammeRoom]) -> list[Rect] | None:
    """The rooms' areas, up to the middles of the walls, in the order of the programme.

    The plan's lower left corner is the origin. None where this draw failed; draw again then.
    """
    kinds = [room.kind for room in programme]
    beside = [kinds_beside(kinds, number) for number in range(len(kinds))]
    middle = kinds.index("hallway") if "hallway" in kinds else _middle_room(rng, programme)
    ground = _middle_area(rng, programme[middle], len(programme))
    if not meets(ground, programme[middle].needs):
        return None
    placed = {middle: ground}
    while len(placed) < len(programme):
        # The first strip lies along the hallway's long side: that is what a hallway is for.
        sides = [Side(side) for side in rng.permutation(list(Side))] if len(placed) > 1 else [Side.NORTH]
        strips = (_sound_strip(rng, programme, beside, placed, ground, side) for side in sides)
        strip = next((strip for strip in strips if strip), None)
        if strip is None:
            return None
        placed |= strip
        ground = _around([ground, *strip.values()])
    if not 1.0 / MAX_PLAN_ASPECT <= ground.width_m / ground.depth_m <= MAX_PLAN_ASPECT:
        return None
    turned = rng.random() < P_TURNED
    return [_at_origin(placed[number], ground, turned) for number in range(len(programme))]


def _sound_strip(
    rng: np.random.Generator,
    programme: Sequence[ProgrammeRoom],
    beside: Sequence[tuple[str, ...]],
    placed: Mapping[int, Rect],
    ground: Rect,
    side: Side,
) -> dict[int, Rect] | None:
    """A strip of rooms along one side of the ground, each beside one that it belongs to, or None."""
    kinds = [room.kind for room in programme]
    fitting = _fitting(kinds, beside, placed, ground, side)
    for _ in range(STRIP_TRIES if fitting else 0):
        strip = _strip(rng, programme, fitting, ground, side)
        if strip is None:
            continue
        if _is_sound(kinds, beside, {**placed, **strip}, strip, _around([ground, *strip.values()])):
            return strip
    return None


def _fitting(
    kinds: Sequence[str],
    beside: Sequence[tuple[str, ...]],
    placed: Mapping[int, Rect],
    ground: Rect,
    side: Side,
) -> list[int]:
    """The rooms left that could, along one side of the ground, be beside a room that they belong to."""
    line_m = edge(ground, side).line_m
    there = {kinds[number] for number, area in placed.items() if edge(area, side).line_m == line_m}
    left = [number for number in range(len(kinds)) if number not in placed]
    fitting: list[int] = []
    for _ in left:
        # Rooms of one strip belong to each other as well.
        fitting = [number for number in left if there.intersection(beside[number])]
        there |= {kinds[number] for number in fitting}
    return fitting


def _is_sound(
    kinds: Sequence[str],
    beside: Sequence[tuple[str, ...]],
    placed: Mapping[int, Rect],
    strip: Iterable[int],
    ground: Rect,
) -> bool:
    """Whether each new room is beside one that it belongs to, and none that wants light is walled in."""
    for number in strip:
        if not any(
            kinds[other] in beside[number] and has_room_for_door(shared_stretch(placed[number], area))
            for other, area in placed.items()
        ):
            return False
    if not are_joined(kinds, placed):
        return False
    return all(
        kinds[number] in MAY_LIE_INSIDE
        or any(edge(area, side).line_m == edge(ground, side).line_m for side in Side)
        for number, area in placed.items()
    )


def meets(area: Rect, needs: RoomNeeds) -> bool:
    """Whether a room of that area, up to the middles of its walls, is as its kind needs it."""
    inside = area.grown(-WALL_THICKNESS_M / 2.0)
    short_m, long_m = sorted((inside.width_m, inside.depth_m))
    return (
        needs.area_m2[0] <= inside.area_m2 + ROUNDING
        and inside.area_m2 <= needs.area_m2[1] + ROUNDING
        and needs.min_side_m <= short_m + ROUNDING
        and needs.min_aspect <= long_m / short_m + ROUNDING
        and long_m / short_m <= needs.max_aspect + ROUNDING
    )


def _middle_room(rng: np.random.Generator, programme: Sequence[ProgrammeRoom]) -> int:
    """Without a hallway, people pass through the living room or the kitchen."""
    kinds = [room.kind for room in programme]
    through = [number for number, kind in enumerate(kinds) if kind in ("living room", "kitchen")]
    return int(rng.choice(through)) if through else 0


def _drawn_area_m2(rng: np.random.Generator, needs: RoomNeeds, largeness: float) -> float:
    """An area with the walls' halves that belong to the room; the more rooms lie around it, the larger."""
    low_m2, high_m2 = needs.area_m2[0] * (1.0 + AREA_MARGIN), needs.area_m2[1] * (1.0 - AREA_MARGIN)
    inside_m2 = rng.uniform(low_m2 + largeness * (high_m2 - low_m2), high_m2)
    return float((inside_m2**0.5 + WALL_THICKNESS_M) ** 2)


def _middle_area(rng: np.random.Generator, room: ProgrammeRoom, room_count: int) -> Rect:
    largeness = max(0.0, (room_count - HALLWAY_FROM) / (MAX_ROOMS - HALLWAY_FROM))
    area_m2 = _drawn_area_m2(rng, room.needs, largeness)
    if room.kind == "hallway":
        widths_m = WIDE_HALLWAY_M if rng.random() < P_WIDE_HALLWAY else NARROW_HALLWAY_M
        depth_m = snapped(rng.uniform(*widths_m))
    else:
        aspect = rng.uniform(1.0, room.needs.max_aspect)
        depth_m = snapped((area_m2 / aspect) ** 0.5)
    return Rect(x_min_m=0.0, y_min_m=0.0, x_max_m=snapped(area_m2 / depth_m), y_max_m=depth_m)


def _strip(
    rng: np.random.Generator,
    programme: Sequence[ProgrammeRoom],
    left: Sequence[int],
    ground: Rect,
    side: Side,
) -> dict[int, Rect] | None:
    """Some of the rooms that are left, side by side along one side of the ground; None where none fit."""
    length_m = ground.width_m if side in (Side.SOUTH, Side.NORTH) else ground.depth_m
    fewest = min(len(left), math.ceil(length_m / LONGEST_ROOM_M))
    most = min(len(left), max(fewest, int(length_m / SHORTEST_ROOM_M)))
    count = int(rng.integers(fewest, most + 1))
    chosen = [left[int(at)] for at in rng.permutation(len(left))[:count]]
    fitted = _fitted(rng, [programme[number].needs for number in chosen], length_m)
    if fitted is None:
        return None
    depth_m, cuts_m = fitted
    return {
        number: _in_strip(ground, side, low_m, high_m, depth_m)
        for number, (low_m, high_m) in zip(chosen, pairwise(cuts_m), strict=True)
    }


def _fitted(
    rng: np.random.Generator, needs: Sequence[RoomNeeds], length_m: float
) -> tuple[float, list[float]] | None:
    """A strip's depth, and where its rooms begin and end, so that every room is as it needs to be.

    `length_m`, the depth and the cuts are between wall lines. None where the drawn depth fits no way.
    """
    inside_m = length_m - len(needs) * WALL_THICKNESS_M
    if inside_m <= 0.0:
        return None
    shallowest, deepest = zip(*(_depths_m(need) for need in needs), strict=True)
    low_m = max(sum(need.area_m2[0] for need in needs) / inside_m, *shallowest)
    high_m = min(sum(need.area_m2[1] for need in needs) / inside_m, *deepest)
    if low_m > high_m:
        return None
    depth_m = snapped(rng.uniform(low_m, high_m))
    narrowest = [
        _steps_up(max(need.area_m2[0] / depth_m, need.min_side_m, depth_m / need.max_aspect))
        for need in needs
    ]
    widest = [_steps_down(min(need.area_m2[1] / depth_m, depth_m * need.max_aspect)) for need in needs]
    ranges = [high - low for low, high in zip(narrowest, widest, strict=True)]
    spare, others = round(inside_m / GRID_M) - sum(narrowest), sum(ranges)
    if min(ranges) < 0 or not 0 <= spare <= others:
        return None
    cuts_m = [0.0]
    for low, most in zip(narrowest, ranges, strict=True):
        # What the rooms that follow cannot take is left to this one.
        others -= most
        extra = int(rng.integers(max(0, spare - others), min(most, spare) + 1))
        spare -= extra
        cuts_m.append(snapped(cuts_m[-1] + (low + extra) * GRID_M + WALL_THICKNESS_M))
    return snapped(depth_m + WALL_THICKNESS_M), cuts_m


@cache
def _depths_m(needs: RoomNeeds) -> tuple[float, float]:
    """The least and the greatest depth that such a room can have, whatever its width."""
    low_m2, high_m2 = needs.area_m2
    return (
        max(needs.min_side_m, math.sqrt(low_m2 / needs.max_aspect)),
        min(high_m2 / needs.min_side_m, math.sqrt(high_m2 * needs.max_aspect)),
    )


def _in_strip(ground: Rect, side: Side, low_m: float, high_m: float, depth_m: float) -> Rect:
    """The piece from low_m to high_m of the strip of that depth along one side of the ground."""
    if side in (Side.SOUTH, Side.NORTH):
        y_m = ground.y_max_m if side is Side.NORTH else ground.y_min_m - depth_m
        return _rect(ground.x_min_m + low_m, y_m, ground.x_min_m + high_m, y_m + depth_m)
    x_m = ground.x_max_m if side is Side.EAST else ground.x_min_m - depth_m
    return _rect(x_m, ground.y_min_m + low_m, x_m + depth_m, ground.y_min_m + high_m)


def _around(areas: Sequence[Rect]) -> Rect:
    return Rect(
        x_min_m=min(area.x_min_m for area in areas),
        y_min_m=min(area.y_min_m for area in areas),
        x_max_m=max(area.x_max_m for area in areas),
        y_max_m=max(area.y_max_m for area in areas),
    )


def _at_origin(area: Rect, ground: Rect, turned: bool) -> Rect:
    """Moved with the ground's lower left corner to the origin, and x and y exchanged where turned."""
    xs = area.x_min_m - ground.x_min_m, area.x_max_m - ground.x_min_m
    ys = area.y_min_m - ground.y_min_m, area.y_max_m - ground.y_min_m
    if turned:
        xs, ys = ys, xs
    return _rect(xs[0], ys[0], xs[1], ys[1])


def _rect(x_min_m: float, y_min_m: float, x_max_m: float, y_max_m: float) -> Rect:
    return Rect(
        x_min_m=snapped(x_min_m), y_min_m=snapped(y_min_m), x_max_m=snapped(x_max_m), y_max_m=snapped(y_max_m)
    )


def _steps_up(length_m: float) -> int:
    """The least number of grid steps that are as long."""
    return math.ceil(length_m / GRID_M - ROUNDING)


def _steps_down(length_m: float) -> int:
    """The greatest number of grid steps that are no longer."""
    return math.floor(length_m / GRID_M + ROUNDING)
