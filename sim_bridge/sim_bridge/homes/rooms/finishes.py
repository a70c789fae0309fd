"""What floors and walls of a drawn home are made of: tiles where it gets wet, and soft colours by kind."""

from collections.abc import Sequence

import numpy as np

from sim_bridge.homes.materials import Material, Substance
from sim_bridge.homes.rooms.room_programmes import ProgrammeRoom

BOARDS = ("oak", "walnut", "#c49a6c", "#a9794b", "#8c6a4a", "#d2b48c")
TILES = ("#d9d4c7", "#c9cdd0", "#b7bdb9", "#e4dccb", "#a8b4bb", "#cbb8a0")
CARPETS = ("#8f9bb3", "#a79a8c", "#8fa08a", "#b49a9a", "#7f8791", "#b8a98a")
TILED = ("kitchen", "bathroom", "laundry room")
CARPETED = ("bedroom", "children's room", "office")
P_CARPET = 0.5
PAINTS: dict[str, tuple[str, ...]] = {
    "living room": ("#ecdec0", "#e6d8c8", "#dfe0d2"),
    "kitchen": ("#f2edb4", "#f0e6cc", "#e3ebd4"),
    "dining room": ("#ecd0bc", "#e8d6b4", "#e6d2d0"),
    "bedroom": ("#c4d4ec", "#d2d0e6", "#cfdcdc"),
    "children's room": ("#f4d8dc", "#cfe6ec", "#e6eab8"),
    "bathroom": ("#cceef0", "#d6ecec", "#d4e4ee"),
    "office": ("#cce2c4", "#d6dcc8", "#cfdae0"),
    "hallway": ("#ebe8e0", "#e8e4d6", "#e4e6e6"),
    "laundry room": ("#e0ecee", "#e8ecee", "#dde8e0"),
    "storage room": ("#dedad2", "#e2ded4", "#d8dadc"),
}
# Two rooms of one paint are still not quite the same.
SHADES = (0.95, 1.03)


def draw_finishes(
    rng: np.random.Generator, programme: Sequence[ProgrammeRoom]
) -> list[tuple[Material, Material]]:
    """The floor and the walls of each room, in the order of the programme. A home has boards of one wood."""
    boards = Material(substance=Substance.BOARDS, colour=str(rng.choice(BOARDS)))
    finishes = []
    for room in programme:
        floor = boards
        if room.kind in TILED:
            floor = Material(substance=Substance.TILES, colour=str(rng.choice(TILES)))
        elif room.kind in CARPETED and rng.random() < P_CARPET:
            floor = Material(substance=Substance.CARPET, colour=str(rng.choice(CARPETS)))
        paint = Material(substance=Substance.PAINT, colour=str(rng.choice(PAINTS[room.kind])))
        finishes.append((floor, paint.shaded(rng.uniform(*SHADES))))
    return finishes
