"""The triangles around boxes, cylinders and balls; round ones are polygons with more sides where larger."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64
from sim_bridge.homes.shapes import Axis, Part, Shape

Int32 = NDArray[np.int32]

# Faces, as the rasteriser numbers them: a flat one looks along an axis of its item, the others are round.
WEST, EAST, SOUTH, NORTH, BOTTOM, TOP, MANTLE, GLOBE = range(8)

# Sides of a cylinder, and of a ball around and from pole to pole, up to a diameter.
_SIDES: tuple[tuple[float, int, int], ...] = ((0.03, 8, 6), (0.10, 14, 8), (0.30, 20, 10), (math.inf, 32, 14))


class Hull(NamedTuple):
    """The triangles of a primitive whose half extents are 1."""

    vertices: Float64  # [n, 3]
    triangles: Int32  # [m, 3]
    faces: Int32  # [m]


def hull_of(part: Part) -> Hull:
    """The triangles of the primitive that a part is; corners run counter-clockwise as seen from outside."""
    if part.shape is Shape.BOX:
        return _box_hull()
    around, stacks = next(sides for up_to_m, *sides in _SIDES if part.size_m[part.axis.others[0]] <= up_to_m)
    return _cylinder_hull(around, part.axis) if part.shape is Shape.CYLINDER else _ball_hull(around, stacks)


@cache
def _box_hull() -> Hull:
    vertices: list[list[float]] = []
    triangles: list[tuple[int, int, int]] = []
    for face in range(6):
        out = np.zeros(3)
        out[face // 2] = 2 * (face % 2) - 1
        # Two edge directions whose cross product points outwards: the corners then run counter-clockwise.
        first = np.roll(out, 1)
        second = np.cross(out, first)
        at = len(vertices)
        vertices += [(out + a * first + b * second).tolist() for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        triangles += [(at, at + 1, at + 2), (at, at + 2, at + 3)]
    return Hull(np.array(vertices), np.array(triangles, dtype=np.int32), np.arange(12, dtype=np.int32) // 2)


def _stretched(around: int) -> float:
    """The radius of a polygon that lies as far out of the circle of radius 1 as it lies inside it."""
    return 2.0 / (1.0 + math.cos(math.pi / around))


@cache
def _cylinder_hull(around: int, axis: Axis) -> Hull:
    angles = np.arange(around) * math.tau / around
    radius = _stretched(around)
    ring = np.stack([radius * np.cos(angles), radius * np.sin(angles), np.ones(around)], axis=1)
    upright = np.concatenate([ring * (1.0, 1.0, -1.0), ring])
    here = np.arange(around)
    there = (here + 1) % around
    fan = np.stack([np.zeros(around - 2, dtype=int), here[1:-1], there[1:-1]], axis=1)
    triangles = np.concatenate(
        [
            np.stack([here, there, there + around], axis=1),
            np.stack([here, there + around, here + around], axis=1),
            fan[:, ::-1],
            fan + around,
        ]
    )
    faces = np.repeat([MANTLE, 2 * axis, 2 * axis + 1], [2 * around, around - 2, around - 2])
    # Rolling the axes x, y, z on by one or two keeps the corners counter-clockwise.
    return Hull(np.roll(upright, axis + 1, axis=1), triangles.astype(np.int32), faces.astype(np.int32))


@cache
def _ball_hull(around: int, stacks: int) -> Hull:
    angles = np.arange(around) * math.tau / around
    heights = np.arange(1, stacks) * math.pi / stacks
    radius = _stretched(around)
    rings = [
        np.stack(
            [
                radius * math.sin(height) * np.cos(angles),
                radius * math.sin(height) * np.sin(angles),
                np.full(around, -radius * math.cos(height)),
            ],
            axis=1,
        )
        for height in heights
    ]
    vertices = np.concatenate([*rings, [(0.0, 0.0, -1.0), (0.0, 0.0, 1.0)]])
    south, north = len(vertices) - 2, len(vertices) - 1
    here = np.arange(around)
    there = (here + 1) % around
    triangles = [np.stack([np.full(around, south), there, here], axis=1)]
    for low in range(0, (stacks - 2) * around, around):
        high = low + around
        triangles += [
            np.stack([here + low, there + low, there + high], axis=1),
            np.stack([here + low, there + high, here + high], axis=1),
        ]
    last = (stacks - 2) * around
    triangles.append(np.stack([here + last, there + last, np.full(around, north)], axis=1))
    corners = np.concatenate(triangles).astype(np.int32)
    return Hull(vertices, corners, np.full(len(corners), GLOBE, dtype=np.int32))
