"""How a direction is said: "turn left" speaks of a turn, "on your left" of where something stands."""

from collections.abc import Sequence

from robustnav_nodes.instruction.mentions import Mention

TURN, TOWARDS, BESIDE, OTHER = range(4)
PHRASES = 4

_TURNING = frozenset(
    {
        *("turn", "turning", "take", "taking", "make", "making", "bear", "veer", "hang", "swing", "slight"),
        *("slightly", "sharp", "sharply", "hard", "curve", "rotate", "veering", "turns", "pivot"),
    }
)
_ENDS = frozenset(".,;:!?")
_REACH = 4  # tokens before the word that are looked at


def phrase_of(tokens: Sequence[str], mention: Mention) -> int:
    """Which of TURN, TOWARDS, BESIDE and OTHER the phrase around a direction is."""
    before: list[str] = []
    for token in reversed(tokens[max(0, mention.start - _REACH) : mention.start]):
        if token in _ENDS:
            break
        before.append(token)
    if any(token in _TURNING for token in before):
        return TURN
    after = tokens[mention.start + mention.length : mention.start + mention.length + 1]
    if "to" in before[:2]:
        return TOWARDS
    if any(token in ("on", "at", "from", "along") for token in before[:3]) or tuple(after) == ("side",):
        return BESIDE
    return OTHER
