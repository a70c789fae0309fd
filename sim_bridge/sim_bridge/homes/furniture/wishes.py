"""Which furniture each kind of room wants, in the order in which it finds its places."""

from collections.abc import Collection
from dataclasses import dataclass
from enum import StrEnum

from robustnav_msgs_py.errors import BadSceneError

CERTAIN = 1.0


class How(StrEnum):
    """Where in a room the pieces of a wish belong."""

    WALL = "with the back to a wall"
    CORNER = "with the back to a wall, in a corner where possible"
    MIDDLE = "free-standing, with a way around"
    ROW = "side by side along a wall"
    FACING = "the first at a wall, the second opposite, the third between them"


class Where(StrEnum):
    """Where a companion stands, seen from its host."""

    AROUND = "around"
    FRONT = "front"
    SIDE = "side"


@dataclass(frozen=True, slots=True, kw_only=True)
class Companion:
    """Pieces that come with another, one for each of `chances` that comes true."""

    kind: str
    where: Where
    chances: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Wish:
    """Furniture that a room has with probability `p`; where certain, it must find a place.

    Companions are those of the first piece. Of pieces that FACE each other, the third may be missing.
    """

    kinds: tuple[str, ...]
    p: float
    how: How = How.WALL
    companions: tuple[Companion, ...] = ()


def at_wall(kind: str, p: float, *companions: Companion) -> Wish:
    """A wish for one piece with its back to a wall."""
    return Wish(kinds=(kind,), p=p, companions=companions)


CHAIR_AT_DESK = Companion(kind="chair", where=Where.FRONT, chances=(0.9,))
OFFICE_CHAIR_AT_DESK = Companion(kind="office chair", where=Where.FRONT, chances=(CERTAIN,))
NIGHTSTANDS = Companion(kind="nightstand", where=Where.SIDE, chances=(CERTAIN, 0.5))
NIGHTSTAND = Companion(kind="nightstand", where=Where.SIDE, chances=(0.6,))
SIDE_TABLE = Companion(kind="side table", where=Where.SIDE, chances=(0.6,))
DINING_TABLE = Wish(
    kinds=("dining table",),
    p=0.95,
    how=How.MIDDLE,
    companions=(Companion(kind="chair", where=Where.AROUND, chances=(CERTAIN, CERTAIN, 0.7, 0.5)),),
)
WASHING_MACHINE = at_wall("washing machine", 0.8)

WISHES: dict[str, tuple[Wish, ...]] = {
    "kitchen": (
        Wish(kinds=("sink unit", "kitchen counter", "stove", "fridge"), p=CERTAIN, how=How.ROW),
        at_wall("cupboard", 0.5),
        at_wall("stool", 0.5),
        at_wall("kitchen counter", 0.2),
    ),
    "dining room": (
        at_wall("sideboard", 0.8),
        at_wall("low shelf", 0.3),
        at_wall("console table", 0.3),
        at_wall("stool", 0.3),
    ),
    "living room": (
        Wish(
            kinds=("sofa", "tv stand", "coffee table"),
            p=CERTAIN,
            how=How.FACING,
            companions=(SIDE_TABLE,),
        ),
        at_wall("bookcase", 0.8),
        at_wall("armchair", 0.7, SIDE_TABLE),
        at_wall("sideboard", 0.6),
        at_wall("low shelf", 0.4),
    ),
    "bedroom": (
        at_wall("bed", CERTAIN, NIGHTSTANDS),
        Wish(kinds=("wardrobe",), p=CERTAIN, how=How.CORNER),
        at_wall("dresser", 0.7),
        at_wall("desk", 0.3, CHAIR_AT_DESK),
        at_wall("mat", 0.3),
        at_wall("armchair", 0.2),
    ),
    "children's room": (
        at_wall("single bed", CERTAIN, NIGHTSTAND),
        at_wall("toy chest", 0.9),
        at_wall("desk", 0.8, CHAIR_AT_DESK),
        at_wall("low shelf", 0.8),
        at_wall("wardrobe", 0.6),
        at_wall("mat", 0.7),
    ),
    "office": (
        at_wall("desk", CERTAIN, OFFICE_CHAIR_AT_DESK),
        at_wall("bookcase", 0.9),
        at_wall("filing cabinet", 0.9),
        at_wall("low shelf", 0.5),
        at_wall("armchair", 0.3),
    ),
    "bathroom": (
        # First, or it would never find a place; a room where it leaves none for the rest is begun again.
        Wish(kinds=("bathtub",), p=0.6, how=How.CORNER),
        at_wall("washstand", CERTAIN),
        at_wall("toilet", CERTAIN),
        at_wall("bathroom cabinet", 0.6),
        at_wall("mat", 0.3),
        at_wall("stool", 0.2),
    ),
    "laundry room": (
        Wish(kinds=("washing machine", "dryer"), p=CERTAIN, how=How.ROW),
        at_wall("ironing board", 0.9),
        at_wall("mat", 0.6),
        at_wall("cupboard", 0.3),
    ),
    "hallway": (
        at_wall("console table", 0.8),
        at_wall("shoe bench", 0.8),
        at_wall("mat", 0.7),
        at_wall("stool", 0.2),
    ),
    "storage room": (
        at_wall("low shelf", 0.9),
        at_wall("cupboard", 0.7),
        at_wall("filing cabinet", 0.6),
        at_wall("ironing board", 0.3),
        at_wall("toy chest", 0.2),
    ),
}
# A room must end with so many pieces, of which one carries objects.
MIN_PIECES = 2
MIN_PIECES_OF = {"hallway": 1, "storage room": 1}
# Where a home's meals are eaten: in the first of these that it has.
MEAL_ROOMS = ("dining room", "kitchen", "living room")


def wishes_of(room_kind: str, home_kinds: Collection[str]) -> tuple[Wish, ...]:
    """What a room of a kind wants in a home that has rooms of `home_kinds`.

    Raises BadSceneError for a kind of room that nobody knows how to furnish.
    """
    if room_kind not in WISHES:
        raise BadSceneError(
            f"nobody knows how to furnish a room of the kind {room_kind!r}; there are {', '.join(WISHES)}"
        )
    wishes = WISHES[room_kind]
    if room_kind == next((kind for kind in MEAL_ROOMS if kind in home_kinds), None):
        # After what the room is for, before what may be missing.
        certain = sum(wish.p >= CERTAIN for wish in wishes)
        wishes = (*wishes[:certain], DINING_TABLE, *wishes[certain:])
    if room_kind == "bathroom" and "laundry room" not in home_kinds:
        wishes = (*wishes, WASHING_MACHINE)
    return wishes
