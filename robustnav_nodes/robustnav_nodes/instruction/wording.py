"""How well a word fits where it stands, by how people write: all that can be told without looking.

A small network over the neighbouring words and the other mentions tells which concept of its kind belongs
there. Naive Bayes of the neighbours, which are not independent, is far too sure: in people's directions of
homes left out the log loss of an object is 2.4 nats with it and 1.35 with the network.
"""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import CONCEPT_NUMBER, CONCEPTS, KINDS
from robustnav_nodes.instruction.mentions import Mention, find_mentions

_WORDS_AT = (-4, -3, -2, -1, 1, 2, 3, 4)  # tokens before and after a mention
_CONCEPTS_AT = (-2, -1, 1, 2)  # mentions before and after it
_FARTHER = 8  # more mentions, the nearest ones
_COUNTED_TO = 10  # places in the text, mentions before and after
_EDGE = "|"  # beside the first and the last token
_RARE = "?rare"
_AT_LEAST = 4  # a word that is written less often is taken for any rare word
_UNITS = 128
_TOKEN_DROPOUT, _UNIT_DROPOUT = 0.1, 0.5
_EPOCHS, _LEAST_STEPS = 12, 150
_RATE, _DECAY, _BATCH = 3e-3, 0.1, 512

KIND_OF_CONCEPT = np.array([KINDS.index(kind) for kind, _ in CONCEPTS])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Wording:
    """The network's weights: `words` are those known; `embedding` [inputs + 1, units] is summed up over what
    stands around a mention, its last row being zeros; `bias` [units]; `out` [units + 1, concepts].
    """

    words: dict[str, int]
    embedding: Float64
    bias: Float64
    out: Float64

    def log_fits(self, tokens: Sequence[str], mentions: Sequence[Mention]) -> Float64:
        """float64 [M, CONCEPTS]: log of how often each concept is written, among those of its kind, where a
        mention stands.
        """
        around = _Around(tokens, mentions, self.words)
        return self._fits([around.inputs(m) for m in range(len(mentions))])

    def log_fits_at(self, tokens: Sequence[str], mentions: Sequence[Mention], m: int) -> Float64:
        """float64 [CONCEPTS]: the same for mention `m` alone."""
        fits: Float64 = self._fits([_Around(tokens, mentions, self.words).inputs(m)])[0]
        return fits

    def _fits(self, inputs: list[list[int]]) -> Float64:
        if not inputs:
            return np.zeros((0, len(CONCEPTS)))
        units = np.maximum(self.embedding[np.array(inputs)].sum(axis=1) + self.bias, 0.0)
        logits: Float64 = units @ self.out[:-1] + self.out[-1]
        for kind in range(len(KINDS)):
            own = kind == KIND_OF_CONCEPT
            logits[:, own] -= np.logaddexp.reduce(logits[:, own], axis=1, keepdims=True)
        return logits


def wording_from_weights(words: Sequence[str], embedding: Float64, bias: Float64, out: Float64) -> Wording:
    """What `learn_wording` learned. Raises ValueError where its parts do not belong together."""
    if tuple(words[:2]) != (_RARE, _EDGE) or len(set(words)) != len(words):
        raise ValueError(f"the words of a wording begin with {_RARE!r} and {_EDGE!r}, and each comes once")
    found = embedding.shape, bias.shape, out.shape
    wanted = (_padding(len(words)) + 1, bias.size), (bias.size,), (bias.size + 1, len(CONCEPTS))
    if found != wanted or not all(np.isfinite(array).all() for array in (embedding, bias, out)):
        raise ValueError(f"the weights of a wording are {found}; they must be {wanted}, and finite")
    return Wording(words={word: k for k, word in enumerate(words)}, embedding=embedding, bias=bias, out=out)


def learn_wording(instructions: Iterable[Sequence[str]], *, seed: int = 0) -> Wording:
    """Learn from clean instructions; the same ones in the same order and the same seed, the same wording.

    Raises BadParameterError without torch, where there is anything to learn.
    """
    read = [tuple(tokens) for tokens in instructions]
    often = Counter(token for tokens in read for token in tokens)
    words = {_RARE: 0, _EDGE: 1}
    for word, times in sorted(often.items()):
        if times >= _AT_LEAST:
            words[word] = len(words)
    inputs, numbers = [], []
    for tokens in read:
        mentions = find_mentions(tokens)
        around = _Around(tokens, mentions, words)
        inputs += [around.inputs(m) for m in range(len(mentions))]
        numbers += around.numbers
    padding = _padding(len(words))
    if not numbers:
        return Wording(
            words=words,
            embedding=np.zeros((padding + 1, _UNITS)),
            bias=np.zeros(_UNITS),
            out=np.zeros((_UNITS + 1, len(CONCEPTS))),
        )
    embedding, bias, out = _fitted(np.array(inputs), np.array(numbers), padding, seed)
    return Wording(words=words, embedding=embedding, bias=bias, out=out)


def _fitted(
    inputs: NDArray[np.int64], numbers: NDArray[np.int64], padding: int, seed: int
) -> tuple[Float64, Float64, Float64]:
    try:
        import torch
    except ImportError as error:
        raise BadParameterError(
            "learning how people write needs torch: pip install 'robustnav[learn]'"
        ) from error
    from robustnav_nodes.instruction.small_network import teach

    torch.manual_seed(seed)
    around = torch.nn.EmbeddingBag(padding + 1, _UNITS, mode="sum", padding_idx=padding)
    with torch.no_grad():
        around.weight.normal_(std=0.1)
        around.weight[padding] = 0.0
    bias = torch.nn.Parameter(torch.zeros(_UNITS))
    dropout = torch.nn.Dropout(_UNIT_DROPOUT)
    answer = torch.nn.Linear(_UNITS, len(CONCEPTS))
    network = torch.nn.ModuleDict({"around": around, "answer": answer})
    network.register_parameter("bias", bias)
    x, y = torch.from_numpy(inputs), torch.from_numpy(numbers)
    kind = torch.from_numpy(KIND_OF_CONCEPT)
    other_kind = kind[y][:, None] != kind[None, :]

    def loss_of(some: torch.Tensor) -> torch.Tensor:
        seen = x[some]
        seen = torch.where(torch.rand(seen.shape) < _TOKEN_DROPOUT, padding, seen)
        logits = answer(dropout(torch.relu(around(seen) + bias)))
        return torch.nn.functional.cross_entropy(logits.masked_fill(other_kind[some], -np.inf), y[some])

    epochs = max(_EPOCHS, _LEAST_STEPS // -(-len(x) // _BATCH))
    teach(network, loss_of, len(x), rate=_RATE, decay=_DECAY, batch=_BATCH, epochs=epochs, seed=seed)
    weights = [w.detach().double().numpy() for w in (around.weight, bias, answer.weight, answer.bias)]
    return weights[0], weights[1], np.vstack([weights[2].T, weights[3]])


def _padding(words: int) -> int:
    """The row of the embedding that stays zero, for what is not there: the last one."""
    none = len(CONCEPTS) + 1
    return len(_WORDS_AT) * words + (len(_CONCEPTS_AT) + 1) * none + 3 * _COUNTED_TO


class _Around:
    """What stands around the mentions of one instruction, as numbers of rows of the embedding."""

    def __init__(self, tokens: Sequence[str], mentions: Sequence[Mention], words: dict[str, int]) -> None:
        self.numbers = [CONCEPT_NUMBER[m.kind, m.concept] for m in mentions]
        self._mentions = mentions
        self._known = [words.get(token, 0) for token in tokens]
        self._edge, self._words = words[_EDGE], len(words)

    def inputs(self, m: int) -> list[int]:
        """Of mention `m`; as many for each."""
        mention, count, none = self._mentions[m], len(self._mentions), len(CONCEPTS)
        last = mention.start + mention.length - 1
        found = []
        base = 0
        for offset in _WORDS_AT:
            at = mention.start + offset if offset < 0 else last + offset
            found.append(base + (self._known[at] if 0 <= at < len(self._known) else self._edge))
            base += self._words
        for offset in _CONCEPTS_AT:
            found.append(base + (self.numbers[m + offset] if 0 <= m + offset < count else none))
            base += none + 1
        for place in (_COUNTED_TO * mention.start // len(self._known), m, count - 1 - m):
            found.append(base + min(_COUNTED_TO - 1, place))
            base += _COUNTED_TO
        farther = [k for k in range(count) if abs(k - m) > max(_CONCEPTS_AT)]
        farther = sorted(farther, key=lambda k: abs(k - m))[:_FARTHER]
        found += [base + self.numbers[k] for k in farther]
        return found + [_padding(self._words)] * (_FARTHER - len(farther))
