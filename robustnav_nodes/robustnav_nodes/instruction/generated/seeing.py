"""A detector's view of a place: most things that are in sight, some misnamed, now and then one too many."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_nodes.instruction.generated.dwelling import DOOR, Dwelling, Thing, Vector3
from robustnav_nodes.instruction.generated.sight import apparent_size_sr

RECALL, DOOR_RECALL = 0.87, 0.7
P_MISNAMED = 0.03
MADE_UP_A_PLACE = 0.25  # things on average that are not there
_ANGLE_SIGMA_RAD = 0.02
_SIZE_SIGMA = 0.15  # of the logarithm
# What a detector mistakes for one another; a name that stands nowhere here is mistaken for any.
_ALIKE = (
    ("couch", "armchair", "bed", "bench", "ottoman"),
    ("dining table", "coffee table", "side table", "console table", "desk", "kitchen counter"),
    ("dresser", "cabinet", "wardrobe", "nightstand", "bookshelf", "shelf", "sink cabinet"),
    ("chair", "stool", "armchair", "office chair"),
    ("picture", "mirror", "window", "tv", "clock"),
    ("plant", "flower vase", "lamp", "statue"),
    ("washing machine", "dryer", "dishwasher", "stove", "microwave", "refrigerator"),
    ("door", "window", "mirror", "wardrobe"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Sighting:
    """A thing as it is reported from one place. Yaw and elevation in radians, in the dwelling's frame.

    `number` is the thing's; of what is made up it counts on from the last thing of the dwelling.
    """

    number: int
    name: str
    yaw_rad: float
    elevation_rad: float
    size_sr: float
    width_m: float
    height_m: float
    position_m: Vector3


def look_around(
    dwelling: Dwelling,
    camera_m: Vector3,
    in_sight: Sequence[int],
    first_made_up: int,
    rng: np.random.Generator,
) -> tuple[Sighting, ...]:
    """What a detector reports at a place from which the things `in_sight` can be seen."""
    found = []
    for number in in_sight:
        thing = dwelling.things[number]
        if rng.random() < (DOOR_RECALL if thing.name == DOOR else RECALL):
            name = _mistaken(thing.name, dwelling, rng) if rng.random() < P_MISNAMED else thing.name
            found.append(_sighting(thing, name, number, camera_m, rng))
    for extra in range(int(rng.poisson(MADE_UP_A_PLACE))):
        like = dwelling.things[int(rng.integers(len(dwelling.things)))]
        found.append(_made_up(like, first_made_up + extra, camera_m, rng))
    return tuple(found)


def _sighting(thing: Thing, name: str, number: int, camera_m: Vector3, rng: np.random.Generator) -> Sighting:
    x, y, z = np.subtract(thing.centre_m, camera_m).tolist()
    size = np.subtract(thing.high_m, thing.low_m)
    yaw_sigma, elevation_sigma, log_size = rng.standard_normal(3).tolist()
    return Sighting(
        number=number,
        name=name,
        yaw_rad=math.atan2(y, x) + _ANGLE_SIGMA_RAD * yaw_sigma,
        elevation_rad=math.atan2(z, math.hypot(x, y)) + _ANGLE_SIGMA_RAD * elevation_sigma,
        size_sr=apparent_size_sr(thing, camera_m) * math.exp(_SIZE_SIGMA * log_size),
        width_m=float(max(size[0], size[1])),
        height_m=float(size[2]),
        position_m=thing.centre_m,
    )


def _made_up(like: Thing, number: int, camera_m: Vector3, rng: np.random.Generator) -> Sighting:
    """Something of the size of `like`, anywhere around."""
    yaw, away = rng.uniform(-math.pi, math.pi), rng.uniform(0.8, 3.5)
    x, y = camera_m[0] + away * math.cos(yaw), camera_m[1] + away * math.sin(yaw)
    half = np.subtract(like.high_m, like.low_m) / 2.0
    z = like.centre_m[2]
    moved = Thing(
        number=number,
        name=like.name,
        room=like.room,
        low_m=(x - float(half[0]), y - float(half[1]), z - float(half[2])),
        high_m=(x + float(half[0]), y + float(half[1]), z + float(half[2])),
    )
    return _sighting(moved, like.name, number, camera_m, rng)


def _mistaken(name: str, dwelling: Dwelling, rng: np.random.Generator) -> str:
    others = [other for group in _ALIKE if name in group for other in group if other != name]
    others = others or sorted({thing.name for thing in dwelling.things if thing.name != name})
    return others[int(rng.integers(len(others)))] if others else name
