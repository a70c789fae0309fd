"""How well the detector knows each class: precision and recall, and F1, which the belief uses."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from robustnav_msgs_py.errors import BadFileError, BadParameterError


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassStatistics:
    """Precision and recall of the detector on one class, each in 0..1."""

    precision: float = 0.8
    recall: float = 0.6

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
         "classes": {"mug": {"precision": 0.9, "recall": 0.7}}}

    Both keys may be missing. Raises BadFileError where the file cannot be read or holds anything else.
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
    names = {"precision", "recall"}
    is_row = isinstance(row, dict) and row.keys() == names
    if not is_row or any(isinstance(row[n], bool) or not isinstance(row[n], (int, float)) for n in names):
        raise BadFileError(
            f"class {label!r} in {str(path)!r} must be {{'precision': 0..1, 'recall': 0..1}}, "
            f"not {_shortened(row)}"
        )
    try:
        return ClassStatistics(precision=float(row["precision"]), recall=float(row["recall"]))
    except BadParameterError as error:
        raise BadFileError(f"class {label!r} in {str(path)!r}: {error}") from error


def _shortened(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."
