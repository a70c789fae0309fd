"""The way from one place of a home to another, around walls and furniture."""

import itertools
import math
from collections.abc import Iterator

import numpy as np
import scipy.sparse
import scipy.sparse.csgraph
import scipy.spatial

from robustnav_msgs_py.errors import RobustnavError
from robustnav_msgs_py.values import Bool, Float64
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles

Point = tuple[float, float]

# Nearer to obstacles than this, a metre of way counts for more: up to (1 + CLOSENESS_COST) metres.
COMFORT_M = 0.35
CLOSENESS_COST = 3.0
# From a place between cells to the graph of cells.
JOIN_M = 0.30
NEIGHBOURS = ((0, 1), (1, 0), (1, 1), (1, -1))
# Kept besides the distance that the drive enforces, which would stop a robot that drives on the very limit.
SPARE_M = 0.005
SAME_M = 1e-3


class NoWayError(RobustnavError):
    """There is no way for the robot to the place."""


class RoutePlanner:
    """Shortest comfortable ways on the grid of clearances, pulled straight. Immutable."""

    def __init__(self, obstacles: Obstacles, grid: ClearanceGrid, keep_m: float) -> None:
        """`keep_m`: how far the robot's middle stays from everything."""
        self._obstacles = obstacles
        self._grid = grid
        self._keep_m = keep_m + SPARE_M
        self._free = grid.cells_m >= self._keep_m
        self._number = np.where(self._free, np.cumsum(self._free).reshape(self._free.shape) - 1, -1)
        rows, columns = np.nonzero(self._free)
        self._points: Float64 = np.stack([grid.x_m[columns], grid.y_m[rows]], axis=1)
        self._clearance: Float64 = grid.cells_m[self._free]
        self._graph = self._edges()

    def plan(self, start_m: Point, goal_m: Point) -> list[Point]:
        """Corners of the way, without the start, with the goal. Raises NoWayError with a sentence."""
        if self._obstacles.is_line_free(start_m, goal_m, self._keep_m):
            return [goal_m]
        first, last = self._joined(start_m), self._joined(goal_m)
        _, before = scipy.sparse.csgraph.dijkstra(
            self._graph, directed=False, indices=first, return_predecessors=True
        )
        path = [last]
        while path[-1] != first:
            previous = int(before[path[-1]])
            if previous < 0:
                raise NoWayError(f"there is no way from {_text(start_m)} to {_text(goal_m)}")
            path.append(previous)
        path.reverse()
        corners = [start_m, *(self._point(at) for at in path), goal_m]
        kept_m = [self._keep_m, *self._clearance[path].tolist(), self._keep_m]
        return self._straightened(corners, kept_m)

    def _joined(self, place_m: Point) -> int:
        """The nearest node that a straight move joins to the place."""
        distance = np.hypot(self._points[:, 0] - place_m[0], self._points[:, 1] - place_m[1])
        near = np.nonzero(distance <= JOIN_M)[0]
        for node in near[np.argsort(distance[near], kind="stable")].tolist():
            # The place itself may lie a hair closer to things than ways do.
            if self._obstacles.is_line_free(place_m, self._point(node), self._keep_m - SPARE_M):
                return int(node)
        raise NoWayError(f"the robot cannot drive to or from {_text(place_m)}: nothing free lies beside it")

    def _point(self, node: int) -> Point:
        return float(self._points[node, 0]), float(self._points[node, 1])

    def _edges(self) -> scipy.sparse.csr_matrix:
        """The graph of free cells and their free neighbours; weights in metres, more where it is narrow."""
        sources, targets = [], []
        height, width = self._free.shape
        for down, right in NEIGHBOURS:
            left, over = max(0, -right), max(0, right)
            here = (slice(0, height - down), slice(left, width - over))
            there = (slice(down, height), slice(left + right, width - over + right))
            both = self._free[here] & self._free[there]
            sources.append(self._number[here][both])
            targets.append(self._number[there][both])
        source, target = np.concatenate(sources), np.concatenate(targets)
        clearance = np.minimum(self._clearance[source], self._clearance[target])
        length = np.linalg.norm(self._points[source] - self._points[target], axis=1)
        # Between two cell centres the clearance falls by at most half their distance.
        certain = clearance - length / 2.0 >= self._keep_m
        passable = certain.copy()
        passable[~certain] = self._keeps_from_corners(
            self._points[source[~certain]], self._points[target[~certain]]
        )
        closeness = np.clip((COMFORT_M - clearance) / max(COMFORT_M - self._keep_m, 1e-3), 0.0, 1.0)
        weight = length * (1.0 + CLOSENESS_COST * closeness)
        size = len(self._points)
        return scipy.sparse.csr_matrix(
            (weight[passable], (source[passable], target[passable])), shape=(size, size)
        )

    def _keeps_from_corners(self, starts_m: Float64, ends_m: Float64) -> Bool:
        """Whether each move [n] between free neighbours keeps the distance all along.

        Both ends do, and a move is shorter than the distance kept: only the corner of a rectangle can come
        nearer to its middle than to its ends.
        """
        along_m = ends_m - starts_m
        length_m = np.linalg.norm(along_m, axis=1)
        corners_m = self._obstacles.corners_m
        keeps = np.ones(len(starts_m), dtype=bool)
        if not len(keeps) or not len(corners_m):
            return keeps
        near = scipy.spatial.cKDTree(corners_m).query_ball_point(
            (starts_m + ends_m) / 2.0, self._keep_m + length_m / 2.0, return_sorted=False
        )
        move = np.repeat(np.arange(len(near)), [len(corners) for corners in near])
        corner = np.fromiter(itertools.chain.from_iterable(near), dtype=np.intp, count=len(move))
        to_corner_m = corners_m[corner] - starts_m[move]
        ahead_m = (to_corner_m * along_m[move]).sum(axis=1) / length_m[move]
        aside_m = (
            np.abs(to_corner_m[:, 0] * along_m[move, 1] - to_corner_m[:, 1] * along_m[move, 0])
            / length_m[move]
        )
        meets = (ahead_m > 0.0) & (ahead_m < length_m[move]) & (aside_m < self._keep_m)
        keeps[move[meets]] = False
        return keeps

    def _straightened(self, corners: list[Point], kept_m: list[float]) -> list[Point]:
        """Fewer corners, without coming closer to anything than the way did where it was comfortable."""
        way = [corners[0]]
        for at in self._needed(corners, kept_m, 0, len(corners) - 1):
            # Start and goal may lie on a node of the graph: that is one corner, not two.
            if math.dist(way[-1], corners[at]) > SAME_M:
                way.append(corners[at])
        return way[1:] or [corners[-1]]

    def _needed(self, corners: list[Point], kept_m: list[float], first: int, last: int) -> Iterator[int]:
        """Indices after `first` up to `last` of the corners that remain."""
        radius_m = max(self._keep_m, min(COMFORT_M, *kept_m[first : last + 1]))
        if last - first <= 1 or self._obstacles.is_line_free(corners[first], corners[last], radius_m):
            yield last
            return
        start, end = corners[first], corners[last]
        furthest = max(range(first + 1, last), key=lambda at: _off(corners[at], start, end))
        yield from self._needed(corners, kept_m, first, furthest)
        yield from self._needed(corners, kept_m, furthest, last)


def _off(point: Point, start: Point, end: Point) -> float:
    """How far a point lies from the line, or from its start where both ends are one."""
    length_m = math.dist(start, end)
    if length_m == 0.0:
        return math.dist(point, start)
    along = (end[0] - start[0], end[1] - start[1])
    return abs(along[0] * (point[1] - start[1]) - along[1] * (point[0] - start[0])) / length_m


def _text(place_m: Point) -> str:
    return f"({place_m[0]:.2f}, {place_m[1]:.2f})"
