"""Where two messages differ: field by field, not byte by byte, for CDR leaves what pads it to chance.

Numbers are the same where they differ by no more than rounding: another processor adds up otherwise. That
holds in texts of records and in the points of clouds, too.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bags.cloud_points import points_of

# What a decision took is a matter of the machine.
WALL_TIME_KEYS = ("elapsed_ms",)
LONGEST_TEXT = 60
# Relative, of numbers in double precision, also those that a record holds as text; and absolute, near zero:
# a probability of 1e-9 is still one of its own.
ROUNDING, LEAST = 1e-9, 1e-12
SINGLE_ROUNDING = 1e-6  # both, of arrays in single precision
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
        is_cloud = type(first).__name__ == "PointCloud2"
        for name in first.get_fields_and_field_types():
            if name == "stamp" and not with_stamps:
                continue
            field = f"{path}.{name}" if path else name
            if is_cloud and name == "data":
                yield from _point_differences(first, second, field)
            else:
                yield from _differences(getattr(first, name), getattr(second, name), field, with_stamps)
    elif isinstance(first, (list, tuple)) and first and hasattr(first[0], "get_fields_and_field_types"):
        if len(first) != len(second):
            yield FieldDifference(field=f"length of {path}", first=str(len(first)), second=str(len(second)))
        for number, (a, b) in enumerate(zip(first, second, strict=False)):
            key = getattr(a, "key", number)
            yield from _differences(a, b, f"{path}[{key}]", with_stamps)
    elif not _same(first, second):
        yield FieldDifference(field=path, first=_text(first, second), second=_text(second, first))


def _point_differences(first: Any, second: Any, path: str) -> Iterator[FieldDifference]:
    """The fields of points in which two clouds differ; their bytes where these are no such points."""
    a, b = points_of(first), points_of(second)
    if a is None or b is None or a.dtype != b.dtype:
        yield from _differences(first.data, second.data, path, with_stamps=True)
        return
    for name in a.dtype.names or ():
        yield from _differences(a[name], b[name], f"{path}.{name}", with_stamps=True)


def _same(first: Any, second: Any) -> bool:
    if isinstance(first, float):
        return _close(first, second)
    if isinstance(first, str):
        return first == second or _same_text(first, second)
    if isinstance(first, (bytes, int)):
        return bool(first == second)
    a, b = np.asarray(first), np.asarray(second)
    return a.shape == b.shape and (a.tobytes() == b.tobytes() or not _other(a, b).any())


def _other(a: NDArray[Any], b: NDArray[Any]) -> NDArray[np.bool_]:
    """Which elements of two arrays of one shape differ by more than rounding."""
    if not np.issubdtype(a.dtype, np.floating):
        return np.asarray(a != b)
    relative, absolute = (SINGLE_ROUNDING, SINGLE_ROUNDING) if a.itemsize == 4 else (ROUNDING, LEAST)
    return ~np.isclose(a, b, rtol=relative, atol=absolute, equal_nan=True)


def _same_text(first: str, second: str) -> bool:
    """Whether two texts are the same but for the rounding of the numbers in them."""
    if NUMBER.sub("", first) != NUMBER.sub("", second):
        return False
    pairs = zip(NUMBER.findall(first), NUMBER.findall(second), strict=True)
    return all(_close(float(a), float(b)) for a, b in pairs)


def _close(first: float, second: float) -> bool:
    both_nan = math.isnan(first) and math.isnan(second)
    return both_nan or math.isclose(first, second, rel_tol=ROUNDING, abs_tol=LEAST)


def _text(value: Any, other: Any) -> str:
    """The value where it differs from the other, short enough for a line."""
    if isinstance(value, (str, bytes, int, float)):
        text = repr(value)
    else:
        a, b = np.asarray(value).ravel(), np.asarray(other).ravel()
        if len(a) != len(b):
            return f"{len(a)} values"
        at = int(np.argmax(_other(a, b)))
        text = f"{a[at].item()!r} at {at} of {len(a)}"
    return text if len(text) <= LONGEST_TEXT else f"{text[: LONGEST_TEXT - 1]}…"
