"""The points of a sensor_msgs/PointCloud2 as numbers, whatever fields they have."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

# By PointField.datatype, which begins at 1.
NUMBER_TYPES = ("i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8")


def points_of(cloud: Any) -> NDArray[Any] | None:
    """Structured array [n] with the cloud's fields; None where its data is not what its fields promise."""
    order = ">" if cloud.is_bigendian else "<"
    try:
        layout = np.dtype(
            {
                "names": [field.name for field in cloud.fields],
                "formats": [_format(field, order) for field in cloud.fields],
                "offsets": [int(field.offset) for field in cloud.fields],
                "itemsize": int(cloud.point_step),
            }
        )
        return np.frombuffer(cloud.data, dtype=layout)
    except (IndexError, ValueError):
        return None


def _format(field: Any, order: str) -> Any:
    number = order + NUMBER_TYPES[int(field.datatype) - 1]
    return number if field.count <= 1 else (number, (int(field.count),))
