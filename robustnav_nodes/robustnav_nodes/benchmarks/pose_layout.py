"""Coordinates for a pose graph that has none, so that it can be drawn."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse import csgraph

from robustnav_msgs_py.values import Float64
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action

_HEADINGS = 12  # where no pose can turn all around
_STEP_M = 0.30
_APART_M = 2.0  # between parts that no way joins
_ASIDE_M = 0.05


class Layout(NamedTuple):
    """Where a picture of the graph shows each pose: float64 [n] each, and how many turns make a full one."""

    x_m: Float64
    y_m: Float64
    yaw_rad: Float64
    headings: int


def lay_out(successors: NDArray[np.int32]) -> Layout:
    """Make up coordinates for a graph that has none (successors: int32 [n, 4], as in PoseGraph).

    Poses that turn into each other become one place; a move goes 0.30 m along the heading. The walk over
    the places is breadth first, so where two ways to a place disagree, the shorter one decides. No two poses
    come to lie on each other: a place that is taken, and what cannot be reached, is moved aside. The number
    of headings is the most frequent length of a full turn, or 12.
    """
    headings = _full_turn(successors)
    place, heading = _places(successors, headings)
    members = np.split(np.argsort(place, kind="stable"), np.cumsum(np.bincount(place))[:-1])
    turned = np.zeros(len(members), dtype=np.int64)  # to be added to the headings of a place's poses
    spot: dict[int, tuple[float, float]] = {}
    taken: set[tuple[int, int]] = set()
    for first in range(len(members)):
        if first in spot:
            continue
        farthest_m = max((x_m for x_m, _ in spot.values()), default=-_APART_M)
        spot[first] = _free_spot(farthest_m + _APART_M, 0.0, taken)
        queue = [first]
        for here in queue:
            for pose in members[here]:
                yaw_rad = (heading[pose] + turned[here]) * math.tau / headings
                for action, step_m in ((Action.FORWARD, _STEP_M), (Action.BACKWARD, -_STEP_M)):
                    end = successors[pose, action]
                    if end == NOWHERE or int(place[end]) in spot:
                        continue
                    there = int(place[end])
                    turned[there] = heading[pose] + turned[here] - heading[end]
                    x_m, y_m = spot[here]
                    x_m, y_m = x_m + step_m * math.cos(yaw_rad), y_m + step_m * math.sin(yaw_rad)
                    spot[there] = _free_spot(x_m, y_m, taken)
                    queue.append(there)
    return Layout(
        x_m=np.array([spot[here][0] for here in place.tolist()]),
        y_m=np.array([spot[here][1] for here in place.tolist()]),
        yaw_rad=np.asarray((heading + turned[place]) % headings * (math.tau / headings), dtype=np.float64),
        headings=headings,
    )


def _full_turn(successors: NDArray[np.int32]) -> int:
    """How many turns left most often lead back to where they began."""
    turns = _links(successors[:, [Action.TURN_LEFT]])
    _, label = csgraph.connected_components(turns, directed=True, connection="strong")
    length = np.bincount(label)
    return int(np.bincount(length[length > 2]).argmax()) if np.any(length > 2) else _HEADINGS


def _places(successors: NDArray[np.int32], headings: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The place that each pose belongs to, and its heading among the poses there: int64 [n] each.

    A pose that would come to have the heading of another one at its place begins a place of its own.
    """
    count = len(successors)
    place = np.full(count, NOWHERE, dtype=np.int64)
    heading = np.zeros(count, dtype=np.int64)
    places = 0
    for first in range(count):
        if place[first] != NOWHERE:
            continue
        place[first] = places
        held = {0}
        queue = [first]
        for pose in queue:
            for action, turn in ((Action.TURN_LEFT, 1), (Action.TURN_RIGHT, -1)):
                end = int(successors[pose, action])
                turned = int(heading[pose] + turn) % headings
                if end != NOWHERE and place[end] == NOWHERE and turned not in held:
                    place[end], heading[end] = places, turned
                    held.add(turned)
                    queue.append(end)
        places += 1
    return place, heading


def _free_spot(x_m: float, y_m: float, taken: set[tuple[int, int]]) -> tuple[float, float]:
    """(x_m, y_m), or the next free spot beside it; the spot is taken then."""
    while (cell := (round(x_m / _ASIDE_M), round(y_m / _ASIDE_M))) in taken:
        y_m += _ASIDE_M
    taken.add(cell)
    return x_m, y_m


def _links(ends: NDArray[np.int32]) -> sparse.csr_matrix:
    begins, column = np.nonzero(ends != NOWHERE)
    count = len(ends)
    return sparse.csr_matrix((np.ones(len(begins)), (begins, ends[begins, column])), shape=(count, count))
