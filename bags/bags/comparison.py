"""Where two messages differ: field by field, not byte by byte, for CDR leaves what pads it to chance."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

# What a decision took is a matter of the machine.
WALL_TIME_KEYS = ("elapsed_ms",)
LONGEST_TEXT = 60


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
        return bool(first == second or (first != first and second != second))
    if isinstance(first, (str, bytes, int)):
        return bool(first == second)
    a, b = np.asarray(first), np.asarray(second)
    return a.shape == b.shape and a.tobytes() == b.tobytes()


def _text(value: Any, other: Any) -> str:
    """The value where it differs from the other, short enough for a line."""
    if isinstance(value, (str, bytes, int, float)):
        text = repr(value)
    else:
        a, b = np.asarray(value).ravel(), np.asarray(other).ravel()
        if len(a) != len(b):
            return f"{len(a)} values"
        at = int(np.flatnonzero(a != b)[0]) if (a != b).any() else 0
        text = f"{a[at]!r} at {at} of {len(a)}"
    return text if len(text) <= LONGEST_TEXT else f"{text[: LONGEST_TEXT - 1]}…"
