"""How the sensors' hot loops are compiled with numba.

numba keeps compiled code beside the source and checks only the file of the function itself for changes, so
compiled functions that call each other live in one file: `rasterizer` finds surfaces, `textures` paints
them, `scan` casts the laser's rays.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


# Leave to turn a / b into a * (1 / b) and to take no care of NaN: for colours, which end as bytes anyway.
_LOOSE = {"arcp", "contract", "nnan", "nsz", "reassoc"}


def compiled(function: Function) -> Function:
    """`function`, compiled at its first call, kept on disk where that can be, and run without the GIL.

    Divisions are numpy's (1 / 0 is inf).
    """
    return _compiled(function, set())


def compiled_loosely(function: Function) -> Function:
    """The same for what need not be exact to the last bit: a quarter faster."""
    return _compiled(function, _LOOSE)


def _compiled(function: Function, freedom: set[str]) -> Function:
    try:
        dispatcher = numba.njit(cache=True, nogil=True, error_model="numpy", fastmath=freedom)(function)
    except RuntimeError:  # neither the package's folder nor the user's cache can be written to
        dispatcher = numba.njit(nogil=True, error_model="numpy", fastmath=freedom)(function)
    return cast(Function, dispatcher)
