"""A picture of lower resolution in the same size: areas are averaged, and enlarged again without blocks."""

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float32


class Resolution:
    """Pictures of `height` x `width` that are sharp for `factor` times fewer pixels along each axis.

    At the right and lower edge, areas are smaller where the size is no multiple of the factor. Immutable.
    """

    def __init__(self, height: int, width: int, channels: int, factor: int) -> None:
        self._shape = height, width, channels
        self._factor = factor
        self._rows = _Axis(height, factor)
        self._columns = _Axis(width, factor)
        # A picture's rows are handled as one line of numbers, channel by channel: short axes are slow.
        self._before = _entries(self._columns.before, channels)
        self._after = _entries(self._columns.after, channels)
        self._weight = np.repeat(self._columns.weight, channels)
        firsts = [self._columns.first[self._columns.length > step] + step for step in range(factor)]
        self._column_parts = [_entries(columns, channels) for columns in firsts]
        areas = self._rows.length[:, None] * np.repeat(self._columns.length, channels)[None, :]
        self._areas = areas.astype(np.float32)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Rows, columns and channels of the small picture."""
        return self._rows.count, self._columns.count, self._shape[2]

    def shrunk(self, pixels: NDArray[np.uint8]) -> Float32:
        """The mean of each area: uint8 [height, width, channels] to float32 [`shape`]."""
        lines = pixels.reshape(self._shape[0], -1)
        down = np.zeros((self._rows.count, lines.shape[1]), dtype=np.uint16)
        for step in range(self._factor):
            part = lines[step :: self._factor]
            down[: len(part)] += part
        small = np.zeros(self._areas.shape, dtype=np.float32)
        for entries in self._column_parts:
            small[:, : len(entries)] += down[:, entries]
        small /= self._areas
        return small.reshape(self.shape)

    def enlarged(self, small: Float32) -> Float32:
        """Bilinear between the areas' middles: float32 [`shape`] to [height, width, channels]."""
        lines = small.reshape(self._rows.count, -1)
        across = lines[:, self._after] - lines[:, self._before]
        across *= self._weight
        across += lines[:, self._before]
        full = across[self._rows.after] - across[self._rows.before]
        full *= self._rows.weight[:, None]
        full += across[self._rows.before]
        return full.reshape(self._shape)


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


def _entries(columns: NDArray[np.intp], channels: int) -> NDArray[np.intp]:
    """Where in a line of numbers all channels of the columns are."""
    return np.asarray((columns[:, None] * channels + np.arange(channels)).ravel())
