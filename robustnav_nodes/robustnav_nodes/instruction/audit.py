"""Which instructions of a data set are likely wrong, and at which words (the thesis' use on R2R-CE)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.verdict import ErrorModel


@dataclass(frozen=True, slots=True, kw_only=True)
class Suspicion:
    """An instruction with its error score and its most doubtful words: (first token, tokens)."""

    key: str
    home: str
    error_score: float
    tokens: tuple[str, ...]
    words: tuple[int, int] | None

    @property
    def marked(self) -> str:
        """The instruction as one line, with the doubtful words in brackets."""
        if self.words is None:
            return " ".join(self.tokens)
        start, end = self.words[0], sum(self.words)
        doubtful = f"[{' '.join(self.tokens[start:end])}]"
        return " ".join([*self.tokens[:start], doubtful, *self.tokens[end:]])


def audit(
    instructions: Sequence[Instruction], model: ErrorModel, advance: Callable[[], None] = lambda: None
) -> list[Suspicion]:
    """Every instruction, the most likely wrong one first."""
    found = []
    for one in instructions:
        verdict = model.judge(one.trajectory, one.tokens)
        found.append(
            Suspicion(
                key=one.key,
                home=one.group,
                error_score=verdict.error_score,
                tokens=one.tokens,
                words=_words(one.tokens, verdict.doubts[0][0]) if verdict.doubts else None,
            )
        )
        advance()
    return sorted(found, key=lambda suspicion: -suspicion.error_score)


def _words(tokens: Sequence[str], token: int) -> tuple[int, int]:
    """The whole mention that a token begins."""
    for mention in find_mentions(tokens):
        if mention.start <= token < mention.start + mention.length:
            return mention.start, mention.length
    return token, 1
