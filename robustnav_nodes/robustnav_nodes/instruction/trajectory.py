"""What a robot that follows an instruction has gone through: places, turns, rooms and objects seen.

Frames and units are the project's: metres, radians, yaw counter-clockwise from +x, bearings positive to the
left.
"""

import math
from dataclasses import dataclass

from robustnav_msgs_py.errors import BadParameterError

# The room types that evidence is spread over, in this order (those of the semantic R2R pack).
ROOM_TYPES = (
    "office",
    "lounge",
    "familyroom",
    "entryway",
    "diningroom",
    "livingroom",
    "stairs",
    "kitchen",
    "porch",
    "bathroom",
    "bedroom",
    "hallway",
)
UNKNOWN_ROOM = (1.0 / len(ROOM_TYPES),) * len(ROOM_TYPES)


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenObject:
    """An object in sight of a viewpoint.

    `bearing_rad` is relative to the yaw on arriving there, positive to the left; `elevation_rad` positive up;
    `size_sr` the solid angle that it fills. None: not known.
    """

    name: str
    bearing_rad: float | None = None
    elevation_rad: float | None = None
    size_sr: float | None = None
    range_m: float | None = None

    def __post_init__(self) -> None:
        for name in ("bearing_rad", "elevation_rad", "size_sr", "range_m"):
            value = getattr(self, name)
            if value is not None and not math.isfinite(value):
                raise BadParameterError(
                    f"the {name} of the object {self.name!r} is {value!r}; it must be finite"
                )


@dataclass(frozen=True, slots=True, kw_only=True)
class Viewpoint:
    """One place on the way: where, the yaw on arriving and on leaving, the room and the objects in sight.

    `rooms` holds a probability for each of ROOM_TYPES. At the last place both yaws are the same. `place` is
    what its pictures are found by; empty where there are none.
    """

    x_m: float
    y_m: float
    z_m: float
    yaw_in_rad: float
    yaw_out_rad: float
    rooms: tuple[float, ...] = UNKNOWN_ROOM
    objects: tuple[SeenObject, ...] = ()
    place: str = ""

    def __post_init__(self) -> None:
        for name in ("x_m", "y_m", "z_m", "yaw_in_rad", "yaw_out_rad"):
            if not math.isfinite(getattr(self, name)):
                raise BadParameterError(
                    f"{name} of a viewpoint is {getattr(self, name)!r}; it must be finite"
                )
        if len(self.rooms) != len(ROOM_TYPES) or not all(0.0 <= p <= 1.0 for p in self.rooms):
            raise BadParameterError(
                f"the room evidence of a viewpoint is {self.rooms!r}; it must be {len(ROOM_TYPES)} "
                "probabilities, in the order of ROOM_TYPES"
            )

    @property
    def turn_rad(self) -> float:
        """What the robot turned here, in -pi..pi, positive to the left."""
        return wrapped(self.yaw_out_rad - self.yaw_in_rad)


@dataclass(frozen=True, slots=True, kw_only=True)
class Trajectory:
    """The viewpoints of one walk, in their order; none at all before the first step is allowed."""

    viewpoints: tuple[Viewpoint, ...] = ()

    def __len__(self) -> int:
        return len(self.viewpoints)


def wrapped(angle_rad: float) -> float:
    """The same angle in -pi..pi."""
    return math.remainder(angle_rad, 2.0 * math.pi)
