"""What the wording expects where a mention stands."""

import numpy as np
import pytest

from robustnav_nodes.instruction.concepts import CONCEPT_NUMBER, CONCEPTS, OBJECT, ROOM
from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.wording import KIND_OF_CONCEPT, Wording, learn_wording, wording_from_weights

USUAL = [
    *[tokenized("walk out of the kitchen and stop by the refrigerator")] * 60,
    *[tokenized("walk out of the bedroom and stop by the bed")] * 60,
]


@pytest.fixture(scope="module")
def wording() -> Wording:
    return learn_wording(USUAL)


def test_shares_of_a_kind_sum_to_one(wording: Wording) -> None:
    tokens = tokenized("go left past a couch into the kitchen")
    fits = np.exp(wording.log_fits(tokens, find_mentions(tokens)))
    assert fits.shape == (4, len(CONCEPTS))
    for kind in range(3):
        assert fits[:, kind == KIND_OF_CONCEPT].sum(axis=1) == pytest.approx(1.0)


def test_what_is_said_beside_it_decides(wording: Wording) -> None:
    for room, thing in (("kitchen", "refrigerator"), ("bedroom", "bed")):
        tokens = tokenized(f"walk out of the {room} and stop by the {thing}")
        mentions = find_mentions(tokens)
        fits = np.exp(wording.log_fits(tokens, mentions))
        own = fits[np.arange(len(mentions)), [CONCEPT_NUMBER[m.kind, m.concept] for m in mentions]]
        assert own.min() > 0.8
    tokens = tokenized("walk out of the kitchen and stop by the bed")
    strange = np.exp(wording.log_fits(tokens, find_mentions(tokens)))
    assert strange[1, CONCEPT_NUMBER[ROOM, "kitchen"]] < 0.8
    assert strange[2, CONCEPT_NUMBER[OBJECT, "bed"]] < 0.8


def test_the_same_instructions_make_the_same_wording(wording: Wording) -> None:
    again = learn_wording(USUAL)
    assert np.array_equal(again.out, wording.out)
    assert np.array_equal(again.embedding, wording.embedding)


@pytest.mark.parametrize("text", ["", "🙂", "налево", "left " * 300, "kitchen"])
def test_any_text_can_be_asked(wording: Wording, text: str) -> None:
    tokens = tokenized(text)
    mentions = find_mentions(tokens)
    assert wording.log_fits(tokens, mentions).shape == (len(mentions), len(CONCEPTS))


def test_of_nothing_read_nothing_is_expected() -> None:
    nothing = learn_wording([])
    tokens = tokenized("go left")
    fits = nothing.log_fits(tokens, find_mentions(tokens))
    assert np.ptp(fits[0, KIND_OF_CONCEPT[0] == KIND_OF_CONCEPT]) == pytest.approx(0.0)


def test_one_mention_alone_is_told_the_same(wording: Wording) -> None:
    tokens = tokenized("go left past a couch into the kitchen")
    mentions = find_mentions(tokens)
    for m, fits in enumerate(wording.log_fits(tokens, mentions)):
        assert wording.log_fits_at(tokens, mentions, m) == pytest.approx(fits)


def test_weights_make_the_same_wording_again(wording: Wording) -> None:
    words = tuple(wording.words)
    again = wording_from_weights(words, wording.embedding, wording.bias, wording.out)
    tokens = tokenized("go left past a couch into the kitchen")
    mentions = find_mentions(tokens)
    assert np.array_equal(again.log_fits(tokens, mentions), wording.log_fits(tokens, mentions))
    for spoilt in (
        (words[1:], wording.embedding, wording.bias, wording.out),
        ((*words[:-1], words[0]), wording.embedding, wording.bias, wording.out),
        (words, wording.embedding[1:], wording.bias, wording.out),
        (words, wording.embedding, wording.bias[None], wording.out),
        (words, wording.embedding, wording.bias, wording.out * np.nan),
    ):
        with pytest.raises(ValueError, match="wording"):
            wording_from_weights(*spoilt)
