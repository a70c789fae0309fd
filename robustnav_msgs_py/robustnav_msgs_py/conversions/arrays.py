"""Arrays of messages, filled and read without a copy per element.

rclpy takes `array.array` fields as they are; assigning an ndarray or a list checks each element in Python
and is a thousand times slower.
"""

from array import array
from typing import Any

import numpy as np
from numpy.typing import NDArray

_TYPECODES = {"uint8": "B", "int8": "b", "float32": "f", "float64": "d"}


def to_array(values: NDArray[Any]) -> "array[Any]":
    """The values of an ndarray, row by row, as an array.array of the same element type."""
    filled: array[Any] = array(_TYPECODES[values.dtype.name])
    filled.frombytes(np.ascontiguousarray(values).reshape(-1).view(np.uint8).data)
    return filled


def from_array(values: Any, dtype: Any) -> NDArray[Any]:
    """A message's array field (array.array, bytes, list, ndarray) as a flat ndarray, uncopied if possible."""
    if isinstance(values, (array, bytes, bytearray, memoryview)):
        return np.frombuffer(values, dtype=dtype) if len(values) else np.empty(0, dtype=dtype)
    return np.asarray(values).reshape(-1).view(dtype) if len(values) else np.empty(0, dtype=dtype)
