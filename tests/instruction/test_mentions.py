"""Mentions are found where people mean a place, a thing or a direction, and nowhere else."""

import pytest

from robustnav_nodes.instruction.concepts import OPPOSITES, pair_of
from robustnav_nodes.instruction.mentions import concepts_of_name, find_mentions
from robustnav_nodes.instruction.tokens import tokenized


def found(text: str) -> list[tuple[str, str]]:
    return [(mention.kind, mention.concept) for mention in find_mentions(tokenized(text))]


def test_the_longest_form_is_taken() -> None:
    assert found("the washing machine in the laundry room") == [
        ("object", "washing machine"),
        ("room", "laundry room"),
    ]


@pytest.mark.parametrize("text", ["", "🙂", "turn around", "the way up", "back"])
def test_no_mention(text: str) -> None:
    assert found(text) == []


def test_up_after_a_verb_of_going() -> None:
    assert found("go up two steps") == [("direction", "up"), ("object", "stairs")]


def test_out_of_is_one_direction() -> None:
    mention = find_mentions(tokenized("walk out of it"))[0]
    assert (mention.start, mention.length, mention.concept) == (1, 2, "out of")


def test_opposites_are_mutual_and_share_their_pair() -> None:
    for one, other in OPPOSITES.items():
        assert OPPOSITES[other] == one
        assert pair_of(one) == pair_of(other)


def test_names_of_a_detector() -> None:
    assert concepts_of_name("dining_chair") == {"chair"}
    assert concepts_of_name("flux capacitor") == frozenset()
