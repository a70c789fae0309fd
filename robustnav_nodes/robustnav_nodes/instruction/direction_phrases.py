"""How a direction is said: "turn left" speaks of a turn, "on your left" of where something stands."""

from collections.abc import Sequence

from robustnav_nodes.instruction.mentions import Mention

TURN, SLIGHT_TURN, SHARP_TURN, TOWARDS, BESIDE, OUTERMOST, OTHER = range(7)
PHRASES = 7
TURNS = frozenset({TURN, SLIGHT_TURN, SHARP_TURN})

_SLIGHT = frozenset({"slight", "slightly", "bear", "veer", "veering"})
_SHARP = frozenset({"sharp", "sharply", "hard"})
_TURNING = frozenset(
    {
        *("turn", "turning", "take", "taking", "make", "making", "hang", "swing"),
        *("curve", "rotate", "turns", "pivot"),
    }
)
_SIDES = frozenset({"left", "right"})
_OUTERMOST = frozenset({"leftmost", "rightmost"})
_ENDS = frozenset(".,;:!?")
_REACH = 4  # tokens before the word that are looked at


def phrase_of(tokens: Sequence[str], mention: Mention) -> int:
    """Which of the phrases above, from TURN to OTHER, the words around a direction make."""
    if mention.concept in _OUTERMOST:
        return OUTERMOST
    before: list[str] = []  # the nearest first
    for at in range(mention.start - 1, max(0, mention.start - _REACH) - 1, -1):
        if tokens[at] in _ENDS or tokens[at] in _SIDES:
            break
        is_animal = tokens[at] == "bear" and at > 0 and tokens[at - 1] in ("teddy", "a", "the")
        before.append("" if is_animal else tokens[at])
    for phrase, words in ((SLIGHT_TURN, _SLIGHT), (SHARP_TURN, _SHARP), (TURN, _TURNING)):
        if any(token in words for token in before):
            return phrase
    after = tokens[mention.start + mention.length : mention.start + mention.length + 1]
    if "to" in before[:2]:
        return TOWARDS
    if any(token in ("on", "at", "from", "along") for token in before[:3]) or tuple(after) == ("side",):
        return BESIDE
    return OTHER
