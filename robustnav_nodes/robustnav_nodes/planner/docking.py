"""Where to stop in front of a location, and how to get there (thesis, probabilistic docking)."""

import numpy as np

from robustnav_nodes.search_space.pose_graph import PoseGraph
from robustnav_nodes.search_space.space import SearchSpace


def destination_pose(
    space: SearchSpace, graph: PoseGraph, start: int, location: int, distance_m: float
) -> int | None:
    """The pose from which to end a search for the target at candidate `location`; None: no way to any.

    Of the poses that have the location in view and that `start` can reach on `graph` (that of `space`,
    perhaps with ways closed): the one that stands best, measured in metres off the wanted distance plus
    metres by which the view's axis passes beside the location. The thesis takes the nearest; a camera that
    is higher than the object loses it under itself there. Ties go to the fewest steps. Where no such pose
    has it in view, the reachable poses that face it stand in.
    """
    dx = space.candidates.x_m[location] - graph.x_m
    dy = space.candidates.y_m[location] - graph.y_m
    distance = np.hypot(dx, dy)
    bearing = np.arctan2(dy, dx) - graph.yaw_rad
    off_axis = np.abs(np.arctan2(np.sin(bearing), np.cos(bearing)))
    steps = graph.steps_from(start)
    reachable = np.isfinite(steps)

    choice = reachable & space.observability.column(location)
    if not choice.any():
        choice = reachable & (off_axis <= 0.5 * (2.0 * np.pi / graph.headings) + 1e-9)
    if not choice.any():
        return None
    misfit = np.abs(distance - distance_m) + distance * off_axis
    poses = np.nonzero(choice)[0]
    order = np.lexsort((poses, steps[poses], np.round(misfit[poses], 6)))
    return int(poses[order[0]])
