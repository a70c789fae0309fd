"""The belief as a grid to look at."""

import numpy as np

from robustnav_msgs_py.values import BeliefCloud, OccupancyMap, Pose2D

MOST_LIKELY = 98  # 99 and 100 mean "occupied" to costmap viewers


def belief_map(cloud: BeliefCloud, resolution_m: float) -> OccupancyMap:
    """A grid around the candidates: 0..98 in proportion to the probability over the largest, -1 elsewhere."""
    position = cloud.position_m.astype(np.float64)
    column = np.floor(position[:, 0] / resolution_m).astype(np.int64)
    row = np.floor(position[:, 1] / resolution_m).astype(np.int64)
    first_column, first_row = int(column.min()), int(row.min())
    cells = np.full((int(row.max()) - first_row + 1, int(column.max()) - first_column + 1), -1, dtype=np.int8)
    level = np.rint(MOST_LIKELY * cloud.probability / cloud.probability.max()).astype(np.int8)
    np.maximum.at(cells, (row - first_row, column - first_column), level)
    return OccupancyMap(
        cells=cells,
        resolution_m=resolution_m,
        origin=Pose2D(x_m=first_column * resolution_m, y_m=first_row * resolution_m),
        stamp_ns=cloud.stamp_ns,
        frame_id=cloud.frame_id,
    )
