"""Status and records: diagnostic_msgs/DiagnosticStatus with key-value pairs.

A record is a flat frozen dataclass (see records.py) of numbers, texts, enums and tuples of these; tuples are
written as JSON, floats so that they read back exactly.
"""

import dataclasses
import json
import typing
from enum import Enum
from typing import Any, TypeVar

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.message_types import DiagnosticStatus, KeyValue
from robustnav_msgs_py.values import OK, Status

R = TypeVar("R")


def status_to_message(status: Status) -> DiagnosticStatus:
    """A DiagnosticStatus; its level is a byte."""
    return DiagnosticStatus(
        level=bytes([status.level]),
        name=status.name,
        message=status.message,
        hardware_id=status.hardware_id,
        values=[KeyValue(key=key, value=value) for key, value in status.values.items()],
    )


def status_from_message(message: Any) -> Status:
    """Read a DiagnosticStatus."""
    level = message.level[0] if isinstance(message.level, bytes) else int(message.level)
    return Status(
        name=message.name,
        level=level,
        message=message.message,
        hardware_id=message.hardware_id,
        values={pair.key: pair.value for pair in message.values},
    )


def record_to_message(record: Any, *, level: int = OK, summary: str = "") -> DiagnosticStatus:
    """Any record as a DiagnosticStatus named after its type; `summary` is its line for people."""
    values = {item.name: _text(getattr(record, item.name)) for item in dataclasses.fields(record)}
    return status_to_message(Status(name=type(record).__name__, level=level, message=summary, values=values))


def record_from_message(message: Any, kind: type[R]) -> R:
    """Read a record of type `kind`; refused when it is another one, or a field is missing or unreadable."""
    status = status_from_message(message)
    if status.name != kind.__name__:
        raise BadMessageError(f"a status is named {status.name!r}, expected {kind.__name__!r}")
    hints = typing.get_type_hints(kind)
    found = {}
    for item in dataclasses.fields(kind):  # type: ignore[arg-type]
        if item.name not in status.values:
            raise BadMessageError(f"a {kind.__name__} lacks its field {item.name!r}")
        try:
            found[item.name] = _value(status.values[item.name], hints[item.name])
        except ValueError as error:
            text = status.values[item.name]
            raise BadMessageError(f"a {kind.__name__} has {item.name} = {text!r}: {error}") from error
    return kind(**found)


def _text(value: Any) -> str:
    if isinstance(value, tuple):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, Enum):
        return str(value.value)
    return repr(value) if isinstance(value, float) else str(value)


def _value(text: str, kind: Any) -> Any:
    if typing.get_origin(kind) is tuple:
        items = json.loads(text)
        if not isinstance(items, list):
            raise ValueError("expected a JSON list")
        return tuple(typing.get_args(kind)[0](item) for item in items)
    if kind is bool:
        if text not in ("True", "False"):
            raise ValueError("expected True or False")
        return text == "True"
    return kind(text)
