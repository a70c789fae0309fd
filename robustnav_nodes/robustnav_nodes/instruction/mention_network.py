"""A transformer over the mentions of one instruction; asked with numpy alone.

Trees judge each mention by its own row. This sees the rows of all of them: what the room before was, whether
the others fit where this one does not.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Float64

LAYERS = 2
HEADS = 4
CATEGORIES = ("concept", "concept_before", "concept_after", "before", "before2", "after", "phrase")
_SCALES = ("low", "high", "mean", "scale")
_POSITIONS = ("numbers", "missing", "categories")
_LEAST_SCALE = 1e-3
_OFTEN_MISSING = 1e-3  # columns that are NaN less often need no flag
_TAIL = 0.5  # per cent of each side that is clipped

Float32 = NDArray[np.float32]


@dataclass(frozen=True, slots=True, kw_only=True)
class NetworkSettings:
    """Size and training; chosen on homes that were left out of training."""

    width: int = 96
    dropout: float = 0.15
    epochs: int = 5
    batch: int = 256  # instructions
    learning_rate: float = 1.5e-3
    weight_decay: float = 0.02


@dataclass(frozen=True, slots=True, kw_only=True)
class RowScale:
    """What makes inputs of rows: K numbers of about unit size, N flags of what is missing, C categories.

    `numbers` [K] and `categories` [C] are columns of the rows, `missing` [N] places among the numbers; the
    others float32 [K].
    """

    numbers: NDArray[np.int64]
    missing: NDArray[np.int64]
    categories: NDArray[np.int64]
    low: Float32
    high: Float32
    mean: Float32
    scale: Float32

    def inputs(self, rows: Float32) -> tuple[Float32, NDArray[np.int64]]:
        """float32 [..., K + N] and int64 [..., C] from 0 of rows [..., features]."""
        numbers = rows[..., self.numbers]
        absent = np.isnan(numbers)
        numbers = (np.clip(numbers, self.low, self.high) - self.mean) / self.scale
        numbers[absent] = 0.0
        flags = absent[..., self.missing].astype(np.float32)
        categories = rows[..., self.categories].astype(np.int64) + 1  # -1: there is none
        return np.concatenate([numbers, flags], axis=-1), categories


def row_scale(rows: Float32, names: Sequence[str]) -> RowScale:
    """Of rows [n, features] to learn from; `names` are those of the features."""
    categories = [names.index(name) for name in CATEGORIES]
    numbers = [k for k in range(len(names)) if k not in categories]
    x = rows[:, numbers].copy()
    absent = np.isnan(x)
    x[:, absent.all(axis=0)] = 0.0
    low, high = np.nanpercentile(x, [_TAIL, 100.0 - _TAIL], axis=0).astype(np.float32)
    x = np.clip(x, low, high)
    return RowScale(
        numbers=np.array(numbers),
        missing=np.flatnonzero(absent.mean(axis=0) > _OFTEN_MISSING),
        categories=np.array(categories),
        low=low,
        high=high,
        mean=np.nanmean(x, axis=0),
        scale=np.nanstd(x, axis=0) + np.float32(_LEAST_SCALE),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class MentionNetwork:
    """The scale of its inputs, and its weights by the names they have in torch."""

    scale: RowScale
    weights: Mapping[str, Float32]

    def log_odds(self, rows: Float32) -> Float64:
        """float64 [M] that each mention is wrong, of the rows [M, features] of one instruction."""
        numbers, categories = self.scale.inputs(rows)
        x = self._linear("numbers", numbers)
        for k in range(categories.shape[1]):
            table = self.weights[f"tables.{k}.weight"]
            x = x + table[np.minimum(categories[:, k], len(table) - 1)]
        for k in range(LAYERS):
            layer = f"layers.layers.{k}"
            x = x + self._attention(f"{layer}.self_attn", self._norm(f"{layer}.norm1", x))
            inner = np.maximum(self._linear(f"{layer}.linear1", self._norm(f"{layer}.norm2", x)), 0.0)
            x = x + self._linear(f"{layer}.linear2", inner)
        x = np.maximum(self._linear("inner", self._norm("norm", x)), 0.0)
        return self._linear("out", x)[:, 0].astype(np.float64)

    def _linear(self, name: str, x: Float32) -> Float32:
        return x @ self.weights[f"{name}.weight"].T + self.weights[f"{name}.bias"]

    def _norm(self, name: str, x: Float32) -> Float32:
        x = x - x.mean(axis=1, keepdims=True)
        x = x / np.sqrt((x * x).mean(axis=1, keepdims=True) + 1e-5)
        return x * self.weights[f"{name}.weight"] + self.weights[f"{name}.bias"]

    def _attention(self, name: str, x: Float32) -> Float32:
        count, width = x.shape
        inputs = x @ self.weights[f"{name}.in_proj_weight"].T + self.weights[f"{name}.in_proj_bias"]
        # [3, heads, mentions, width of a head]
        query, key, value = inputs.reshape(count, 3, HEADS, width // HEADS).transpose(1, 2, 0, 3)
        likeness = query @ key.transpose(0, 2, 1) / np.float32(np.sqrt(width // HEADS))
        share = np.exp(likeness - likeness.max(axis=2, keepdims=True))
        share = share / share.sum(axis=2, keepdims=True)
        return self._linear(f"{name}.out_proj", (share @ value).transpose(1, 0, 2).reshape(count, width))

    def arrays(self, name: str) -> dict[str, NDArray[Any]]:
        """For np.savez, every name with `name/` before it; the weights in half precision."""
        scale = {part: getattr(self.scale, part) for part in (*_SCALES, *_POSITIONS)}
        weights = {part: array.astype(np.float16) for part, array in self.weights.items()}
        return {f"{name}/{part}": array for part, array in (*scale.items(), *weights.items())}


def network_from_arrays(arrays: Mapping[str, NDArray[Any]], name: str, features: int) -> MentionNetwork:
    """What `arrays` wrote, for rows of so many features. Raises BadFileError where it is something else."""
    own = {
        part.removeprefix(f"{name}/"): array for part, array in arrays.items() if part.startswith(f"{name}/")
    }
    broken = f"the network {name!r} of the model does not hold together"
    try:
        parts: dict[str, Any] = {part: own.pop(part).astype(np.int64) for part in _POSITIONS}
        parts |= {part: own.pop(part).astype(np.float32) for part in _SCALES}
        weights = {part: array.astype(np.float32) for part, array in own.items()}
        width = len(weights["norm.weight"])
        numbers = len(parts["numbers"])
        shapes = _shapes(numbers + len(parts["missing"]), width)
        tables = [f"tables.{k}.weight" for k in range(len(CATEGORIES))]
        shapes |= {table: (len(weights[table]), width) for table in tables}
        shapes |= dict.fromkeys(_SCALES, (numbers,)) | {"categories": (len(CATEGORIES),)}
    except (KeyError, ValueError, TypeError) as error:
        raise BadFileError(f"{broken} ({error}): train it anew") from error
    every = weights | parts
    wrong = [part for part, shape in shapes.items() if part not in every or every[part].shape != shape]
    wrong += [part for part, array in every.items() if not np.isfinite(array).all()]
    wrong += [part for part in weights if part not in shapes]
    limits = {"numbers": features, "categories": features, "missing": numbers}
    wrong += [part for part, end in limits.items() if ((parts[part] < 0) | (parts[part] >= end)).any()]
    if wrong or width % HEADS or not all(len(weights[table]) for table in tables):
        raise BadFileError(f"{broken} ({', '.join(wrong) or 'its size'}): train it anew")
    return MentionNetwork(scale=RowScale(**parts), weights=weights)


def _shapes(inputs: int, width: int) -> dict[str, tuple[int, ...]]:
    """Of the weights, but for the tables of the categories."""
    shapes: dict[str, tuple[int, ...]] = {}

    def linear(name: str, out: int, into: int) -> None:
        shapes[f"{name}.weight"], shapes[f"{name}.bias"] = (out, into), (out,)

    def norm(name: str) -> None:
        shapes[f"{name}.weight"] = shapes[f"{name}.bias"] = (width,)

    linear("numbers", width, inputs)
    for k in range(LAYERS):
        layer = f"layers.layers.{k}"
        shapes[f"{layer}.self_attn.in_proj_weight"] = (3 * width, width)
        shapes[f"{layer}.self_attn.in_proj_bias"] = (3 * width,)
        linear(f"{layer}.self_attn.out_proj", width, width)
        linear(f"{layer}.linear1", 2 * width, width)
        linear(f"{layer}.linear2", width, 2 * width)
        norm(f"{layer}.norm1")
        norm(f"{layer}.norm2")
    norm("norm")
    linear("inner", width, width)
    linear("out", 1, width)
    return shapes
