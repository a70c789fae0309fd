"""How well the detector knows each class: precision, recall (by range, where known), and F1."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import Float64


@dataclass(frozen=True, slots=True, kw_only=True)
class RecallByRange:
    """Recall in bins of distance on the floor: `edges_m` rise from 0 or more, one more than bins."""

    edges_m: tuple[float, ...]
    recall: tuple[float, ...]

    def __post_init__(self) -> None:
        rising = all(low < high for low, high in pairwise(self.edges_m))
        fits = len(self.recall) >= 1 and len(self.edges_m) == len(self.recall) + 1
        if not rising or not fits or not all(map(math.isfinite, self.edges_m)) or self.edges_m[0] < 0.0:
            raise BadParameterError(
                f"recall by range has edges {self.edges_m!r} for {len(self.recall)} bins; "
                "edges must rise from 0 m or more, one more than bins"
            )
        if not all(0.0 <= value <= 1.0 for value in self.recall):
            raise BadParameterError(f"recall by range is {self.recall!r}; each must lie in 0..1")

    def at(self, distance_m: Float64) -> Float64:
        """Recall at each distance: straight between the bins' middles, beyond these as there."""
        edges = np.array(self.edges_m)
        return np.asarray(np.interp(distance_m, (edges[:-1] + edges[1:]) / 2.0, self.recall))

    def scaled(self, factor: float) -> "RecallByRange":
        """The same course, higher or lower, within 0..1."""
        return replace(self, recall=tuple(min(1.0, factor * value) for value in self.recall))

    def within(self, low: float, high: float) -> "RecallByRange":
        """The same, but nowhere below `low` or above `high`."""
        return replace(self, recall=tuple(min(max(value, low), high) for value in self.recall))


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassStatistics:
    """Precision and recall of the detector on one class, each in 0..1.

    recall_by_range: recall at each distance; None where only the mean over all distances is known.
    """

    precision: float = 0.8
    recall: float = 0.6
    recall_by_range: RecallByRange | None = None

    def __post_init__(self) -> None:
        for name, value in (("precision", self.precision), ("recall", self.recall)):
            if not 0.0 <= value <= 1.0:
                raise BadParameterError(f"a detector's {name} is {value!r}; it must lie in 0..1")

    @property
    def f1(self) -> float:
        """Harmonic mean of precision and recall (F1, thesis 3.2.1.3); 0 where both are 0."""
        total = self.precision + self.recall
        return 2.0 * self.precision * self.recall / total if total > 0.0 else 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class DetectorStatistics:
    """Statistics by class name, and those of a class that nobody measured."""

    by_class: Mapping[str, ClassStatistics] = field(default_factory=dict)
    unknown_class: ClassStatistics = field(default_factory=ClassStatistics)

    def of(self, label: str) -> ClassStatistics:
        """The statistics of class `label`, or those of an unknown class."""
        return self.by_class.get(label, self.unknown_class)


def read_detector_statistics(path: Path) -> DetectorStatistics:
    """Read a file such as

        {"unknown_class": {"precision": 0.8, "recall": 0.6},
         "classes": {"mug": {"precision": 0.9, "recall": 0.7,
                             "recall_by_range": {"edges_m": [0, 1, 2, 4], "recall": [0.9, 0.8, 0.5]}}}}

    Both keys may be missing, and recall_by_range anywhere. Raises BadFileError where the file cannot be read
    or holds anything else.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BadFileError(
            f"cannot read the detector's statistics {str(path)!r}: {error.strerror}"
        ) from error
    except ValueError as error:
        raise BadFileError(f"the detector's statistics {str(path)!r} are not JSON: {error}") from error
    if not isinstance(content, dict) or not content.keys() <= {"unknown_class", "classes"}:
        raise BadFileError(
            f"the detector's statistics {str(path)!r} must be an object with 'classes' and 'unknown_class', "
            f"not {_shortened(content)}"
        )
    classes = content.get("classes", {})
    if not isinstance(classes, dict):
        raise BadFileError(f"'classes' in {str(path)!r} must be an object, not {_shortened(classes)}")
    by_class = {label: _class_statistics(label, row, path) for label, row in classes.items()}
    if "unknown_class" not in content:
        return DetectorStatistics(by_class=by_class)
    unknown = _class_statistics("unknown_class", content["unknown_class"], path)
    return DetectorStatistics(by_class=by_class, unknown_class=unknown)


def _class_statistics(label: str, row: Any, path: Path) -> ClassStatistics:
    names = ("precision", "recall")
    is_row = isinstance(row, dict) and set(names) <= row.keys() <= {*names, "recall_by_range"}
    if not is_row or not all(_is_number(row[name]) for name in names):
        raise BadFileError(
            f"class {label!r} in {str(path)!r} must be {{'precision': 0..1, 'recall': 0..1}}, "
            f"not {_shortened(row)}"
        )
    try:
        return ClassStatistics(
            precision=float(row["precision"]),
            recall=float(row["recall"]),
            recall_by_range=_recall_by_range(row.get("recall_by_range")),
        )
    except BadParameterError as error:
        raise BadFileError(f"class {label!r} in {str(path)!r}: {error}") from error


def _recall_by_range(row: Any) -> RecallByRange | None:
    if row is None:
        return None
    names = ("edges_m", "recall")
    is_row = isinstance(row, dict) and row.keys() == set(names)
    if not is_row or not all(
        isinstance(row[name], list) and all(map(_is_number, row[name])) for name in names
    ):
        raise BadParameterError(
            f"recall_by_range must be {{'edges_m': [0, 1, 2], 'recall': [0.9, 0.5]}}, not {_shortened(row)}"
        )
    return RecallByRange(edges_m=tuple(map(float, row["edges_m"])), recall=tuple(map(float, row["recall"])))


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _shortened(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
