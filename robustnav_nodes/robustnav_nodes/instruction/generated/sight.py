"""What can be seen from a place: straight lines past walls and furniture, everything a box."""

import math

import numpy as np

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.instruction.generated.dwelling import Dwelling, Thing, Vector3

SIGHT_M = 5.0
SMALLEST_SR = 0.002  # what fills less is overlooked
_LOOKS = 4  # points of a thing that are looked at
_MUST_SHOW = 2
_NEAR = 0.99  # of the way to a point: what stands right at it does not hide it


class Sight:
    """Answers for one dwelling."""

    def __init__(self, dwelling: Dwelling) -> None:
        self._things = dwelling.things
        hiding = [thing for thing in dwelling.things if thing.is_in_the_way]
        corners = [*dwelling.walls.tolist(), *([thing.low_m, thing.high_m] for thing in hiding)]
        self._boxes = np.array(corners).reshape(-1, 2, 3)
        self._owner = np.array([-1] * len(dwelling.walls) + [thing.number for thing in hiding])

    def in_sight(self, camera_m: Vector3) -> tuple[int, ...]:
        """Numbers of the things that show from there, up to SIGHT_M away and at least SMALLEST_SR large."""
        eye = np.array(camera_m)
        near = [
            thing
            for thing in self._things
            if math.dist(thing.centre_m, camera_m) <= SIGHT_M
            and apparent_size_sr(thing, camera_m) >= SMALLEST_SR
        ]
        if not near:
            return ()
        points = np.concatenate([_points(thing, eye) for thing in near])
        hidden = self._hidden(eye, points)
        own = np.repeat([thing.number for thing in near], _LOOKS)
        carrier = np.repeat([-2 if t.stands_on is None else t.stands_on for t in near], _LOOKS)
        hidden &= (self._owner != own[:, None]) & (self._owner != carrier[:, None])
        shown = (~hidden.any(axis=1)).reshape(-1, _LOOKS).sum(axis=1) >= _MUST_SHOW
        return tuple(thing.number for thing, shows in zip(near, shown, strict=True) if shows)

    def _hidden(self, eye: Float64, points: Float64) -> Bool:
        """[points, boxes]: whether the box is met on the way to the point."""
        way = points - eye
        way = np.where(np.abs(way) < 1e-9, 1e-9, way)
        enter = np.full((len(points), len(self._boxes)), -np.inf)
        leave = np.full((len(points), len(self._boxes)), np.inf)
        for axis in range(3):
            share = 1.0 / way[:, axis, None]
            first = (self._boxes[:, 0, axis] - eye[axis]) * share
            second = (self._boxes[:, 1, axis] - eye[axis]) * share
            np.maximum(enter, np.minimum(first, second), out=enter)
            np.minimum(leave, np.maximum(first, second), out=leave)
        return np.asarray((enter < leave) & (leave > 0.0) & (enter < _NEAR))


def apparent_size_sr(thing: Thing, camera_m: Vector3) -> float:
    """About the solid angle that it fills when nothing hides it."""
    (a, b, c), (A, B, C) = thing.low_m, thing.high_m
    x, y, z = thing.centre_m
    away_x, away_y, away_z = abs(x - camera_m[0]), abs(y - camera_m[1]), abs(z - camera_m[2])
    range_m = max(math.hypot(away_x, away_y, away_z), 0.3)
    faces = away_x * (B - b) * (C - c) + away_y * (A - a) * (C - c) + away_z * (A - a) * (B - b)
    return min(faces / range_m**3, 4.0)


def _points(thing: Thing, eye: Float64) -> Float64:
    """The middle, the middle of the top, and both flanks as seen from `eye`, [4, 3]."""
    middle = np.array(thing.centre_m)
    half = np.subtract(thing.high_m, thing.low_m) / 2.0
    away = middle - eye
    flank = np.array([-away[1], away[0], 0.0])
    flank /= max(float(np.linalg.norm(flank)), 1e-9)
    reach = 0.7 * float(np.abs(flank) @ half) * flank
    top = middle + np.array([0.0, 0.0, 0.9 * half[2]])
    return np.array([middle, top, middle + reach, middle - reach])
