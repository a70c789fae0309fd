"""The baseline that only reads."""

import math

import pytest

from robustnav_nodes.instruction.surprise import learn_surprise, surprise_from_arrays
from robustnav_nodes.instruction.trajectory import Trajectory

SAID = [("turn", "left", "at", "the", "couch", ".")] * 20 + [("go", "to", "the", "bed", ".")] * 20


def test_what_was_never_written_is_more_surprising() -> None:
    model = learn_surprise(SAID)
    usual = model.judge(Trajectory(), ("turn", "left", "at", "the", "couch", "."))
    odd = model.judge(Trajectory(), ("turn", "left", "at", "the", "piano", "."))
    assert odd.error_score > usual.error_score
    assert odd.doubts[0][0] == 4


def test_bits_are_those_of_interpolated_trigrams() -> None:
    """`b` after `a a`: alone (1 + 1) / (4 + 4), the end counted; of pairs 1/2; of triples none is kept."""
    model = learn_surprise([("a", "a", "b")])
    alone, pair = (1 + 1) / (4 + 4), 1 / 2
    assert model.bits(("a", "a", "b"))[2] == pytest.approx(-math.log2(0.15 * alone + 0.3 * pair))


def test_no_word_surprises_nobody() -> None:
    assert learn_surprise(SAID).judge(Trajectory(), ()).error_score == 0.0


def test_arrays_hold_it_whole() -> None:
    model = learn_surprise(SAID)
    assert surprise_from_arrays(model.arrays()) == model
    broken = model.arrays()
    broken["surprise/3"] = broken["surprise/3"][:, :2]
    with pytest.raises(ValueError, match="surprise/3"):
        surprise_from_arrays(broken)
