"""How far the robot had to drive at least: to the nearest place from which a target can be docked at."""

import math
from collections.abc import Sequence

import numpy as np
from scipy import sparse
from scipy.sparse import csgraph

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Float64, ObjectInstance, OccupancyMap, Pose2D
from robustnav_nodes.search_space.camera_view import CameraView, build_camera_view
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import NOWHERE, PoseGraph, build_pose_graph


def shortest_way_m(
    floor_map: OccupancyMap,
    candidates: OccupancyMap | None,
    parameters: SearchSpaceParameters,
    start: Pose2D,
    targets: Sequence[ObjectInstance],
    docking_distance_m: float,
) -> float | None:
    """Length (m) of the shortest way from `start` to a place that has one of `targets` in view and near.

    Near is within `docking_distance_m`. The way follows the pose graph; turning on the spot costs nothing.
    None where nothing can be searched on this map, or none of the targets can be reached.
    """
    try:
        view = build_camera_view(floor_map, candidates, parameters)
        graph = build_pose_graph(view.grid, parameters, start)
    except BadMapError:
        return None
    goals = {pose for target in targets for pose in _docking_poses(view, graph, target, docking_distance_m)}
    if not goals:
        return None
    first = graph.nearest(start)
    to_graph_m = math.hypot(graph.x_m[first] - start.x_m, graph.y_m[first] - start.y_m)
    shortest_m = float(_lengths_from(graph, first)[sorted(goals)].min())
    return to_graph_m + shortest_m if math.isfinite(shortest_m) else None


def _docking_poses(
    view: CameraView, graph: PoseGraph, target: ObjectInstance, docking_distance_m: float
) -> list[int]:
    """Poses that are near `target` and have the candidate location that holds it in view."""
    candidates = view.candidates
    offset_m = np.hypot(candidates.x_m - target.x_m, candidates.y_m - target.y_m)
    holder = int(np.argmin(offset_m))
    if offset_m[holder] > docking_distance_m:
        return []
    near = np.hypot(graph.x_m - target.x_m, graph.y_m - target.y_m) <= docking_distance_m
    return [int(pose) for pose in np.flatnonzero(near) if view.visible(graph.pose(int(pose)))[holder]]


def _lengths_from(graph: PoseGraph, start: int) -> Float64:
    """float64 [n]: metres from pose `start` to each pose, +Inf where there is no way."""
    begins, action = np.nonzero(graph.successors != NOWHERE)
    ends = graph.successors[begins, action]
    length_m = np.hypot(graph.x_m[ends] - graph.x_m[begins], graph.y_m[ends] - graph.y_m[begins])
    # scipy takes a stored 0 for "no edge"; a turn must stay one.
    weights = np.maximum(length_m, 1e-9)
    links = sparse.csr_matrix((weights, (begins, ends)), shape=(len(graph), len(graph)))
    return np.asarray(csgraph.dijkstra(links, indices=start), dtype=np.float64)
