"""A plan for rollouts to follow from wherever they begin: from best viewpoint to best viewpoint."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_nodes.planner.viewpoints import (
    NONE,
    Outlook,
    Place,
    best_viewpoint,
    empty_reach,
    look_from,
)
from robustnav_nodes.search_space.compiled import compiled
from robustnav_nodes.search_space.pose_graph import NOWHERE

Int32 = NDArray[np.int32]


class Guide(NamedTuple):
    """Viewpoints in the order in which to visit them, and the way to each from every pose.

    goals: int32 [g]; towards: int32 [g, n], the next pose from each pose, NOWHERE at the goal and where there
    is no way to it.
    """

    goals: Int32
    towards: Int32


NO_GUIDE = Guide(goals=np.zeros(0, dtype=np.int32), towards=np.zeros((0, 0), dtype=np.int32))


def guide_from(place: Place, outlook: Outlook, start: int, most_goals: int) -> Guide:
    """The greedy plan from pose `start`, the most unseen belief per step, to at most `most_goals` viewpoints.

    Takes what is in view on the way out of `outlook`: in simulated searches the detector misses nothing.
    """
    reach = empty_reach(len(outlook.gain))
    pose = start
    goals: list[int] = []
    towards: list[Int32] = []
    while len(goals) < most_goals:
        goal = best_viewpoint(place, outlook, reach, pose, float(outlook.gain.max()))
        if goal == NONE:
            break
        goals.append(goal)
        towards.append(ways_to(place.successors, goal))
        while pose != goal:
            pose = int(towards[-1][pose])
            look_from(place, outlook, pose, 1.0)
    if not goals:
        return NO_GUIDE
    return Guide(goals=np.array(goals, dtype=np.int32), towards=np.stack(towards))


@compiled
def ways_to(successors: Int32, goal: int) -> Int32:
    """int32 [n]: from each of n poses the next one on a shortest way to `goal` (see Guide)."""
    poses, actions = successors.shape
    start = np.zeros(poses + 1, dtype=np.int64)  # the ways the other way round, sorted by where they lead
    for pose in range(poses):
        for action in range(actions):
            if successors[pose, action] != NOWHERE:
                start[successors[pose, action] + 1] += 1
    for pose in range(poses):
        start[pose + 1] += start[pose]
    before = np.empty(start[poses], dtype=np.int32)
    filled = start[:-1].copy()
    for pose in range(poses):
        for action in range(actions):
            after = successors[pose, action]
            if after != NOWHERE:
                before[filled[after]] = pose
                filled[after] += 1

    towards = np.full(poses, NOWHERE, dtype=np.int32)
    queue = np.empty(poses, dtype=np.int32)
    queue[0] = goal
    first, end = 0, 1
    while first < end:
        after = queue[first]
        first += 1
        for way in range(start[after], start[after + 1]):
            pose = before[way]
            if pose != goal and towards[pose] == NOWHERE:
                towards[pose] = after
                queue[end] = pose
                end += 1
    return towards
