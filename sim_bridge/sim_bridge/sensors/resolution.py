"""A picture of lower resolution in the same size: areas are averaged, and enlarged again without blocks."""

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float32


class Resolution:
    """Pictures of `height` x `width` that are sharp for `factor` times fewer pixels along each axis.

    At the right and lower edge, areas are smaller where the size is no multiple of the factor. Immutable.
    """

    def __init__(self, height: int, width: int, factor: int) -> None:
        self._rows = _Axis(height, factor)
        self._columns = _Axis(width, factor)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of the small picture."""
        return self._rows.count, self._columns.count

    def shrunk(self, pixels: NDArray[np.uint8]) -> Float32:
        """The mean of each area: uint8 [height, width, n] to float32 [rows, columns, n]."""
        sums = np.add.reduceat(pixels, self._rows.first, axis=0, dtype=np.uint32)
        sums = np.add.reduceat(sums, self._columns.first, axis=1)
        areas = self._rows.length[:, None] * self._columns.length[None, :]
        return np.asarray(sums / areas[:, :, None], dtype=np.float32)

    def enlarged(self, small: Float32) -> Float32:
        """Bilinear between the areas' middles: float32 [rows, columns, n] to [height, width, n]."""
        across = _between(small, self._columns, axis=1)
        return _between(across, self._rows, axis=0)


class _Axis:
    """Areas along one axis: where they begin and how long they are, and between which two a pixel lies."""

    def __init__(self, size: int, factor: int) -> None:
        self.first = np.arange(0, size, factor)
        self.length = np.diff(np.append(self.first, size))
        self.count = len(self.first)
        middle = self.first + (self.length - 1) / 2.0
        at = np.interp(np.arange(size), middle, np.arange(self.count))
        self.before = np.floor(at).astype(np.intp)
        self.after = np.minimum(self.before + 1, self.count - 1)
        self.weight = (at - self.before).astype(np.float32)


def _between(values: Float32, axis_of: _Axis, axis: int) -> Float32:
    before = np.take(values, axis_of.before, axis=axis)
    rise = np.take(values, axis_of.after, axis=axis)
    rise -= before
    rise *= axis_of.weight[:, None, None] if axis == 0 else axis_of.weight[None, :, None]
    rise += before
    return rise
