"""Gradient-boosted trees as plain arrays: learned by scikit-learn, kept in a file and asked without it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Float64

_PARTS = ("first", "feature", "threshold", "left", "right", "missing_left", "value")


@dataclass(frozen=True, slots=True, kw_only=True)
class Trees:
    """A sum of trees that begin at `first`. Node n is a leaf where left[n] < 0; only there value counts."""

    base: float
    first: NDArray[np.int32]
    feature: NDArray[np.int16]
    threshold: NDArray[np.float32]
    left: NDArray[np.int32]
    right: NDArray[np.int32]
    missing_left: NDArray[np.bool_]
    value: NDArray[np.float32]

    def log_odds(self, rows: NDArray[np.float32]) -> Float64:
        """float64 [n] of rows float32 [n, features]; NaN is a value that is missing."""
        total: Float64 = _sum_of_trees(
            np.ascontiguousarray(rows, dtype=np.float32),
            self.base,
            self.first,
            self.feature,
            self.threshold,
            self.left,
            self.right,
            self.missing_left,
            self.value,
        )
        return total

    def arrays(self, name: str) -> dict[str, NDArray[Any]]:
        """For np.savez, every name with `name/` before it."""
        parts: dict[str, NDArray[Any]] = {part: getattr(self, part) for part in _PARTS}
        return {f"{name}/base": np.array(self.base), **{f"{name}/{part}": parts[part] for part in _PARTS}}


def trees_from_arrays(arrays: Mapping[str, NDArray[Any]], name: str, features: int) -> Trees:
    """What `arrays` wrote. Raises BadFileError where it is missing or points outside itself."""
    try:
        parts = {part: arrays[f"{name}/{part}"] for part in _PARTS}
        base = float(arrays[f"{name}/base"])
    except KeyError as error:
        raise BadFileError(f"the model lacks {error.args[0]!r}: train it anew") from error
    count = len(parts["feature"])
    inner = parts["left"] >= 0
    whole = all(len(parts[part]) == count for part in _PARTS if part != "first")
    # children come after their parent, so that every walk through a tree ends
    if (
        not whole
        or (parts["first"] >= count).any()
        or (parts["feature"] >= features).any()
        or (parts["left"][inner] <= np.flatnonzero(inner)).any()
        or (parts["right"][inner] <= np.flatnonzero(inner)).any()
        or (parts["left"] >= count).any()
        or (parts["right"] >= count).any()
    ):
        raise BadFileError(f"the trees {name!r} of the model do not hold together: train it anew")
    return Trees(base=base, **parts)


def trees_of(classifier: Any) -> Trees:
    """The trees of a fitted HistGradientBoostingClassifier of two classes."""
    first, parts = [], []
    count = 0
    for iteration in classifier._predictors:  # noqa: SLF001 - scikit-learn shows its trees nowhere else
        nodes = iteration[0].nodes
        leaf = nodes["is_leaf"].astype(bool)
        first.append(count)
        parts.append(
            (
                nodes["feature_idx"].astype(np.int16),
                _rounded_down(nodes["num_threshold"]),
                np.where(leaf, -1, nodes["left"].astype(np.int64) + count).astype(np.int32),
                np.where(leaf, -1, nodes["right"].astype(np.int64) + count).astype(np.int32),
                nodes["missing_go_to_left"].astype(bool),
                np.where(leaf, nodes["value"], 0.0).astype(np.float32),
            )
        )
        count += len(nodes)
    columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
    return Trees(
        base=float(np.ravel(classifier._baseline_prediction)[0]),  # noqa: SLF001 - nor their start
        first=np.array(first, dtype=np.int32),
        feature=columns[0],
        threshold=columns[1],
        left=columns[2],
        right=columns[3],
        missing_left=columns[4],
        value=columns[5],
    )


def mean_log_odds(trees: Sequence[Trees], rows: NDArray[np.float32]) -> Float64:
    """Of several ensembles that were learned for the same rows."""
    return np.mean([one.log_odds(rows) for one in trees], axis=0) if len(rows) else np.zeros(0)


def _rounded_down(values: Float64) -> NDArray[np.float32]:
    """float32 not above the value: rows are float32, so every comparison with them stays what it was."""
    with np.errstate(over="ignore"):
        rounded = values.astype(np.float32)
    return np.where(rounded > values, np.nextafter(rounded, np.float32(-np.inf)), rounded)


@njit(cache=True)  # type: ignore[untyped-decorator, unused-ignore]
def _sum_of_trees(
    rows: NDArray[np.float32],
    base: float,
    first: NDArray[np.int32],
    feature: NDArray[np.int16],
    threshold: NDArray[np.float32],
    left: NDArray[np.int32],
    right: NDArray[np.int32],
    missing_left: NDArray[np.bool_],
    value: NDArray[np.float32],
) -> Float64:
    total = np.full(len(rows), base)
    for row in range(len(rows)):
        for start in first:
            node = start
            while left[node] >= 0:
                x = rows[row, feature[node]]
                go_left = missing_left[node] if np.isnan(x) else x <= threshold[node]
                node = left[node] if go_left else right[node]
            total[row] += value[node]
    return total
