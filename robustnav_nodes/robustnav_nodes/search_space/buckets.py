"""Points sorted into square buckets, so that the ones near a place are found without looking at all."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64

_MOST_PER_SIDE = 512


class Buckets(NamedTuple):
    """Points on the floor by bucket, row after row, in the form that compiled loops take.

    Bucket (row, column) begins at (x_m + column * side_m, y_m + row * side_m) and holds the points
    member[start[i] : start[i + 1]], ascending, where i = row * columns + column. So the buckets of one row
    from one column to another are one slice of `member`.
    start: int64 [rows * columns + 1]; member: int32 [k].
    """

    x_m: float
    y_m: float
    side_m: float
    rows: int
    columns: int
    start: NDArray[np.int64]
    member: NDArray[np.int32]


def bucketed(x_m: Float64, y_m: Float64, side_m: float) -> Buckets:
    """The points (x_m, y_m), float64 [k], k > 0, in buckets of at least `side_m`; wider on a vast floor."""
    x_low, y_low = float(x_m.min()), float(y_m.min())
    extent_m = max(float(x_m.max()) - x_low, float(y_m.max()) - y_low)
    side_m = max(side_m, extent_m / (_MOST_PER_SIDE - 1))
    column = ((x_m - x_low) / side_m).astype(np.int64)
    row = ((y_m - y_low) / side_m).astype(np.int64)
    rows, columns = int(row.max()) + 1, int(column.max()) + 1
    bucket = row * columns + column
    count = np.bincount(bucket, minlength=rows * columns)
    return Buckets(
        x_m=x_low,
        y_m=y_low,
        side_m=side_m,
        rows=rows,
        columns=columns,
        start=np.concatenate([[0], np.cumsum(count)]).astype(np.int64),
        member=np.argsort(bucket, kind="stable").astype(np.int32),
    )
