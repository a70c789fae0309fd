"""What POMCP must know of a problem: its model, how it begins, what is legal, what a step does, its sizes.

The solver calls `begin`, `is_legal` and `step` below; numba takes the implementation by the type of the
model, as Julia would, so that one solver serves every problem and a step costs what it would cost inline.
A new problem is a NamedTuple, three functions, and a fourth that binds them to the solver:

    class MyModel(NamedTuple): ...

    implement(MyModel, begin=..., is_legal=..., step=...)

    @compiled
    def simulate_mine(model, tree, particles, first, last, rng):
        simulate(model, tree, particles, first, last, rng)

    MY_PROBLEM = Problem(actions=..., observations=..., state_size=..., simulate=simulate_mine)

The fourth is there because numba keeps it on disk under its own file: the compiled code of one problem must
not be needed to read that of another.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

State = NDArray[np.int64]

_implementations: dict[type, dict[str, Callable[..., Any]]] = {}


@dataclass(frozen=True, slots=True, kw_only=True)
class Problem:
    """A POMDP that `pomcp.plan` can solve: its sizes, and the function that binds it to the solver."""

    actions: int
    observations: int
    state_size: int
    simulate: Callable[..., Any]


def implement(
    model_type: type,
    *,
    begin: Callable[..., Any],
    is_legal: Callable[..., Any],
    step: Callable[..., Any],
) -> None:
    """Register the functions of a problem, plain Python that numba can compile, for its type of model."""
    _implementations[model_type] = {"begin": begin, "is_legal": is_legal, "step": step}


def begin(model: Any, particle: int, simulation: int, state: State) -> None:
    """Write the state (int64 [state_size], of the problem's own meaning) in which a simulation begins.

    `simulation` is its number; `particle` is the hidden truth in it.
    """
    raise NotImplementedError


def is_legal(model: Any, state: State, action: int) -> bool:
    """Whether `action` can be taken in `state`."""
    raise NotImplementedError


def step(model: Any, state: State, action: int, rng: np.random.Generator) -> tuple[int, float, bool]:
    """Take a legal action: changes `state`; gives observation, reward, and whether the problem ends."""
    raise NotImplementedError


def _implementation(model: Any, name: str) -> Callable[..., Any] | None:
    is_model = isinstance(model, types.BaseNamedTuple)
    return _implementations.get(model.instance_class, {}).get(name) if is_model else None


# Not strict: implementations carry annotations of their own, which numba would compare with these.
@overload(begin, strict=False)
def _begin(model: Any, particle: Any, simulation: Any, state: Any) -> Any:
    return _implementation(model, "begin")


@overload(is_legal, strict=False)
def _is_legal(model: Any, state: Any, action: Any) -> Any:
    return _implementation(model, "is_legal")


@overload(step, strict=False)
def _step(model: Any, state: Any, action: Any, rng: Any) -> Any:
    return _implementation(model, "step")
