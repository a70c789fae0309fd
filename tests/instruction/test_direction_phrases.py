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
        ("proceed left", TURN),
        ("walk right past the couch", TURN),
        ("take two steps to the left", TOWARDS),
        ("take the stairs going up on your left", THROUGH),
        ("take 12 steps to the left", TOWARDS),
        ("take the steps to the left", THROUGH),
        ("wait in front of the door on the left", STANDING),
        ("exit the front door on the left", THROUGH),
        ("enter and stop at the table on your left", BESIDE),
        ("enter and walk to the door on the left", BESIDE),
        ("walk into the room on the left", THROUGH),
        ("stand on the left hand side of the bed", SIDE_OF),
        ("the couch on the left side of you", BESIDE),
        ("walk along the left side of the room", SIDE_OF),
    ],
)
def test_phrases(text: str, phrase: int) -> None:
    tokens = tokenized(text)
    sides = [m for m in find_mentions(tokens) if m.kind == "direction"]
    assert phrase_of(tokens, sides[-1]) == phrase


@pytest.mark.parametrize(
    "text",
    [
        "walk left past the couch",
        "go left down the hallway",
        "take two steps to the left",
        "enter the door on the left side",
        "keep to the left of the bed",
        "pass the couch on your left",
    ],
)
def test_the_mirrored_text_is_the_same_phrase(text: str) -> None:
    left, right = tokenized(text), tokenized(text.replace("left", "right"))
    assert phrase_of(left, find_mentions(left)[-1]) == phrase_of(right, find_mentions(right)[-1])
