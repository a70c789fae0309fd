"""The pose graph G: where the robot can stand, which way it can look, and what one action leads to."""

import dataclasses
import math
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Float64, Pose2D
from robustnav_nodes.search_space.floor_grid import FloorGrid
from robustnav_nodes.search_space.lattice import Lattice, build_lattice, heading_steps
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

NOWHERE = -1


class Action(IntEnum):
    """What the robot can do in one step; the number is the column in `PoseGraph.successors`."""

    FORWARD = 0
    BACKWARD = 1
    TURN_LEFT = 2
    TURN_RIGHT = 3

    @property
    def text(self) -> str:
        """The name as people read it, "turn left"."""
        return self.name.lower().replace("_", " ")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PoseGraph:
    """Graph G (thesis 3.2.1.3): n poses and the pose that each action leads to.

    x_m, y_m, yaw_rad: float64 [n], in the map's frame, yaw in 0..2 pi. Poses of one place have the same x_m
    and y_m, to the last bit.
    successors: int32 [n, 4], one column per Action, NOWHERE (-1) where the robot does not fit.
    headings: how many turns make a full one; a place may lack some of these poses.
    """

    x_m: Float64
    y_m: Float64
    yaw_rad: Float64
    successors: NDArray[np.int32]
    headings: int

    def __len__(self) -> int:
        return len(self.x_m)

    def pose(self, index: int) -> Pose2D:
        """Pose number `index`."""
        return Pose2D(
            x_m=float(self.x_m[index]), y_m=float(self.y_m[index]), yaw_rad=float(self.yaw_rad[index])
        )

    def nearest(self, pose: Pose2D) -> int:
        """The pose at the place nearest to `pose` (straight line) with the heading nearest to its own."""
        dx, dy = self.x_m - pose.x_m, self.y_m - pose.y_m
        there = self._poses_beside(int(np.argmin(dx * dx + dy * dy)))
        turn_rad = np.abs(np.remainder(self.yaw_rad[there] - pose.yaw_rad + math.pi, math.tau) - math.pi)
        return int(there[np.argmin(turn_rad)])

    def legal_actions(self, index: int) -> tuple[Action, ...]:
        """The actions that lead somewhere from pose `index`."""
        return tuple(action for action in Action if self.successors[index, action] != NOWHERE)

    def largest_part(self) -> int:
        """A pose of the largest set of poses that can all reach each other."""
        _, part = csgraph.connected_components(self._links(), directed=True, connection="strong")
        return int(np.argmax(part == np.bincount(part).argmax()))

    def steps_from(self, start: int) -> Float64:
        """float64 [n]: fewest actions from `start` to each pose, +Inf where there is no way."""
        steps = csgraph.dijkstra(self._links(), indices=start, unweighted=True)
        return np.asarray(steps, dtype=np.float64)

    def shortest_path(self, start: int, goal: int) -> tuple[int, ...] | None:
        """Poses from `start` to `goal`, both included, by the fewest actions (Dijkstra); None: no way."""
        _, before = csgraph.dijkstra(self._links(), indices=start, unweighted=True, return_predecessors=True)
        path = [goal]
        while path[-1] != start:
            previous = int(before[path[-1]])
            if previous < 0:
                return None
            path.append(previous)
        return tuple(reversed(path))

    def without_way(self, a: int, b: int) -> "PoseGraph":
        """This graph without the way between the places of poses `a` and `b`, whatever the heading.

        Where both are the same place, only the turn between these two poses goes.
        """
        successors = self.successors.copy()
        rows_a, rows_b = self._poses_beside(a), self._poses_beside(b)
        if b in rows_a:
            rows_a, rows_b = np.array([a]), np.array([b])
        for begins, ends in ((rows_a, rows_b), (rows_b, rows_a)):
            links = successors[begins]
            successors[begins] = np.where(np.isin(links, ends), NOWHERE, links)
        return dataclasses.replace(self, successors=successors)

    def _poses_beside(self, index: int) -> NDArray[np.int64]:
        """int64 [m]: the poses at the place of pose `index`, itself among them."""
        return np.nonzero((self.x_m == self.x_m[index]) & (self.y_m == self.y_m[index]))[0]

    def _links(self) -> sparse.csr_matrix:
        begins, action = np.nonzero(self.successors != NOWHERE)
        ends = self.successors[begins, action]
        count = len(self)
        return sparse.csr_matrix((np.ones(len(ends)), (begins, ends)), shape=(count, count))


def build_pose_graph(
    grid: FloorGrid, parameters: SearchSpaceParameters, start: Pose2D | None = None
) -> PoseGraph:
    """The poses of the lattice on `grid` where the robot fits; of those, what `start` can reach if given.

    Raises BadMapError where the robot fits nowhere, starts too far from where it fits, or where there are
    more than `max_poses` poses.
    """
    lattice = build_lattice(grid, parameters.spacing_m, parameters.robot_radius_m)
    if len(lattice) == 0:
        raise BadMapError(
            f"a robot of radius {parameters.robot_radius_m:g} m fits nowhere on the lattice of "
            f"{parameters.spacing_m:g} m: lower robot_radius_m or spacing_m, or clean the map of specks"
        )
    steps = heading_steps(parameters.headings)
    if start is not None:
        lattice = lattice.kept(lattice.component(_start_place(lattice, start, parameters), steps))
    poses = len(lattice) * parameters.headings
    if poses > parameters.max_poses:
        raise BadMapError(
            f"the map holds {len(lattice)} places x {parameters.headings} headings = {poses} poses, more "
            f"than max_poses = {parameters.max_poses}: crop the map, or raise spacing_m "
            f"({parameters.spacing_m:g} m) or max_poses"
        )
    return _graph_on(lattice, steps)


def _start_place(lattice: Lattice, start: Pose2D, parameters: SearchSpaceParameters) -> int:
    distance = np.hypot(lattice.x_m - start.x_m, lattice.y_m - start.y_m)
    place = int(np.argmin(distance))
    if distance[place] > parameters.max_start_distance_m:
        raise BadMapError(
            f"the robot is at ({start.x_m:.2f}, {start.y_m:.2f}) m, {distance[place]:.2f} m from the nearest "
            f"place where it fits (at most max_start_distance_m = {parameters.max_start_distance_m:g} m): is "
            "it localised in this map, and is robot_radius_m right?"
        )
    return place


def _graph_on(lattice: Lattice, steps: NDArray[np.int64]) -> PoseGraph:
    headings, places = len(steps), len(lattice)
    place = np.arange(places, dtype=np.int64)
    successors = np.full((places, headings, len(Action)), NOWHERE, dtype=np.int32)
    for heading, (column, row) in enumerate(steps):
        ahead = lattice.neighbour[:, 1 + row, 1 + column]
        behind = lattice.neighbour[:, 1 - row, 1 - column]
        successors[:, heading, Action.FORWARD] = np.where(ahead >= 0, ahead * headings + heading, NOWHERE)
        successors[:, heading, Action.BACKWARD] = np.where(behind >= 0, behind * headings + heading, NOWHERE)
        successors[:, heading, Action.TURN_LEFT] = place * headings + (heading + 1) % headings
        successors[:, heading, Action.TURN_RIGHT] = place * headings + (heading - 1) % headings
    return PoseGraph(
        x_m=np.repeat(lattice.x_m, headings),
        y_m=np.repeat(lattice.y_m, headings),
        yaw_rad=np.tile(np.arange(headings) * (math.tau / headings), places),
        successors=successors.reshape(places * headings, len(Action)),
        headings=headings,
    )
