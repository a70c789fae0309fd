"""A baseline that only reads: how unlikely each word is after the two before it.

Interpolated trigrams (Jelinek and Mercer 1980), learned from clean instructions.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.trajectory import Trajectory
from robustnav_nodes.instruction.verdict import Verdict

Gram = tuple[int, ...]
_ORDERS = (1, 2, 3)
_SHARES = (0.15, 0.3, 0.55)  # of words alone, pairs and triples
_RARE, _EDGE = 0, 1
_AT_LEAST = {1: 1, 2: 1, 3: 2}  # triples that were written once are forgotten: they fill most of the file
_BITS_OF_HALF = 8.0  # a word of so many bits makes a score of 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Surprise:
    """`words` numbers the words, from 2; `counts` how often each stretch of 1 to 3 of them was written."""

    words: Mapping[str, int]
    counts: Mapping[Gram, int]

    def bits(self, tokens: Sequence[str]) -> list[float]:
        """Of each token, and of the end."""
        said = [_EDGE, _EDGE, *(self.words.get(token, _RARE) for token in tokens), _EDGE]
        return [
            -math.log2(
                sum(
                    share * self._share(tuple(said[at - order + 1 : at + 1]))
                    for order, share in zip(_ORDERS, _SHARES, strict=True)
                )
            )
            for at in range(2, len(said))
        ]

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        """An ErrorModel's: the score is that of the most surprising mention."""
        del trajectory
        bits = self.bits(tokens)
        doubts = sorted(
            ((m.start, max(bits[m.start : m.start + m.length + 1])) for m in find_mentions(tokens)),
            key=lambda doubt: -doubt[1],
        )
        worst = doubts[0][1] if doubts else 0.0
        return Verdict(error_score=1.0 - 2.0 ** (-worst / _BITS_OF_HALF), doubts=tuple(doubts))

    def arrays(self) -> dict[str, NDArray[Any]]:
        """For np.savez: the words in their order, and by length the stretches with their counts."""
        arrays: dict[str, NDArray[Any]] = {
            "surprise/words": np.array(sorted(self.words, key=self.words.__getitem__))
        }
        for order in _ORDERS:
            grams = sorted(gram for gram in self.counts if len(gram) == order)
            rows = [(*gram, self.counts[gram]) for gram in grams]
            arrays[f"surprise/{order}"] = np.array(rows, dtype=np.int32).reshape(len(rows), order + 1)
        return arrays

    def _share(self, gram: Gram) -> float:
        count = self.counts.get(gram, 0)
        if len(gram) == 1:
            return (count + 1.0) / (self.counts.get((), 0) + len(self.words) + 2.0)
        return count / max(1, self.counts.get(gram[:-1], 0))


def learn_surprise(instructions: Iterable[Sequence[str]]) -> Surprise:
    """Count stretches of words in clean instructions."""
    read = [tuple(tokens) for tokens in instructions]
    words = {word: 2 + k for k, word in enumerate(sorted({token for tokens in read for token in tokens}))}
    counts: Counter[Gram] = Counter()
    for tokens in read:
        said = [_EDGE, _EDGE, *(words[token] for token in tokens), _EDGE]
        for at in range(2, len(said)):
            for order in _ORDERS:
                counts[tuple(said[at - order + 1 : at + 1])] += 1
    return _with_all(words, {gram: n for gram, n in counts.items() if n >= _AT_LEAST[len(gram)]})


def surprise_from_arrays(arrays: Mapping[str, NDArray[Any]]) -> Surprise:
    """What `arrays` wrote. Raises KeyError where something is missing, ValueError for another shape."""
    counts: dict[Gram, int] = {}
    for order in _ORDERS:
        rows = arrays[f"surprise/{order}"]
        if rows.ndim != 2 or rows.shape[1] != order + 1:
            raise ValueError(f"surprise/{order} is {rows.shape}")
        counts.update({tuple(row[:-1]): int(row[-1]) for row in rows.tolist()})
    return _with_all({str(word): 2 + k for k, word in enumerate(arrays["surprise/words"])}, counts)


def _with_all(words: Mapping[str, int], counts: dict[Gram, int]) -> Surprise:
    """The starts of sentences are counted nowhere else, nor how many words there are in all."""
    single = {gram: n for gram, n in counts.items() if len(gram) == 1}
    starts: dict[Gram, int] = {(_EDGE, _EDGE): single.get((_EDGE,), 0)}
    return Surprise(words=words, counts={**counts, **starts, (): sum(single.values())})
