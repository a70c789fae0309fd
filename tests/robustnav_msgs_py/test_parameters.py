"""A declaration decides the type, the range and the sentence that says what is wrong."""

from dataclasses import dataclass
from typing import Any

import pytest

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.parameters import build, parameter, specs


@dataclass(frozen=True, slots=True, kw_only=True)
class Example:
    """An example."""

    count: int = parameter(3, "how many", low=1, high=9)
    time_s: float = parameter(0.5, "how long", unit="s", low=0.1, high=2.0)
    kind: str = parameter("a", "which", choices=("a", "b"))
    names: list[str] = parameter([], "whose")
    on: bool = parameter(True, "whether")


def test_defaults_and_values() -> None:
    assert build(Example, {}) == Example()
    built = build(Example, {"count": 9, "time_s": 1, "names": ("x",), "on": False})
    assert built == Example(count=9, time_s=1.0, names=["x"], on=False)
    assert isinstance(built.time_s, float)


@pytest.mark.parametrize(
    ("name", "value", "word"),
    [
        ("count", 10, "1 .. 9"),
        ("count", 2.5, "int"),
        ("count", True, "int"),
        ("time_s", 0.05, "0.1 .. 2 s"),
        ("time_s", float("nan"), "finite"),
        ("time_s", "1", "float"),
        ("kind", "c", r"a \| b"),
        ("names", "x", "list"),
        ("on", 1, "bool"),
        ("cuont", 1, "known are: count"),
    ],
)
def test_what_does_not_fit_is_refused_with_a_sentence(name: str, value: Any, word: str) -> None:
    with pytest.raises(BadParameterError, match=word):
        build(Example, {name: value})


def test_a_description_holds_unit_and_range() -> None:
    described = {spec.name: spec.full_description for spec in specs(Example)}
    assert described["time_s"] == "how long [s, 0.1 .. 2]"
    assert described["kind"] == "which [a | b]"


def test_a_number_without_a_range_cannot_be_declared() -> None:
    with pytest.raises(TypeError, match="low and high"):
        parameter(1, "no range")
