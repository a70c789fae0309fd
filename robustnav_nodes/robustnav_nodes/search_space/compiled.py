"""How this project compiles its hot loops with numba.

numba keeps compiled code beside the source, and checks only the file of the function itself for changes. So
compiled functions that call each other live in one file. Where they cannot (a problem and `planner.pomcp`),
remove the `__pycache__` folders after a change.

Divisions are numpy's (1 / 0 is inf): with Python's, each may raise, and then numba counts a reference to
every array at every call, which can take longer than the work.
"""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def compiled(function: Function) -> Function:
    """`function`, compiled at its first call, kept on disk, and run without the GIL.

    Without a GIL, because nodes plan in a worker thread while their callbacks go on.
    """
    try:
        dispatcher = numba.njit(cache=True, nogil=True, error_model="numpy")(function)
    except RuntimeError:  # neither the package's folder nor the user's cache can be written to
        return compiled_into_callers(function)
    return cast(Function, dispatcher)


def compiled_into_callers(function: Function) -> Function:
    """`function`, compiled anew for each compiled function that calls it, and kept on disk with that one.

    For functions that take other functions or models of any type: what is kept on disk under a function's
    own name can only be read where all types that it was ever called with can be imported.
    """
    return cast(Function, numba.njit(nogil=True, error_model="numpy")(function))
