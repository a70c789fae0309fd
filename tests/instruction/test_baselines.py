"""What is looked up among what was seen, and what cannot be."""

import pytest

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.instruction.baselines import EntityGrounding
from robustnav_nodes.instruction.concepts import pair_of
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import Trajectory


@pytest.mark.parametrize(
    ("said", "score", "doubted"),
    [
        ("leave the bedroom past the bed", 0.0, ()),
        ("leave the bedroom past the piano", 0.5, ("piano",)),
        ("go through the door of the closet", 0.0, ()),
        ("go through the door into the office", 1.0, ("office",)),
    ],
)
def test_what_was_never_seen_is_doubted(
    walk: Trajectory, said: str, score: float, doubted: tuple[str, ...]
) -> None:
    """Closets and doors, which no trajectory can be relied on to name, are neither found nor missed."""
    tokens = tokenized(said)
    verdict = EntityGrounding().judge(walk, tokens)
    assert verdict.error_score == score
    assert tuple(tokens[at] for at, _ in verdict.doubts) == doubted


def test_a_word_that_is_no_direction_has_no_pair() -> None:
    assert pair_of("rightmost") == "leftmost/rightmost"
    with pytest.raises(BadParameterError, match="'port' is no direction"):
        pair_of("port")
