"""What people call each kind of room, and what a classifier of rooms takes it for."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from robustnav_nodes.instruction.trajectory import ROOM_TYPES


@dataclass(frozen=True, slots=True, kw_only=True)
class RoomWords:
    """`said`: what people write, all forms of `concepts.ROOMS`; `types`: what it looks like, with weights."""

    said: tuple[str, ...]
    types: Mapping[str, float]


WORDS: Mapping[str, RoomWords] = MappingProxyType(
    {
        "living room": RoomWords(
            said=("living room", "living room", "living area", "lounge", "family room", "sitting room"),
            types={"livingroom": 0.6, "familyroom": 0.25, "lounge": 0.15},
        ),
        "kitchen": RoomWords(said=("kitchen",), types={"kitchen": 0.95, "diningroom": 0.05}),
        "dining room": RoomWords(
            said=("dining room", "dining room", "dining area"),
            types={"diningroom": 0.85, "kitchen": 0.08, "lounge": 0.07},
        ),
        "bedroom": RoomWords(said=("bedroom",), types={"bedroom": 1.0}),
        "children's room": RoomWords(said=("bedroom",), types={"bedroom": 0.9, "familyroom": 0.1}),
        "bathroom": RoomWords(said=("bathroom", "bathroom", "restroom", "washroom"), types={"bathroom": 1.0}),
        "office": RoomWords(said=("office", "office", "study"), types={"office": 0.9, "bedroom": 0.1}),
        "hallway": RoomWords(
            said=("hallway", "hallway", "hall", "hall", "corridor"), types={"hallway": 0.85, "entryway": 0.15}
        ),
        "entryway": RoomWords(
            said=("entryway", "foyer", "entry way", "hallway"), types={"entryway": 0.6, "hallway": 0.4}
        ),
        "laundry room": RoomWords(
            said=("laundry room", "laundry room", "utility room"),
            types={"bathroom": 0.4, "kitchen": 0.3, "hallway": 0.3},
        ),
        "storage room": RoomWords(said=("closet",), types={"hallway": 0.4, "bedroom": 0.3, "office": 0.3}),
    }
)

P_MISTAKEN = 0.12  # of a place: the evidence then speaks for some other type
_SHARPNESS = (4.0, 40.0)  # pseudo-counts of the evidence: a glance, or a good look
_BACKGROUND = 0.25


def room_evidence(kinds: Mapping[str, float], rng: np.random.Generator) -> tuple[float, ...]:
    """A classifier's answer at a place that shows rooms of these kinds, with weights that sum to one.

    Soft, and wrong now and then; in the order of ROOM_TYPES.
    """
    expected = np.full(len(ROOM_TYPES), _BACKGROUND / len(ROOM_TYPES))
    if rng.random() < P_MISTAKEN:
        expected[int(rng.integers(len(ROOM_TYPES)))] += 1.0
    for kind, weight in kinds.items():
        for room_type, share in WORDS[kind].types.items():
            expected[ROOM_TYPES.index(room_type)] += weight * share
    expected /= expected.sum()
    drawn = rng.dirichlet(expected * rng.uniform(*_SHARPNESS) + 1e-3)
    return tuple(round(float(p), 3) for p in drawn)
