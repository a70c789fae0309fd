"""How the renderer's hot loops are compiled with numba.

numba keeps compiled code beside the source and checks only the file of the function itself for changes, so
compiled functions that call each other live in one file: `rasterizer` finds surfaces, `textures` paints them.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """`function`, compiled at its first call, kept on disk where that can be, and run without the GIL.

    Divisions are numpy's (1 / 0 is inf). Nothing is reordered: the same input gives the same bytes.
    """
    try:
        dispatcher = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # neither the package's folder nor the user's cache can be written to
        dispatcher = numba.njit(nogil=True, error_model="numpy")(function)
    return cast(Function, dispatcher)
