"""What is said around a direction tells a turn from a place."""

import pytest

from robustnav_nodes.instruction.direction_phrases import (
    BESIDE,
    OTHER,
    OUTERMOST,
    SHARP_TURN,
    SIDE_OF,
    SLIGHT_TURN,
    STANDING,
    THROUGH,
    TOWARDS,
    TURN,
    phrase_of,
)
from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.tokens import tokenized


@pytest.mark.parametrize(
    ("text", "phrase"),
    [
        ("turn left at the couch", TURN),
        ("take a right", TURN),
        ("take a slight right", SLIGHT_TURN),
        ("veer left", SLIGHT_TURN),
        ("turn sharply to the left", SHARP_TURN),
        ("bear left then turn right", TURN),
        ("make a slight left then sharp right", SHARP_TURN),
        ("keep the teddy bear on your left", STANDING),
        ("take the leftmost door", OUTERMOST),
        ("go left", TURN),
        ("go to the left", TOWARDS),
        ("wait . a little to the left is the bed", TOWARDS),
        ("go to the left of the table", SIDE_OF),
        ("wait by the right side of the bed", SIDE_OF),
        ("the couch to the left of you", TOWARDS),
        ("stop at the couch on your right", BESIDE),
        ("pass the couch on your right", STANDING),
        ("the sink is on the left", STANDING),
        ("enter the room on your right", THROUGH),
        ("go past the couch into the room to the left", THROUGH),
        ("enter the room . stop at the bed to the left", TOWARDS),
        ("stop at the couch right side", BESIDE),
        ("make a turn . left is the couch", OTHER),
        ("left", OTHER),
    ],
)
def test_phrases(text: str, phrase: int) -> None:
    tokens = tokenized(text)
    sides = [m for m in find_mentions(tokens) if m.kind == "direction"]
    assert phrase_of(tokens, sides[-1]) == phrase
