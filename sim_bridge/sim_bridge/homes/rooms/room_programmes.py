"""Which rooms a home has, and what each kind of room needs to be one."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from robustnav_msgs_py.errors import BadSceneError

MIN_ROOMS, MAX_ROOMS = 1, 10
# From so many rooms on, a hallway joins them.
HALLWAY_FROM = 5


class Difficulty(StrEnum):
    """How large the home is that a robot has to search."""

    EASY = "easy"
    MEDIUM = "medium"
    HARD = "hard"


ROOM_COUNTS: dict[Difficulty, tuple[int, int]] = {
    Difficulty.EASY: (1, 1),
    Difficulty.MEDIUM: (3, 4),
    Difficulty.HARD: (6, 10),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class RoomNeeds:
    """Bounds on a room's floor between its walls; `max_aspect` is the longer side over the shorter one."""

    area_m2: tuple[float, float]
    min_side_m: float
    max_aspect: float = 1.8
    min_aspect: float = 1.0


# A bed is 2 m long and wants a way around it; a hallway is long, and as wide as two people who pass.
NEEDS: dict[str, RoomNeeds] = {
    "living room": RoomNeeds(area_m2=(16.0, 24.0), min_side_m=3.2),
    "kitchen": RoomNeeds(area_m2=(9.0, 14.0), min_side_m=2.6),
    "dining room": RoomNeeds(area_m2=(9.5, 14.0), min_side_m=2.8, max_aspect=1.7),
    "bedroom": RoomNeeds(area_m2=(10.0, 15.0), min_side_m=2.8, max_aspect=1.7),
    "children's room": RoomNeeds(area_m2=(9.0, 14.0), min_side_m=2.8, max_aspect=1.7),
    "bathroom": RoomNeeds(area_m2=(5.5, 8.0), min_side_m=2.0),
    "office": RoomNeeds(area_m2=(8.0, 12.0), min_side_m=2.5),
    "hallway": RoomNeeds(area_m2=(5.0, 10.0), min_side_m=1.4, max_aspect=5.5, min_aspect=2.0),
    "laundry room": RoomNeeds(area_m2=(5.0, 7.0), min_side_m=2.0),
    "storage room": RoomNeeds(area_m2=(5.0, 7.0), min_side_m=2.0),
}
ROOM_KINDS = tuple(NEEDS)
# One room that is the whole home is larger: all the furniture that is searched stands in it.
STUDIO_NEEDS: dict[str, RoomNeeds] = {
    "living room": RoomNeeds(area_m2=(20.0, 28.0), min_side_m=3.8, max_aspect=1.6),
    "bedroom": RoomNeeds(area_m2=(16.0, 22.0), min_side_m=3.5, max_aspect=1.6),
    "kitchen": RoomNeeds(area_m2=(15.0, 21.0), min_side_m=3.5, max_aspect=1.6),
    "office": RoomNeeds(area_m2=(15.0, 20.0), min_side_m=3.5, max_aspect=1.6),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgrammeRoom:
    """A room that a home is to have. `name` is what a person would say."""

    name: str
    kind: str
    needs: RoomNeeds


# (name, kind, how likely one that can still be chosen is to come next, from which number of rooms on).
_OPTIONAL: tuple[tuple[str, str, float, int], ...] = (
    ("dining room", "dining room", 1.0, 6),
    ("office", "office", 1.0, 6),
    ("guest room", "bedroom", 1.0, 6),
    ("children's room", "children's room", 1.0, 6),
    ("laundry room", "laundry room", 0.5, 6),
    ("storage room", "storage room", 0.4, 6),
    ("bathroom 2", "bathroom", 0.6, 8),
)


def room_count_of(rng: np.random.Generator, difficulty: Difficulty) -> int:
    """How many rooms a home of that difficulty has."""
    low, high = ROOM_COUNTS[difficulty]
    return int(rng.integers(low, high + 1))


def draw_programme(rng: np.random.Generator, room_count: int) -> tuple[ProgrammeRoom, ...]:
    """The rooms of a home with `room_count` rooms, the most important first.

    Raises BadSceneError where there are to be fewer than 1 or more than 10.
    """
    if not MIN_ROOMS <= room_count <= MAX_ROOMS:
        raise BadSceneError(
            f"a home that is drawn has {MIN_ROOMS}..{MAX_ROOMS} rooms, not {room_count!r}; ask for as many"
        )
    if room_count == 1:
        kind = str(rng.choice(list(STUDIO_NEEDS)))
        return (_room(kind, kind, STUDIO_NEEDS),)
    if room_count == 2:
        kinds = ["kitchen", str(rng.choice(["living room", "bedroom"]))]
    else:
        kinds = ["living room", "kitchen", "bedroom", "bathroom", "hallway"][:room_count]
    chosen = [(kind, kind) for kind in kinds]
    left = [option for option in _OPTIONAL if room_count >= option[3]]
    while len(chosen) < room_count:
        weights = np.array([weight for _, _, weight, _ in left])
        name, kind, _, _ = left.pop(int(rng.choice(len(left), p=weights / weights.sum())))
        chosen.append((name, kind))
    return tuple(_room(name, kind, NEEDS) for name, kind in chosen)


def _room(name: str, kind: str, needs: Mapping[str, RoomNeeds]) -> ProgrammeRoom:
    return ProgrammeRoom(name=name, kind=kind, needs=needs[kind])
