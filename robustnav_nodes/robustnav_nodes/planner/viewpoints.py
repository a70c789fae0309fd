"""What every pose would show of what is still unseen, and thinking ahead along the ways to the best of them.

A robot that has not found its target yet has seen nothing but misses, so until the next detection a plan is
a fixed way, and its worth follows from the belief itself without drawing where the target is: a pose gives
what its view holds of the belief, times the recall, and leaves the rest for later views. Each pose gives
once, since a second look from the same pose repeats the first.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.search_space.compiled import compiled
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE, PoseGraph

Int32 = NDArray[np.int32]
NONE = -1
_NEGLIGIBLE = 1e-9  # mass


class Place(NamedTuple):
    """What does not change: the ways, and who sees what (see PoseGraph and Observability)."""

    successors: Int32
    seen_start: NDArray[np.int64]
    seen: Int32
    seers_start: NDArray[np.int64]
    seers: Int32


class Outlook(NamedTuple):
    """What is still to be seen. mass: float64 [k], belief not yet seen; gain: float64 [n], the mass that each
    pose has in view, 0 or less where the robot has looked from; looked: bool [n].
    """

    mass: Float64
    gain: Float64
    looked: Bool


class Reach(NamedTuple):
    """Scratch of a breadth-first walk. queue: int32 [n], poses by distance; parent, distance: int32 [n];
    round: int32 [n], the walk that reached the pose last; walks: int32 [1], walks so far.
    """

    queue: Int32
    parent: Int32
    distance: Int32
    round: Int32
    walks: Int32


def place_of(graph: PoseGraph, observability: Observability) -> Place:
    """The compiled loops' form of a search space."""
    return Place(
        successors=graph.successors,
        seen_start=observability.seen_start,
        seen=observability.seen,
        seers_start=observability.seers_start,
        seers=observability.seers,
    )


def empty_reach(poses: int) -> Reach:
    """Scratch for walks over `poses` poses."""
    queue, parent, distance, last_round = (np.zeros(poses, dtype=np.int32) for _ in range(4))
    return Reach(queue, parent, distance, last_round, np.zeros(1, dtype=np.int32))


@compiled
def outlook_on(place: Place, mass: Float64, looked: Bool) -> Outlook:
    """The outlook on `mass` (float64 [k]), which is kept and changed, from poses not `looked` from."""
    poses = len(looked)
    gain = np.zeros(poses)
    for pose in range(poses):
        if not looked[pose]:
            for sight in range(place.seen_start[pose], place.seen_start[pose + 1]):
                gain[pose] += mass[place.seen[sight]]
    return Outlook(mass, gain, looked)


@compiled
def look_from(place: Place, outlook: Outlook, pose: int, recall: float) -> float:
    """The mass that a look from `pose` detects; it is taken out of the outlook."""
    if outlook.looked[pose]:
        return 0.0
    outlook.looked[pose] = True
    detected = 0.0
    for sight in range(place.seen_start[pose], place.seen_start[pose + 1]):
        candidate = place.seen[sight]
        taken = recall * outlook.mass[candidate]
        if taken > 0.0:
            detected += taken
            outlook.mass[candidate] -= taken
            for seer in range(place.seers_start[candidate], place.seers_start[candidate + 1]):
                outlook.gain[place.seers[seer]] -= taken
    outlook.gain[pose] = 0.0
    return detected


@compiled
def _begin_walk(reach: Reach, start: int) -> int:
    """Begin a breadth-first walk at `start`; gives the length of its queue."""
    reach.walks[0] += 1
    reach.round[start], reach.distance[start], reach.parent[start] = reach.walks[0], 0, NONE
    reach.queue[0] = start
    return 1


@compiled
def _walk_on(place: Place, reach: Reach, pose: int, end: int) -> int:
    """Queue what one action from `pose` leads to for the first time; gives the new length of the queue."""
    for action in range(place.successors.shape[1]):
        after = place.successors[pose, action]
        if after != NOWHERE and reach.round[after] != reach.walks[0]:
            reach.round[after] = reach.walks[0]
            reach.distance[after] = reach.distance[pose] + 1
            reach.parent[after] = pose
            reach.queue[end] = after
            end += 1
    return end


@compiled
def best_viewpoint(place: Place, outlook: Outlook, reach: Reach, start: int, most: float) -> int:
    """The pose with the most gain per step on the way there, NONE where nothing is left; its way in `reach`.

    most: no gain is larger; the walk ends where no pose farther away could be better.
    """
    first, end = 0, _begin_walk(reach, start)
    best, best_ratio = NONE, _NEGLIGIBLE
    while first < end:
        pose = reach.queue[first]
        first += 1
        distance = reach.distance[pose]
        if distance > 0:
            if best_ratio * distance >= most:
                break
            ratio = outlook.gain[pose] / distance
            if ratio > best_ratio and not outlook.looked[pose]:
                best, best_ratio = pose, ratio
        end = _walk_on(place, reach, pose, end)
    return best


@compiled
def worth_of_way(
    place: Place,
    outlook: Outlook,
    reach: Reach,
    way: Int32,
    recall: float,
    worth: Float64,
    most: float,
) -> float:
    """Worth of taking `way` (int32 [w], poses after the start) and then going from best viewpoint to best.

    worth: float64 [s + 1], what a detection after 0, 1, ... s steps is worth, per mass. Takes what is seen
    out of `outlook`.
    """
    total, step, last = 0.0, 0, len(worth) - 1
    for pose in way:
        if step == last:
            return total
        step += 1
        total += worth[step] * look_from(place, outlook, pose, recall)
    pose = way[-1]
    onward = np.empty(last, dtype=np.int32)
    while step < last:
        goal = best_viewpoint(place, outlook, reach, pose, most)
        if goal == NONE:
            break
        length = reach.distance[goal]
        at = goal
        for back in range(length - 1, -1, -1):
            if back < last:
                onward[back] = at
            at = reach.parent[at]
        for ahead in range(min(length, last - step)):
            step += 1
            pose = onward[ahead]
            total += worth[step] * look_from(place, outlook, pose, recall)
    return total


@compiled
def walk_everywhere(place: Place, reach: Reach, start: int) -> int:
    """Walk from `start` to all that it reaches, nearest first; gives how many poses these are, with it."""
    first, end = 0, _begin_walk(reach, start)
    while first < end:
        pose = reach.queue[first]
        first += 1
        end = _walk_on(place, reach, pose, end)
    return end


def way_to(reach: Reach, goal: int) -> Int32:
    """int32 [w]: the poses after the start of the last walk, up to `goal`."""
    way = []
    while reach.parent[goal] != NONE:
        way.append(goal)
        goal = int(reach.parent[goal])
    return np.array(way[::-1], dtype=np.int32)


@compiled
def first_sight_distance(place: Place, reach: Reach, reached: int) -> Float64:
    """float64 [k]: steps from the start of the last walk to a view of each candidate, +Inf for none."""
    distance = np.full(len(place.seers_start) - 1, np.inf)
    for position in range(reached - 1, -1, -1):
        pose = reach.queue[position]
        for sight in range(place.seen_start[pose], place.seen_start[pose + 1]):
            distance[place.seen[sight]] = reach.distance[pose]
    return distance
