"""Between which rooms a drawn home has doors.

Living rooms, kitchens, dining rooms and hallways are passed through; every other room opens onto one of
these, but for a second bathroom, which may belong to a bedroom.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from sim_bridge.homes.home import WALL_THICKNESS_M
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.rooms.room_programmes import ProgrammeRoom
from sim_bridge.homes.rooms.wall_lines import SAME_LINE_M, Stretch, shared_stretch

DOOR_WIDTHS_M = (0.90, 0.95, 1.00)
# Between the opening and the face of the next wall.
DOOR_FROM_CORNER_M = 0.35
DOOR_MARGIN_M = DOOR_FROM_CORNER_M + WALL_THICKNESS_M / 2.0
DOOR_NEEDS_M = max(DOOR_WIDTHS_M) + 2.0 * DOOR_MARGIN_M
P_EXTRA_DOOR = 0.3

# Doors between rooms that are passed through, the most natural first; a home has as many as join these rooms.
_PASSAGES: tuple[tuple[str, str], ...] = (
    ("kitchen", "dining room"),
    ("hallway", "living room"),
    ("kitchen", "living room"),
    ("dining room", "living room"),
    ("hallway", "kitchen"),
    ("hallway", "dining room"),
)
PASSED_THROUGH = tuple(dict.fromkeys(kind for pair in _PASSAGES for kind in pair))
# Onto what the others open, the most natural first.
_OPENS_ONTO: dict[str, tuple[str, ...]] = {
    "bedroom": ("hallway", "living room"),
    "children's room": ("hallway", "living room"),
    "bathroom": ("hallway", "living room"),
    "office": ("hallway", "living room", "dining room"),
    "laundry room": ("hallway", "kitchen"),
    "storage room": ("hallway", "kitchen"),
}
# A second bathroom may belong to a bedroom.
EN_SUITE = ("hallway", "bedroom")
P_EN_SUITE = 0.5
# Second doors, which make loops.
_EXTRA: tuple[tuple[str, str], ...] = (
    *_PASSAGES,
    ("living room", "office"),
    ("bedroom", "bathroom"),
    ("kitchen", "laundry room"),
    ("kitchen", "storage room"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class DoorPlace:
    """A wall between two rooms, by their numbers in the programme, that is to have a door."""

    rooms: tuple[int, int]
    stretch: Stretch


def choose_doors(
    rng: np.random.Generator, programme: Sequence[ProgrammeRoom], areas: Sequence[Rect]
) -> list[DoorPlace] | None:
    """The walls that get a door, at most one per pair of rooms; None where no choice is sensible."""
    kinds = [room.kind for room in programme]
    placed = dict(enumerate(areas))
    walls = _walls_for_doors(placed)
    chosen: set[tuple[int, int]] = set()
    if not _join_passages(kinds, placed, walls, chosen):
        return None
    for number, kind in enumerate(kinds):
        if kind in PASSED_THROUGH or len(kinds) == 1:
            continue
        other = _opens_onto(rng, kinds, walls, number)
        if other is None:
            return None
        chosen.add(_pair(number, other))
    if not _eats_near_kitchen(kinds, chosen) or not _hallway_serves_most(kinds, chosen):
        return None
    for pair in walls:
        if pair not in chosen and _is_one_of(kinds, pair, _EXTRA) and rng.random() < P_EXTRA_DOOR:
            chosen.add(pair)
    return [DoorPlace(rooms=pair, stretch=walls[pair]) for pair in sorted(chosen)]


def kinds_beside(kinds: Sequence[str], number: int) -> tuple[str, ...]:
    """Of the home's kinds of room, those of which one must be next to room `number`, the best first.

    Empty for a room that is alone.
    """
    kind = kinds[number]
    if kind in PASSED_THROUGH:
        beside = [a if kind == b else b for a, b in _PASSAGES if kind in (a, b)]
        if kind in ("kitchen", "dining room"):
            # A hallway does not make up for the way from the stove to the table.
            beside.remove("hallway")
    elif kind == "bathroom" and "hallway" in kinds:
        return EN_SUITE if kinds.index(kind) != number else EN_SUITE[:1]
    else:
        beside = list(_OPENS_ONTO[kind])
    found = tuple(other for other in beside if other in kinds)
    # In a home of two rooms there is nothing but the kitchen.
    return found if found or len(kinds) == 1 else ("kitchen",)


def are_joined(kinds: Sequence[str], areas: Mapping[int, Rect]) -> bool:
    """Whether doors can join those of the placed rooms, by number, that are passed through."""
    passed = {number: area for number, area in areas.items() if kinds[number] in PASSED_THROUGH}
    return _join_passages(kinds, passed, _walls_for_doors(passed), set())


def has_room_for_door(stretch: Stretch | None) -> bool:
    """Whether there is such a wall, and the widest door fits into it."""
    return stretch is not None and stretch.length_m >= DOOR_NEEDS_M - SAME_LINE_M


def _walls_for_doors(areas: Mapping[int, Rect]) -> dict[tuple[int, int], Stretch]:
    """The stretches between two rooms that are long enough for a door, by the rooms' numbers, lower first."""
    walls = {}
    for first, second in combinations(sorted(areas), 2):
        stretch = shared_stretch(areas[first], areas[second])
        if stretch and has_room_for_door(stretch):
            walls[first, second] = stretch
    return walls


def _join_passages(
    kinds: Sequence[str],
    rooms: Iterable[int],
    walls: Mapping[tuple[int, int], Stretch],
    chosen: set[tuple[int, int]],
) -> bool:
    """Choose the most natural doors between rooms that are passed through; False where some stay apart."""
    group = {number: number for number in rooms if kinds[number] in PASSED_THROUGH}
    for passage in _PASSAGES:
        for first, second in walls:
            if _is_one_of(kinds, (first, second), (passage,)) and group[first] != group[second]:
                chosen.add((first, second))
                old, new = group[second], group[first]
                group = {number: new if label == old else label for number, label in group.items()}
    return len(set(group.values())) <= 1


def _opens_onto(
    rng: np.random.Generator, kinds: Sequence[str], walls: dict[tuple[int, int], Stretch], number: int
) -> int | None:
    """The room onto which a room opens that is not passed through; None where it touches no fitting one."""
    wanted = kinds_beside(kinds, number)
    if wanted == EN_SUITE and rng.random() < P_EN_SUITE:
        wanted = EN_SUITE[::-1]
    for kind in wanted:
        others = [other for other, its in enumerate(kinds) if its == kind and _pair(number, other) in walls]
        if others:
            return others[0]
    return None


def _eats_near_kitchen(kinds: Sequence[str], chosen: set[tuple[int, int]]) -> bool:
    """Whether the kitchen opens onto the dining or living room, and the dining room onto either."""
    near = {"kitchen": ("dining room", "living room"), "dining room": ("kitchen", "living room")}
    for kind, others in near.items():
        if kind in kinds and any(other in kinds for other in others):
            pairs = tuple((kind, other) for other in others)
            if not any(_is_one_of(kinds, pair, pairs) for pair in chosen):
                return False
    return True


def _hallway_serves_most(kinds: Sequence[str], chosen: set[tuple[int, int]]) -> bool:
    if "hallway" not in kinds:
        return True
    served = sum(kinds.index("hallway") in pair for pair in chosen)
    return 2 * served > len(kinds) - 1


def _is_one_of(kinds: Sequence[str], pair: tuple[int, int], of: tuple[tuple[str, str], ...]) -> bool:
    first, second = kinds[pair[0]], kinds[pair[1]]
    return (first, second) in of or (second, first) in of


def _pair(first: int, second: int) -> tuple[int, int]:
    return min(first, second), max(first, second)
