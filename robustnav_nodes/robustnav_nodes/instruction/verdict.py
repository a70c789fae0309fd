"""What a model says of an instruction: how likely it is wrong, and where."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol as TypingProtocol

from robustnav_nodes.instruction.trajectory import Trajectory


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """`error_score` 0..1 is high when the instruction is wrong (C9); `doubts` its tokens, worst first.

    Each doubt is (token, score); scores compare within one verdict only. An instruction in which nothing can
    be wrong has none.
    """

    error_score: float
    doubts: tuple[tuple[int, float], ...] = ()

    def places(self, count: int, tokens: int) -> tuple[int, ...]:
        """`count` tokens that are the most doubtful, in their order; the middle where no doubt is left."""
        found = [token for token, _ in self.doubts[:count]]
        found += [tokens // 2] * (count - len(found))
        return tuple(sorted(found))


class ErrorModel(TypingProtocol):
    """Anything that judges an instruction by the walk it was followed on."""

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        """Of a whole or an unfinished walk."""
