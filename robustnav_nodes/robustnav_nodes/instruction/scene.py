"""A trajectory as arrays: what a model looks at, viewpoint by viewpoint."""

import math
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import OBJECTS
from robustnav_nodes.instruction.mentions import concepts_of_name
from robustnav_nodes.instruction.trajectory import ROOM_TYPES, Trajectory

FAR_M = 9.0  # stands for "not seen"
_UNKNOWN_RANGE_M = 2.0  # a detector's object without a distance is near, or it would not have been seen
OBJECT_INDEX = {concept: k for k, concept in enumerate(OBJECTS)}


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Arrays of a walk of T viewpoints, T >= 1; C object concepts in the order of OBJECTS.

    `range_m` [T, C]: of the nearest object of the concept, FAR_M where none is in sight; `bearing_rad` [T, C]
    its bearing on arriving, NaN where not known; `rooms` [T, 12]; `turn_rad` [T], positive to the left;
    `xyz_m` [T, 3]; `yaw_in_rad` [T].
    """

    xyz_m: Float64
    yaw_in_rad: Float64
    turn_rad: Float64
    rooms: Float64
    range_m: Float64
    bearing_rad: Float64

    def __len__(self) -> int:
        return len(self.turn_rad)


def scene_of(trajectory: Trajectory) -> Scene:
    """The arrays of a trajectory; one without viewpoints is a robot that stands and has seen nothing."""
    viewpoints = trajectory.viewpoints
    count = max(1, len(viewpoints))
    range_m = np.full((count, len(OBJECT_INDEX)), FAR_M)
    bearing = np.full((count, len(OBJECT_INDEX)), math.nan)
    rooms = np.full((count, len(ROOM_TYPES)), 1.0 / len(ROOM_TYPES))
    xyz, yaw, turn = np.zeros((count, 3)), np.zeros(count), np.zeros(count)
    for at, viewpoint in enumerate(viewpoints):
        xyz[at] = viewpoint.x_m, viewpoint.y_m, viewpoint.z_m
        yaw[at], turn[at], rooms[at] = viewpoint.yaw_in_rad, viewpoint.turn_rad, viewpoint.rooms
        for seen in viewpoint.objects:
            distance = _UNKNOWN_RANGE_M if seen.range_m is None else seen.range_m
            for concept in concepts_of_name(seen.name):
                column = OBJECT_INDEX[concept]
                if distance < range_m[at, column]:
                    range_m[at, column] = distance
                    bearing[at, column] = math.nan if seen.bearing_rad is None else seen.bearing_rad
    return Scene(xyz_m=xyz, yaw_in_rad=yaw, turn_rad=turn, rooms=rooms, range_m=range_m, bearing_rad=bearing)
