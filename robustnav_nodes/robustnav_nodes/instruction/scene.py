"""A trajectory as arrays: what a model looks at, viewpoint by viewpoint."""

import math
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import OBJECTS
from robustnav_nodes.instruction.mentions import concepts_of_name
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import ROOM_TYPES, Trajectory

TO_THE_END = 99  # steps, more than a walk has
FAR_M = 9.0  # stands for "not seen"
UNKNOWN_RANGE_M = 2.0  # a detector's object without a distance is near, or it would not have been seen
OBJECT_INDEX = {concept: k for k, concept in enumerate(OBJECTS)}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sightings:
    """All views of what goes by one name: at which viewpoint `at` int64 [n], how far `range_m` float64 [n],
    NaN where not known, and where `bearing_rad` float64 [n] on arriving there.
    """

    at: NDArray[np.int64]
    range_m: Float64
    bearing_rad: Float64


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Scene:
    """Arrays of a walk of T viewpoints, T >= 1; C object concepts in the order of OBJECTS.

    `range_m` [T, C]: of the nearest object of the concept, FAR_M where none is in sight; `bearing_rad` [T, C]
    its bearing on arriving, NaN where not known; `rooms` [T, 12]; `turn_rad` [T], positive to the left;
    `xyz_m` [T, 3]; `yaw_in_rad` [T]. `things` has every view with a bearing, nearer than
    FAR_M, by concept and by the detector's own name.
    """

    xyz_m: Float64
    yaw_in_rad: Float64
    turn_rad: Float64
    rooms: Float64
    range_m: Float64
    bearing_rad: Float64
    things: Mapping[str, Sightings]

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
    views: defaultdict[str, list[tuple[int, float, float]]] = defaultdict(list)
    for at, viewpoint in enumerate(viewpoints):
        xyz[at] = viewpoint.x_m, viewpoint.y_m, viewpoint.z_m
        yaw[at], turn[at], rooms[at] = viewpoint.yaw_in_rad, viewpoint.turn_rad, viewpoint.rooms
        for seen in viewpoint.objects:
            distance = UNKNOWN_RANGE_M if seen.range_m is None else seen.range_m
            concepts = concepts_of_name(seen.name)
            if seen.bearing_rad is not None and distance < FAR_M:
                known = math.nan if seen.range_m is None else seen.range_m
                for name in {_as_written(seen.name), *concepts}:
                    views[name].append((at, known, seen.bearing_rad))
            for concept in concepts:
                column = OBJECT_INDEX[concept]
                if distance < range_m[at, column]:
                    range_m[at, column] = distance
                    bearing[at, column] = math.nan if seen.bearing_rad is None else seen.bearing_rad
    return Scene(
        xyz_m=xyz,
        yaw_in_rad=yaw,
        turn_rad=turn,
        rooms=rooms,
        range_m=range_m,
        bearing_rad=bearing,
        things={name: _sightings(seen) for name, seen in views.items()},
    )


def way_ahead_m(scene: Scene, steps: int) -> tuple[Float64, Float64]:
    """(Ahead, to the left) [T] of the viewpoint so many steps on, or of the last one, as seen on arriving."""
    places = len(scene)
    x, y = (scene.xyz_m[np.minimum(np.arange(places) + steps, places - 1), :2] - scene.xyz_m[:, :2]).T
    cos, sin = np.cos(scene.yaw_in_rad), np.sin(scene.yaw_in_rad)
    # 0.0 is added since the bearing of (-0.0, 0.0), at the last viewpoint, would be half a turn
    return cos * x + sin * y + 0.0, cos * y - sin * x + 0.0


@cache
def _as_written(name: str) -> str:
    """A detector's name as people's words stand in an instruction: "Teddy_Bear" is "teddy bear" there."""
    return " ".join(tokenized(name.replace("_", " ")))


def _sightings(views: list[tuple[int, float, float]]) -> Sightings:
    table = np.array(views)
    return Sightings(at=table[:, 0].astype(np.int64), range_m=table[:, 1], bearing_rad=table[:, 2])
