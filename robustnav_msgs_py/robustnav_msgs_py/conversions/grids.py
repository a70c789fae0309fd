"""Maps: nav_msgs/OccupancyGrid."""

from typing import Any

import numpy as np

from robustnav_msgs_py.conversions.arrays import from_array, to_array
from robustnav_msgs_py.conversions.motion import quaternion, yaw_rad
from robustnav_msgs_py.conversions.stamps import header, stamp_from_message, stamp_to_message
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.message_types import MapMetaData, OccupancyGrid, Point, Pose
from robustnav_msgs_py.values import OccupancyMap, Pose2D


def map_to_message(grid: OccupancyMap) -> OccupancyGrid:
    """An OccupancyGrid, row 0 at the origin."""
    info = MapMetaData(
        map_load_time=stamp_to_message(grid.stamp_ns),
        resolution=float(grid.resolution_m),
        width=grid.width,
        height=grid.height,
        origin=Pose(
            position=Point(x=float(grid.origin.x_m), y=float(grid.origin.y_m), z=0.0),
            orientation=quaternion(0.0),
        ),
    )
    return OccupancyGrid(header=header(grid.stamp_ns, grid.frame_id), info=info, data=to_array(grid.cells))


def map_from_message(message: Any) -> OccupancyMap:
    """Read a map; refused when it is empty, rotated, or its data do not fit its size."""
    info = message.info
    width, height = int(info.width), int(info.height)
    cells = from_array(message.data, np.int8)
    if cells.size != width * height:
        raise BadMessageError(f"a map of {width} x {height} cells has {cells.size} cells of data")
    return OccupancyMap(
        cells=cells.reshape(height, width),
        resolution_m=float(str(np.float32(info.resolution))),  # 0.05, not 0.05000000074505806
        origin=Pose2D(
            x_m=float(info.origin.position.x),
            y_m=float(info.origin.position.y),
            yaw_rad=yaw_rad(info.origin.orientation),
        ),
        stamp_ns=stamp_from_message(message.header.stamp),
        frame_id=message.header.frame_id,
    )
