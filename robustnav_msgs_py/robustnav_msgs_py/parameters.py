"""Declare the parameters of a node once: default, description, unit and range.

A node's parameters are one frozen dataclass whose fields are made by `parameter()`. ROS parameters, the
YAML file, the documentation and the command line's help are all read from it.

    @dataclass(frozen=True, slots=True, kw_only=True)
    class DockingParameters:
        distance_m: float = parameter(0.6, "distance kept from the object", unit="m", low=0.2, high=3.0)
"""

import dataclasses
import math
import typing
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from robustnav_msgs_py.errors import BadParameterError

ParameterValue = bool | int | float | str | list[str]
T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterSpec:
    """What is known of one parameter; `low`, `high` are inclusive, `choices` empty where any text goes."""

    name: str
    type: type
    default: ParameterValue
    description: str
    unit: str
    low: float | None
    high: float | None
    choices: tuple[str, ...]

    @property
    def range_text(self) -> str:
        """The range or the choices as a person reads them, "" where anything goes."""
        if self.choices:
            return " | ".join(self.choices)
        if self.low is None or self.high is None:
            return ""
        return f"{self.low:g} .. {self.high:g}"

    @property
    def full_description(self) -> str:
        """Description, unit and range in one line, as `ros2 param describe` shows it."""
        extras = ", ".join(text for text in (self.unit, self.range_text) if text)
        return f"{self.description} [{extras}]" if extras else self.description

    def checked(self, value: Any) -> ParameterValue:
        """Return `value` in the parameter's type, or raise BadParameterError with a sentence."""
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if self.type is float and is_number:
            value = float(value)
        if self.type is list:
            fits = isinstance(value, (list, tuple)) and all(isinstance(item, str) for item in value)
            value = list(value) if fits else value
        else:
            fits = type(value) is self.type
        if not fits:
            raise BadParameterError(
                f"parameter {self.name!r} is {value!r}; it must be of type {self.type.__name__}"
            )
        if isinstance(value, float) and not math.isfinite(value):
            raise BadParameterError(f"parameter {self.name!r} is {value!r}; it must be a finite number")
        outside = self.low is not None and self.high is not None and not self.low <= value <= self.high
        if outside or (self.choices and value not in self.choices):
            raise BadParameterError(
                f"parameter {self.name!r} is {value!r}; it must lie in {self.range_text} {self.unit}".rstrip()
            )
        return typing.cast(ParameterValue, value)


def parameter(
    default: ParameterValue,
    description: str,
    *,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    choices: tuple[str, ...] = (),
) -> Any:
    """A dataclass field that is a parameter; numbers must have a range."""
    if isinstance(default, (int, float)) and not isinstance(default, bool) and (low is None or high is None):
        raise TypeError(f"a number needs low and high: {description!r}")
    metadata = {"description": description, "unit": unit, "low": low, "high": high, "choices": choices}
    if isinstance(default, list):
        return field(default_factory=lambda: list(default), metadata=metadata)
    return field(default=default, metadata=metadata)


def specs(declaration: type) -> tuple[ParameterSpec, ...]:
    """The parameters that a dataclass declares, in order."""
    found = []
    for item in dataclasses.fields(declaration):
        default: Any = item.default
        if item.default_factory is not dataclasses.MISSING:
            default = item.default_factory()
        found.append(ParameterSpec(name=item.name, type=type(default), default=default, **item.metadata))
    return tuple(found)


def build(declaration: type[T], values: Mapping[str, Any]) -> T:
    """Make the dataclass from `values` (missing ones take their default), each checked.

    Raises BadParameterError for an unknown name, a wrong type or a value out of range.
    """
    known = {spec.name: spec for spec in specs(declaration)}
    for name in values:
        if name not in known:
            raise BadParameterError(f"there is no parameter {name!r}; known are: {', '.join(sorted(known))}")
    return declaration(**{name: known[name].checked(value) for name, value in values.items()})
