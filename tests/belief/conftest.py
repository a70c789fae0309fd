"""A few candidate locations in a row."""

from collections.abc import Callable

import numpy as np
import pytest

from robustnav_nodes.search_space.candidates import Candidates


def row_of(count: int, spacing_m: float = 0.2) -> Candidates:
    """`count` candidates along x, the first at 0."""
    return Candidates(x_m=np.arange(count) * spacing_m, y_m=np.zeros(count), size_m=0.2)


@pytest.fixture(scope="session")
def in_a_row() -> Callable[..., Candidates]:
    return row_of
