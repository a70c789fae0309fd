"""Where two messages differ: field by field, not byte by byte, for CDR leaves what pads it to chance.

Numbers are the same where they differ by no more than rounding: another processor adds up otherwise.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

# What a decision took is a matter of the machine.
WALL_TIME_KEYS = ("elapsed_ms",)
LONGEST_TEXT = 60
# Of numbers in double precision, also those that a record holds as text; of arrays in single precision.
ROUNDING, SINGLE_ROUNDING = 1e-9, 1e-6
NUMBER = re.compile(r"-?\d+\.\d+(?:e[+-]?\d+)?")


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldDifference:
    """A field, as `pose.position.x`, and what each of the two holds there, shortened."""

    field: str
    first: str
    second: str


def differences(first: Any, second: Any, *, with_stamps: bool = True) -> Iterator[FieldDifference]:
    """The fields in which two messages of one type differ; headers' stamps only where `with_stamps`."""
    return _differences(first, second, "", with_stamps)


def _differences(first: Any, second: Any, path: str, with_stamps: bool) -> Iterator[FieldDifference]:
    if hasattr(first, "get_fields_and_field_types"):
        if getattr(first, "key", None) in WALL_TIME_KEYS and first.key == second.key:
            return
        for name in first.get_fields_and_field_types():
            if name == "stamp" and not with_stamps:
                continue
            field = f"{path}.{name}" if path else name
            yield from _differences(getattr(first, name), getattr(second, name), field, with_stamps)
    elif isinstance(first, (list, tuple)) and first and hasattr(first[0], "get_fields_and_field_types"):
        if len(first) != len(second):
            yield FieldDifference(field=f"length of {path}", first=str(len(first)), second=str(len(second)))
        for number, (a, b) in enumerate(zip(first, second, strict=False)):
            key = getattr(a, "key", number)
            yield from _differences(a, b, f"{path}[{key}]", with_stamps)
    elif not _same(first, second):
        yield FieldDifference(field=path, first=_text(first, second), second=_text(second, first))


def _same(first: Any, second: Any) -> bool:
    if isinstance(first, float):
        return _close(first, second)
    if isinstance(first, str):
        return first == second or _same_text(first, second)
    if isinstance(first, (bytes, int)):
        return bool(first == second)
    a, b = np.asarray(first), np.asarray(second)
    if a.shape != b.shape or a.tobytes() == b.tobytes():
        return a.shape == b.shape
    rounding = SINGLE_ROUNDING if a.dtype == np.float32 else ROUNDING
    if not np.issubdtype(a.dtype, np.floating):
        return False
    return bool(np.allclose(a, b, rtol=rounding, atol=rounding, equal_nan=True))


def _same_text(first: str, second: str) -> bool:
    """Whether two texts are the same but for the rounding of the numbers in them."""
    if NUMBER.sub("", first) != NUMBER.sub("", second):
        return False
    pairs = zip(NUMBER.findall(first), NUMBER.findall(second), strict=True)
    return all(_close(float(a), float(b)) for a, b in pairs)


def _close(first: float, second: float) -> bool:
    both_nan = math.isnan(first) and math.isnan(second)
    return both_nan or math.isclose(first, second, rel_tol=ROUNDING, abs_tol=ROUNDING)


def _text(value: Any, other: Any) -> str:
    """The value where it differs from the other, short enough for a line."""
    if isinstance(value, (str, bytes, int, float)):
        text = repr(value)
    else:
        a, b = np.asarray(value).ravel(), np.asarray(other).ravel()
        if len(a) != len(b):
            return f"{len(a)} values"
        other_than = (a != b) & ~((a != a) & (b != b))
        at = int(np.flatnonzero(other_than)[0]) if other_than.any() else 0
        text = f"{a[at]!r} at {at} of {len(a)}"
    return text if len(text) <= LONGEST_TEXT else f"{text[: LONGEST_TEXT - 1]}…"
