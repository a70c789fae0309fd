"""How a direction is said: "turn left" speaks of a turn, "on your left" of where something stands.

What is on one side may be gone through ("enter the door on the left"), or stand there ("past the couch on the
left", "the sink is on your left"); or the walk keeps to one side of it ("left of the couch").
"""

from collections.abc import Sequence

from robustnav_nodes.instruction.concepts import GOING
from robustnav_nodes.instruction.mentions import Mention

TURN, SLIGHT_TURN, SHARP_TURN, TOWARDS, BESIDE, THROUGH, STANDING, SIDE_OF, OUTERMOST, OTHER = range(10)
PHRASES = 10
TURNS = frozenset({TURN, SLIGHT_TURN, SHARP_TURN})

_SLIGHT = frozenset({"slight", "slightly", "bear", "veer", "veering"})
_SHARP = frozenset({"sharp", "sharply", "hard"})
_TURNING = frozenset(
    {
        *("turn", "turning", "take", "taking", "make", "making", "hang", "swing"),
        *("curve", "rotate", "turns", "pivot"),
    }
)
_GOING_THROUGH = frozenset(
    {"enter", "enters", "entering", "into", "in", "inside", "through", "thru", "take", "exit", "out"}
)
_STANDING = frozenset(
    {
        *("past", "pass", "passing", "by", "along", "with", "keep", "keeping", "see"),
        *("is", "are", "be", "have"),
    }
)
# What was said before these was done with something else.
_NEXT_ACTION = frozenset(
    {
        *("go", "walk", "head", "continue", "proceed", "move", "turn", "reach", "find", "face"),
        *("stop", "wait", "stand", "stopping", "then"),
    }
)
_COUNTS = frozenset({"few", "couple", "several", "one", "two", "three", "four", "five", "six"})
_GOING_OR_LEAVING = GOING | {"exit"}  # "exit left", as "go left"
_SIDES = frozenset({"left", "right"})
_OUTERMOST = frozenset({"leftmost", "rightmost"})
_ENDS = frozenset(".,;:!?")
_REACH = 4  # tokens before the word that are looked at
_REACH_OF_VERBS = 9  # the same, for what is done with something on one side


def phrase_of(tokens: Sequence[str], mention: Mention) -> int:
    """Which of the phrases above, from TURN to OTHER, the words around a direction make."""
    if mention.concept in _OUTERMOST:
        return OUTERMOST
    after = tuple(tokens[mention.start + mention.length :][:4])
    after = after[1:] if after[:1] == ("hand",) else after
    of_what = after[1:] if after[:1] == ("side",) else after
    if of_what[:1] == ("of",) and of_what[1:2] != ("you",):
        return SIDE_OF
    before: list[str] = []  # the nearest first
    for at in range(mention.start - 1, max(0, mention.start - _REACH) - 1, -1):
        if tokens[at] in _ENDS or tokens[at] in _SIDES:
            break
        is_animal = tokens[at] == "bear" and at > 0 and tokens[at - 1] in ("teddy", "a", "the")
        before.append("" if is_animal else tokens[at])
    for phrase, words in ((SLIGHT_TURN, _SLIGHT), (SHARP_TURN, _SHARP), (TURN, _TURNING)):
        if any(token in words for token in before):
            return phrase
    if before and before[0] in _GOING_OR_LEAVING:
        return TURN
    towards = "to" in before[:2]
    if (
        towards
        or any(token in ("on", "at", "from", "along") for token in before[:3])
        or after[:1] == ("side",)
    ):
        return _of_one_side(tokens, mention, TOWARDS if towards else BESIDE)
    return OTHER


def _of_one_side(tokens: Sequence[str], mention: Mention, otherwise: int) -> int:
    """THROUGH or STANDING by the nearest word before that tells, within what is said of the same action."""
    for at in range(mention.start - 1, max(0, mention.start - _REACH_OF_VERBS) - 1, -1):
        counted = at > 0 and (tokens[at - 1] in _COUNTS or tokens[at - 1].isdigit())
        if tokens[at] in _ENDS or tokens[at] in _NEXT_ACTION or (tokens[at] == "steps" and counted):
            break
        if tokens[at] in _STANDING or tuple(tokens[at : at + 2]) == ("in", "front"):
            return STANDING
        if tokens[at] in _GOING_THROUGH:
            return THROUGH
    return otherwise
