"""What is true of a walk and can be said: one value for each thing that a person may mention."""

from dataclasses import dataclass
from enum import StrEnum

from robustnav_nodes.instruction.generated.dwelling import Dwelling, Thing
from robustnav_nodes.instruction.generated.walks import Walk

LEFT, RIGHT = "left", "right"


class Kind(StrEnum):
    """What a fact says; `frames.FRAMES` has the words."""

    START_TURN = "turn to a side to begin with"
    START_SLIGHTLY = "turn a little to begin with"
    START_AROUND = "turn around to begin with"
    START_FACING = "turn to a side from something that is in front"
    START_BESIDE = "begin with something at a side, and go ahead"
    START_FORWARD = "go ahead to begin with"
    START_BACK = "go back to something that is behind"
    START_BACKWARD = "go away from what is in front"
    TURN = "turn to a side"
    TURN_SLIGHTLY = "turn a little"
    TURN_SHARPLY = "turn a lot"
    TURN_AT = "turn to a side at something"
    TURN_TOWARDS = "turn to a side, to face something"
    CROSS = "from one room into another"
    CROSS_ASIDE = "through the door at a side"
    CROSS_TURNING = "turn to a side into a room"
    CROSS_COUNTED = "through the n-th door at a side"
    CROSS_OUTERMOST = "through the leftmost or rightmost door"
    THROUGH = "through a room from door to door"
    STRAIGHT = "straight for a while"
    PASS = "past something at a side"
    PASS_BETWEEN = "between two things"
    AROUND = "around something"
    TOWARDS = "towards something that is ahead"
    UNTIL = "until something is reached"
    AHEAD_TO = "straight on to something"
    SEE = "something comes in sight at a side"
    STOP_NEAR = "stop near something"
    STOP_FACING = "stop in front of something"
    STOP_BESIDE = "stop with something at a side"
    STOP_BETWEEN = "stop between two things"
    STOP_OUTERMOST = "stop at the leftmost or rightmost of several"
    STOP_IN_DOOR = "stop in a doorway"
    STOP_IN = "stop in a room"
    STOP_INSIDE = "stop soon after the door of a room"
    STOP_OUTSIDE = "stop before the door of a room"


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact:
    """Holds between the places `first` and `last` of a walk, `at_m` metres into it.

    Facts of one `event` say the same in other words: one of them is enough, and it also stands for those
    `instead_of`. `side` is left or right; `things` and `rooms` are named in their order; `count` is the
    number of the door, -1 for the last; `metres` is how far. It is true only where the event that it `needs`
    is told before: who is not told to turn does not go straight on.
    """

    kind: Kind
    event: str
    first: int
    last: int
    at_m: float
    side: str | None = None
    things: tuple[Thing, ...] = ()
    rooms: tuple[str, ...] = ()
    count: int = 0
    metres: float | None = None
    instead_of: tuple[str, ...] = ()
    needs: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """A walk in its dwelling, with the numbers of the things in sight of each of its places."""

    dwelling: Dwelling
    walk: Walk
    in_sight: tuple[tuple[int, ...], ...]

    def things(self, at: int) -> list[Thing]:
        return [self.dwelling.things[number] for number in self.in_sight[at]]

    def sees(self, at: int, thing: Thing) -> bool:
        return thing.number in self.in_sight[at]


def side_of(angle_rad: float) -> str:
    """Of a bearing or a turn, positive to the left."""
    return LEFT if angle_rad > 0.0 else RIGHT
