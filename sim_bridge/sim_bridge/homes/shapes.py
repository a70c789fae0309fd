"""What everything in a home is made of: boxes, cylinders and balls of some material."""

import math
from dataclasses import dataclass, replace
from enum import IntEnum, StrEnum

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.values import Float64
from sim_bridge.homes.materials import Material

Vector3 = tuple[float, float, float]

NEVER = np.inf


class Shape(StrEnum):
    """The primitive a part is."""

    BOX = "box"
    CYLINDER = "cylinder"
    BALL = "ball"


class Axis(IntEnum):
    """The item's axis along which a cylinder lies."""

    X = 0
    Y = 1
    Z = 2

    @property
    def others(self) -> tuple[int, int]:
        """The numbers of the two axes across it."""
        return ((1, 2), (0, 2), (0, 1))[self]


@dataclass(frozen=True, slots=True, kw_only=True)
class Part:
    """One primitive of a piece of furniture or of an object.

    `centre_m` is in the item's own frame, whose origin lies below its middle, on what it stands on;
    `size_m` is the extent along the item's x, y, z. A cylinder lies along `axis` and has equal extents along
    the other two; a ball has three equal ones.
    """

    shape: Shape
    centre_m: Vector3
    size_m: Vector3
    material: Material
    axis: Axis = Axis.Z

    def __post_init__(self) -> None:
        if not all(math.isfinite(length) and length > 0.0 for length in self.size_m):
            raise BadSceneError(f"a part's sizes must be positive, not {self.size_m!r}")
        around = self.size_m if self.shape is Shape.BALL else [self.size_m[at] for at in self.axis.others]
        if self.shape is not Shape.BOX and len(set(around)) > 1:
            raise BadSceneError(f"a {self.shape} has equal extents, not {self.size_m!r}")


def box(centre_m: Vector3, size_m: Vector3, material: Material) -> Part:
    """A box around `centre_m`."""
    return Part(shape=Shape.BOX, centre_m=centre_m, size_m=size_m, material=material)


def cylinder(
    centre_m: Vector3, diameter_m: float, height_m: float, material: Material, axis: Axis = Axis.Z
) -> Part:
    """A cylinder around `centre_m`, `height_m` long along `axis`: upright unless told otherwise."""
    size_m = [diameter_m] * 3
    size_m[axis] = height_m
    return Part(
        shape=Shape.CYLINDER,
        centre_m=centre_m,
        size_m=(size_m[0], size_m[1], size_m[2]),
        material=material,
        axis=axis,
    )


def ball(centre_m: Vector3, diameter_m: float, material: Material) -> Part:
    """A ball around `centre_m`."""
    return Part(shape=Shape.BALL, centre_m=centre_m, size_m=(diameter_m,) * 3, material=material)


def scaled(parts: tuple[Part, ...], factor: float) -> tuple[Part, ...]:
    """The parts, `factor` times as large, about the item's origin."""
    return tuple(
        replace(
            part,
            centre_m=(part.centre_m[0] * factor, part.centre_m[1] * factor, part.centre_m[2] * factor),
            size_m=(part.size_m[0] * factor, part.size_m[1] * factor, part.size_m[2] * factor),
        )
        for part in parts
    )


def extent(parts: tuple[Part, ...]) -> tuple[Vector3, Vector3]:
    """Lowest and highest corner (m, item's frame) of the box around all parts."""
    centres = np.array([part.centre_m for part in parts])
    halves = np.array([part.size_m for part in parts]) / 2.0
    low, high = (centres - halves).min(axis=0), (centres + halves).max(axis=0)
    return (float(low[0]), float(low[1]), float(low[2])), (float(high[0]), float(high[1]), float(high[2]))


def first_hit_m(parts: tuple[Part, ...], origin_m: Float64, directions: Float64) -> Float64:
    """How far along each ray the parts are first met.

    `origin_m` [3] and unit `directions` [n, 3] are in the item's frame; the result [n] is in metres, inf
    where a ray misses every part.
    """
    nearest = np.full(len(directions), NEVER)
    for part in parts:
        # The formulas are for what stands upright: a lying cylinder is turned, with the rays.
        order = [*part.axis.others, int(part.axis)]
        start = (origin_m - np.asarray(part.centre_m))[order]
        hit = _HIT[part.shape](start, directions[:, order], np.asarray(part.size_m)[order] / 2.0)
        np.minimum(nearest, hit, out=nearest)
    return nearest


def _slab(start: Float64, direction: Float64, half: Float64) -> tuple[Float64, Float64]:
    """Where rays enter and leave -half..half, per axis; parallel rays outside never enter."""
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (-half - start) / direction
        b = (half - start) / direction
    low, high = np.fmin(a, b), np.fmax(a, b)
    parallel = direction == 0.0
    inside = np.abs(start) <= half
    low = np.where(parallel, np.where(inside, -NEVER, NEVER), low)
    high = np.where(parallel, np.where(inside, NEVER, -NEVER), high)
    return low, high


def _first(enter: Float64, leave: Float64) -> Float64:
    return np.where((enter <= leave) & (enter > 0.0), enter, NEVER)


def _box_hit(start: Float64, directions: Float64, half: Float64) -> Float64:
    low, high = _slab(start, directions, half)
    return _first(low.max(axis=1), high.min(axis=1))


def _round(start: Float64, directions: Float64, radius: float) -> tuple[Float64, Float64]:
    """Where rays enter and leave a circle (2 axes) or ball (3 axes) around 0."""
    a = (directions * directions).sum(axis=1)
    b = directions @ start
    c = float(start @ start) - radius * radius
    discriminant = b * b - a * c
    meets = (discriminant >= 0.0) & (a > 0.0)
    root = np.sqrt(np.where(meets, discriminant, 0.0))
    scale = np.where(a > 0.0, a, 1.0)
    # A ray along the cylinder's axis has a = 0: it is inside all the way, or never.
    inside = (a == 0.0) & (c <= 0.0)
    enter = np.where(meets, (-b - root) / scale, np.where(inside, -NEVER, NEVER))
    leave = np.where(meets, (-b + root) / scale, np.where(inside, NEVER, -NEVER))
    return enter, leave


def _cylinder_hit(start: Float64, directions: Float64, half: Float64) -> Float64:
    enter, leave = _round(start[:2], directions[:, :2], float(half[0]))
    low, high = _slab(start[2:], directions[:, 2:], half[2:])
    return _first(np.maximum(enter, low[:, 0]), np.minimum(leave, high[:, 0]))


def _ball_hit(start: Float64, directions: Float64, half: Float64) -> Float64:
    return _first(*_round(start, directions, float(half[0])))


_HIT = {Shape.BOX: _box_hit, Shape.CYLINDER: _cylinder_hit, Shape.BALL: _ball_hit}
