"""The audit of a data set: the worst first, with the words that are doubted."""

from collections.abc import Sequence

from robustnav_nodes.instruction.audit import audit
from robustnav_nodes.instruction.trajectory import Trajectory
from robustnav_nodes.instruction.verdict import Verdict
from tests.instruction.small_world import said_walks


class DoubtsPianos:
    """Finds pianos suspicious, at their word."""

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        del trajectory
        if "piano" not in tokens:
            return Verdict(error_score=0.1)
        return Verdict(error_score=0.9, doubts=((list(tokens).index("piano"), 0.9),))


def test_the_worst_come_first_with_the_doubted_words_marked() -> None:
    said = said_walks(homes=2, walks=4, seed=1)
    found = audit(said, DoubtsPianos())
    pianos = sum("piano" in one.tokens for one in said)
    assert len(found) == len(said)
    assert 0 < pianos < len(said)
    assert all("[piano]" in one.marked for one in found[:pianos])
    assert all(one.error_score == 0.1 and "[" not in one.marked for one in found[pianos:])


def test_nothing_to_audit() -> None:
    assert audit([], DoubtsPianos()) == []
