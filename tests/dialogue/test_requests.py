"""What people type is read as what they ask for; what cannot be read gets an answer, never an error."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_nodes.dialogue.class_names import listed, matching_class
from robustnav_nodes.dialogue.requests import RequestKind, UnreadableLineError, read_line


@pytest.mark.parametrize(
    ("line", "thing"),
    [
        ("find the mug", "mug"),
        ("Find the MUG!", "mug"),
        ("please find my blue mug", "blue mug"),
        ("could you find me a coffee cup, please?", "coffee cup"),
        ("can you please look for the plant", "plant"),
        ("I'm looking for my laptop", "laptop"),
        ("I need the book now", "book"),
        ("where is the remote?", "remote"),
        ("where are my books", "books"),
        ("robot, search for a bottle", "bottle"),
        ("no, find the book", "book"),
        ("  find\tthe  mug ", "mug"),
    ],
)
def test_requests_to_find(line: str, thing: str) -> None:
    request = read_line(line, 500)
    assert (request.kind, request.thing) == (RequestKind.FIND, thing)


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        ("stop", RequestKind.STOP),
        ("Stop!", RequestKind.STOP),
        ("please stop looking for it", RequestKind.STOP),
        ("never mind", RequestKind.STOP),
        ("where are you?", RequestKind.WHERE),
        ("why?", RequestKind.WHY),
        ("why did you turn left", RequestKind.WHY),
        ("what are you doing?", RequestKind.WHY),
        ("thanks!", RequestKind.THANKS),
        ("thank you", RequestKind.THANKS),
        ("no", RequestKind.WRONG),
        ("no, that is not it", RequestKind.WRONG),
        ("That isn't my mug!", RequestKind.WRONG),
        ("wrong one", RequestKind.WRONG),
        ("yes!", RequestKind.RIGHT),
        ("yes, that's it", RequestKind.RIGHT),
        ("that is the one", RequestKind.RIGHT),
        ("hello", RequestKind.GREETING),
        ("what can you find?", RequestKind.HELP),
        ("the weather is nice", RequestKind.UNKNOWN),
        ("找到杯子", RequestKind.UNKNOWN),
        ("найди кружку", RequestKind.UNKNOWN),
        ("'; DROP TABLE objects; --", RequestKind.UNKNOWN),
    ],
)
def test_other_requests(line: str, kind: RequestKind) -> None:
    assert read_line(line, 500).kind is kind


@pytest.mark.parametrize("line", ["", "   ", "?!", "\x00\x01\x02\x7f", "\n\n"])
def test_a_line_without_words_is_answered(line: str) -> None:
    with pytest.raises(UnreadableLineError, match="find the mug"):
        read_line(line, 500)


def test_a_long_line_is_answered_with_its_length() -> None:
    with pytest.raises(UnreadableLineError, match="1,000,000 characters"):
        read_line("a" * 1_000_000, 500)


@given(line=st.text(max_size=300))
def test_any_text_is_read_or_answered(line: str) -> None:
    with suppress(UnreadableLineError):
        assert read_line(line, 200).kind in RequestKind


NAMES = ("cup", "coffee cup", "mug", "glass", "box", "berry")


@pytest.mark.parametrize(
    ("thing", "name"),
    [
        ("mug", "mug"), ("blue mugs", "mug"), ("coffee cups", "coffee cup"), ("cup of tea", "cup"),
        ("glasses", "glass"), ("boxes", "box"), ("berries", "berry"), ("mugger", None),
        ("", None), ("unicorn", None),
    ],
)  # fmt: skip
def test_class_names_are_matched_by_whole_words(thing: str, name: str | None) -> None:
    assert matching_class(thing, NAMES) == name


def test_long_lists_are_shortened() -> None:
    assert listed(("b", "a"), 5) == "a, b"
    assert listed(("b", "a", "c"), 2) == "a, b and 1 more"
