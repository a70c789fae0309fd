"""How well a word fits between its neighbours, by how people write: all that can be told without looking."""

import math
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence

from robustnav_nodes.instruction.mentions import Mention, find_mentions

_OFFSETS = (-2, -1, 1, 2)
_EDGE = "|"  # beside the first and the last token
_PRIOR = 4.0  # observations that a neighbour's overall share counts for


class Wording:
    """Neighbours of each concept in clean instructions; read only once made."""

    def __init__(self, instructions: Iterable[Sequence[str]]) -> None:
        self._count: Counter[str] = Counter()
        self._beside: defaultdict[tuple[str, int], Counter[str]] = defaultdict(Counter)
        self._anywhere: Counter[str] = Counter()
        for tokens in instructions:
            self._anywhere.update(tokens)
            for mention in find_mentions(tokens):
                self._count[mention.concept] += 1
                for offset in _OFFSETS:
                    self._beside[mention.concept, offset][_neighbour(tokens, mention, offset)] += 1
        self._tokens = sum(self._anywhere.values()) + 1

    def log_fit(self, tokens: Sequence[str], mention: Mention, concept: str) -> float:
        """Logarithm, up to a constant, of how often `concept` is written where `mention` stands."""
        count = self._count[concept]
        fit = math.log(count + 0.1)
        for offset in _OFFSETS:
            word = _neighbour(tokens, mention, offset)
            share = (self._anywhere[word] + 1) / self._tokens
            beside = self._beside.get((concept, offset))
            fit += math.log(((beside[word] if beside else 0) + _PRIOR * share) / (count + _PRIOR))
        return fit


def _neighbour(tokens: Sequence[str], mention: Mention, offset: int) -> str:
    at = mention.start + offset if offset < 0 else mention.start + mention.length - 1 + offset
    return tokens[at] if 0 <= at < len(tokens) else _EDGE
