"""Who writes: what each mentions, how long-winded, how sentences are joined and spelled."""

from dataclasses import dataclass
from enum import Enum

from robustnav_nodes.instruction.generated.facts import Kind


class Topic(Enum):
    """What facts are about; each writer mentions some of each."""

    START = "start"
    TURN = "turns"
    CROSSING = "rooms and doors"
    LEG = "straight on, towards, through"
    PASSING = "things on the way"
    STOP = "the end"


class Spelling(Enum):
    """Capitals and full stops."""

    PROPER = "as in a book"
    LOWER = "no capitals"
    CARELESS = "no capitals, no stop at the end"
    UPPER = "all capitals"


@dataclass(frozen=True, slots=True, kw_only=True)
class Writer:
    """`p`: how likely an event of each topic is mentioned. `clauses`: fewest and most.

    `wordy`: -1 takes the shorter of two ways to say it, 1 the longer. `p_sentence`: that a clause begins a
    sentence, else it is joined. `p_your`: "your left" rather than "the left"; `p_look`: "the wooden table".
    `p_the_room`: a room is not called by its name. `prefers`: kinds of facts that are told more often.
    """

    name: str
    p: dict[Topic, float]
    clauses: tuple[int, int]
    wordy: int = 0
    p_sentence: float = 0.5
    p_your: float = 0.5
    p_look: float = 0.25
    p_the_room: float = 0.12
    metric: bool = False
    drops_articles: bool = False
    openers: tuple[str, ...] = ()
    closers: tuple[str, ...] = ()
    spelling: tuple[tuple[Spelling, float], ...] = ((Spelling.PROPER, 1.0),)
    prefers: frozenset[Kind] = frozenset()


def _p(start: float, turn: float, crossing: float, leg: float, passing: float) -> dict[Topic, float]:
    return {
        Topic.START: start,
        Topic.TURN: turn,
        Topic.CROSSING: crossing,
        Topic.LEG: leg,
        Topic.PASSING: passing,
        Topic.STOP: 1.0,
    }


_COUNTING = frozenset({Kind.CROSS_COUNTED, Kind.CROSS_OUTERMOST, Kind.STOP_OUTERMOST, Kind.STRAIGHT})
_LANDMARKS = frozenset(
    {
        *(Kind.TURN_AT, Kind.TURN_TOWARDS, Kind.UNTIL, Kind.TOWARDS, Kind.START_BESIDE, Kind.START_FACING),
        *(Kind.AROUND, Kind.PASS_BETWEEN, Kind.STOP_BESIDE, Kind.STOP_BETWEEN, Kind.START_BACKWARD),
    }
)

WRITERS = (
    Writer(
        name="terse",
        p=_p(0.3, 0.75, 0.8, 0.1, 0.15),
        clauses=(2, 4),
        wordy=-1,
        p_sentence=0.75,
        p_your=0.15,
        p_look=0.05,
        drops_articles=True,
        spelling=((Spelling.PROPER, 0.9), (Spelling.LOWER, 0.1)),
    ),
    Writer(name="plain", p=_p(0.4, 0.7, 0.75, 0.15, 0.3), clauses=(2, 4), p_sentence=0.45),
    Writer(
        name="turner",
        p=_p(0.8, 0.95, 0.6, 0.15, 0.1),
        clauses=(3, 5),
        p_sentence=0.5,
        p_your=0.6,
        p_look=0.15,
        prefers=frozenset({Kind.CROSS_TURNING, Kind.CROSS_ASIDE}),
    ),
    Writer(
        name="looker",
        p=_p(0.4, 0.6, 0.5, 0.25, 0.4),
        clauses=(2, 5),
        p_sentence=0.5,
        p_look=0.4,
        prefers=_LANDMARKS,
    ),
    Writer(
        name="chatty",
        p=_p(0.55, 0.75, 0.75, 0.2, 0.3),
        clauses=(3, 5),
        wordy=1,
        p_sentence=0.6,
        p_your=0.85,
        p_look=0.45,
        openers=("ok, ", "okay, ", "so ", "first, ", "to start, ", "all you do is ", "", "", "", ""),
        closers=(
            "you made it",
            "that's the place",
            "you're done",
            "you have reached your destination",
            "",
            "",
        ),
        prefers=frozenset({Kind.SEE, Kind.START_FACING, Kind.START_BESIDE, Kind.UNTIL}),
    ),
    Writer(
        name="counter",
        p=_p(0.4, 0.7, 0.85, 0.3, 0.1),
        clauses=(2, 4),
        p_sentence=0.5,
        metric=True,
        prefers=_COUNTING,
    ),
    Writer(
        name="hurried",
        p=_p(0.3, 0.7, 0.75, 0.15, 0.3),
        clauses=(2, 4),
        wordy=-1,
        p_sentence=0.2,
        p_look=0.1,
        spelling=((Spelling.LOWER, 0.45), (Spelling.CARELESS, 0.45), (Spelling.UPPER, 0.1)),
    ),
    Writer(
        name="formal",
        p=_p(0.55, 0.8, 0.8, 0.2, 0.25),
        clauses=(2, 4),
        wordy=1,
        p_sentence=0.7,
        p_your=0.3,
        p_look=0.3,
        p_the_room=0.04,
        prefers=frozenset({Kind.STOP_INSIDE, Kind.STOP_OUTSIDE, Kind.THROUGH, Kind.START_BACK}),
    ),
)

TOPIC_OF = {
    kind: (
        Topic.START
        if kind.name.startswith("START")
        else Topic.TURN
        if kind.name.startswith("TURN")
        else Topic.CROSSING
        if kind.name.startswith("CROSS")
        else Topic.STOP
        if kind.name.startswith("STOP")
        else Topic.LEG
        if kind in (Kind.THROUGH, Kind.STRAIGHT, Kind.TOWARDS, Kind.UNTIL, Kind.AHEAD_TO)
        else Topic.PASSING
    )
    for kind in Kind
}
