"""How well a word fits between its neighbours, by how people write: all that can be told without looking."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import CONCEPT_NUMBER, CONCEPTS
from robustnav_nodes.instruction.mentions import Mention, find_mentions

_OFFSETS = (-3, -2, -1, 1, 2, 3)
_EDGE = "|"  # beside the first and the last token
_RARE = "?rare"
_PRIOR = 4.0  # observations that a neighbour's overall share counts for
_AT_LEAST = 4  # a word that is written less often is taken for any rare word


@dataclass(frozen=True, slots=True, kw_only=True)
class Wording:
    """Naive Bayes of a concept's neighbours.

    `words` are those known; `base` [concepts] the logarithm of how often each concept is written; `beside`
    [words, offsets, concepts] that of a neighbour given the concept.
    """

    words: dict[str, int]
    base: Float64
    beside: Float64

    def log_fits(self, tokens: Sequence[str], mention: Mention) -> Float64:
        """Logarithm, up to a constant, of how often each of CONCEPTS is written where `mention` stands."""
        fits = self.base.copy()
        for k, offset in enumerate(_OFFSETS):
            word = _neighbour(tokens, mention, offset)
            fits += self.beside[self.words.get(word, 0), k]
        return fits

    def gain(self, tokens: Sequence[str], mention: Mention, concept: str) -> float:
        """How much better another concept of the same kind fits: log(fit(new) / fit(old))."""
        fits = self.log_fits(tokens, mention)
        kind = mention.kind
        return float(fits[CONCEPT_NUMBER[kind, concept]] - fits[CONCEPT_NUMBER[kind, mention.concept]])


def learn_wording(instructions: Iterable[Sequence[str]]) -> Wording:
    """Count the neighbours of each concept in clean instructions."""
    read = [tuple(tokens) for tokens in instructions]
    often = Counter(token for tokens in read for token in tokens)
    words = {_RARE: 0, _EDGE: 1}
    for word, times in sorted(often.items()):
        if times >= _AT_LEAST:
            words[word] = len(words)
    anywhere = np.full(len(words), 1.0)
    for word, times in often.items():
        anywhere[words.get(word, 0)] += times
    share = anywhere / anywhere.sum()
    count = np.zeros(len(CONCEPTS))
    beside = np.zeros((len(words), len(_OFFSETS), len(CONCEPTS)))
    for tokens in read:
        for mention in find_mentions(tokens):
            number = CONCEPT_NUMBER[mention.kind, mention.concept]
            count[number] += 1.0
            for k, offset in enumerate(_OFFSETS):
                beside[words.get(_neighbour(tokens, mention, offset), 0), k, number] += 1.0
    log_beside = np.log((beside + _PRIOR * share[:, None, None]) / (count + _PRIOR))
    return Wording(words=words, base=np.log(count + 0.1), beside=log_beside.astype(np.float32).astype(float))


def _neighbour(tokens: Sequence[str], mention: Mention, offset: int) -> str:
    at = mention.start + offset if offset < 0 else mention.start + mention.length - 1 + offset
    return tokens[at] if 0 <= at < len(tokens) else _EDGE
