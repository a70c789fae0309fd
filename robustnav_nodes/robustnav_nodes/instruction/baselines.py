"""What has to be beaten: chance, looking words up among what was seen, and what is surprising to read."""

import math
from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from robustnav_nodes.instruction.concepts import DIRECTION, OBJECT, ROOM_TYPES_OF
from robustnav_nodes.instruction.mentions import concepts_of_name, find_mentions
from robustnav_nodes.instruction.trajectory import ROOM_TYPES, Trajectory
from robustnav_nodes.instruction.verdict import Verdict


class RandomGuess:
    """The thesis' random baseline: any score, any token; the seed and the words decide."""

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        del trajectory
        letters = [ord(letter) for letter in " ".join(tokens)]
        rng = np.random.default_rng([self._seed, *letters])
        order = rng.permutation(len(tokens))
        return Verdict(error_score=float(rng.uniform()), doubts=tuple((int(k), 0.0) for k in order))


class EntityGrounding:
    """A room or object that was said and never seen is wrong: the thesis' CLIP alignment, by names.

    A room counts as seen where the evidence for its type once exceeded `ROOM_SEEN`. The score is the share of
    what was said that was not seen.
    """

    ROOM_SEEN = 0.25

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        seen = {c for at in trajectory.viewpoints for one in at.objects for c in concepts_of_name(one.name)}
        rooms = [
            max((at.rooms[k] for at in trajectory.viewpoints), default=0.0) for k in range(len(ROOM_TYPES))
        ]
        said = [mention for mention in find_mentions(tokens) if mention.kind != DIRECTION]
        missed = []
        for mention in said:
            if mention.kind == OBJECT:
                found = mention.concept in seen
            else:
                types = ROOM_TYPES_OF.get(mention.concept, ())
                found = any(rooms[ROOM_TYPES.index(name)] >= self.ROOM_SEEN for name in types)
            if not found:
                missed.append(mention)
        return Verdict(
            error_score=len(missed) / len(said) if said else 0.0,
            doubts=tuple((mention.start, 1.0) for mention in missed),
        )


class Surprise:
    """How unlikely each word is after the two before it; learned from clean instructions, blind for the walk.

    Interpolated trigrams (Jelinek and Mercer 1980). The score is the surprise of the most surprising mention.
    """

    _SHARES = (0.55, 0.3, 0.15)

    def __init__(self, instructions: Iterable[Sequence[str]]) -> None:
        self._counts: tuple[Counter[tuple[str, ...]], ...] = (Counter(), Counter(), Counter())
        self._starts: tuple[Counter[tuple[str, ...]], ...] = (Counter(), Counter(), Counter())
        for tokens in instructions:
            padded = ("|", "|", *tokens, "|")
            for at in range(2, len(padded)):
                for order in range(3):
                    start = padded[at - order : at]
                    self._starts[order][start] += 1
                    self._counts[order][(*start, padded[at])] += 1
        self._words = len(self._counts[0]) + 1

    def bits(self, tokens: Sequence[str]) -> list[float]:
        """Of each token, and of the end."""
        padded = ("|", "|", *tokens, "|")
        return [
            -math.log2(sum(self._SHARES[2 - order] * self._share(padded, at, order) for order in range(3)))
            for at in range(2, len(padded))
        ]

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        del trajectory
        bits = self.bits(tokens)
        mentions = find_mentions(tokens)
        doubts = sorted(
            ((m.start, max(bits[m.start : m.start + m.length + 1])) for m in mentions), key=lambda d: -d[1]
        )
        worst = doubts[0][1] if doubts else 0.0
        return Verdict(error_score=1.0 - 2.0 ** (-worst / 8.0), doubts=tuple(doubts))

    def _share(self, padded: tuple[str, ...], at: int, order: int) -> float:
        start = padded[at - order : at]
        count = self._counts[order][(*start, padded[at])]
        if order == 0:
            return (count + 1.0) / (self._starts[0][()] + self._words)
        return count / max(1, self._starts[order][start])
