"""A home as data: rooms, doors, walls, furniture and the small objects on it, all in the `map` frame.

Rectangles on the floor are `Rect`s; a piece of furniture stands turned by a quarter turn or none, so that
its footprint is one. Everything is frozen: a home does not change once it is made.
"""

import math
import re
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from robustnav_msgs_py.values import Float64, ObjectInstance, Pose2D
from sim_bridge.homes.materials import Material
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.scene import Look, Style
from sim_bridge.homes.shapes import Part, Vector3, extent

WALL_THICKNESS_M = 0.10
WALL_HEIGHT_M = 2.50
DOOR_HEIGHT_M = 2.05
# What is higher up than this does not touch a robot that carries its camera at 1.1 m.
ROBOT_HEIGHT_M = 1.30
# Narrower than this is a matter of rounding.
SLIVER_M = 1e-6
# Furniture is called by its kind and a number.
NUMBER = re.compile(r" \d+$")


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """One room; `inside` is its floor between the walls."""

    name: str
    kind: str
    inside: Rect
    floor: Material
    walls: Material


@dataclass(frozen=True, slots=True, kw_only=True)
class Door:
    """An opening without a leaf; `opening` reaches from one side of the wall to the other."""

    rooms: tuple[str, str]
    opening: Rect
    along_x: bool

    @property
    def width_m(self) -> float:
        """How much room there is to drive through."""
        return self.opening.width_m if self.along_x else self.opening.depth_m


@dataclass(frozen=True, slots=True, kw_only=True)
class Wall:
    """A straight piece of wall, or the lintel above a door.

    `hidden` is the side that leans on another piece of wall, which nobody ever sees.
    """

    base: Rect
    z_min_m: float
    z_max_m: float
    material: Material
    hidden: Side


@dataclass(frozen=True, slots=True, kw_only=True)
class Window:
    """A window in an outer wall; `pane` is its place seen from above, thin, on the inner face of the wall."""

    room: str
    side: Side
    pane: Rect
    z_min_m: float
    z_max_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Surface:
    """Where objects can stand on a piece of furniture: a rectangle in its own frame, at a height.

    Where `hangs`, it is a strip of the wall behind the piece, and objects hang there with that lower edge.
    """

    area: Rect
    height_m: float
    hangs: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Furniture:
    """A piece of furniture. Its own frame has x out of its front, y to its left, origin on the floor.

    `surfaces` is empty where nothing stands on it; `tall` furniture hides what is behind it.
    """

    name: str
    kind: str
    room: str
    x_m: float
    y_m: float
    quarter_turns: int
    style: Style
    depth_m: float
    width_m: float
    height_m: float
    tall: bool
    surfaces: tuple[Surface, ...]
    parts: tuple[Part, ...]

    @property
    def yaw_rad(self) -> float:
        """Heading of its front."""
        return math.remainder(self.quarter_turns * math.pi / 2.0, math.tau)

    @property
    def carries(self) -> bool:
        """Whether objects stand on it, where a robot can see them."""
        return bool(self.surfaces) and not self.tall

    @property
    def footprint(self) -> Rect:
        """The floor that it covers."""
        return self.in_map(
            Rect(
                x_min_m=-self.depth_m / 2.0,
                y_min_m=-self.width_m / 2.0,
                x_max_m=self.depth_m / 2.0,
                y_max_m=self.width_m / 2.0,
            )
        )

    def in_map(self, area: Rect) -> Rect:
        """A rectangle of its own frame, moved to `map`."""
        xs, ys = zip(
            self.point_in_map(area.x_min_m, area.y_min_m),
            self.point_in_map(area.x_max_m, area.y_max_m),
            strict=True,
        )
        return Rect(x_min_m=min(xs), y_min_m=min(ys), x_max_m=max(xs), y_max_m=max(ys))

    def point_in_map(self, x_m: float, y_m: float) -> tuple[float, float]:
        """A point of its own frame, moved to `map`; quarter turns keep the coordinates exact."""
        cos, sin = ((1, 0), (0, 1), (-1, 0), (0, -1))[self.quarter_turns % 4]
        return self.x_m + cos * x_m - sin * y_m, self.y_m + sin * x_m + cos * y_m


@dataclass(frozen=True, slots=True, kw_only=True)
class SmallObject:
    """An object that a person may ask for. `z_m` is where its bottom stands; origin below its middle."""

    instance: int
    label: str
    look: Look
    room: str
    furniture: str
    surface: int
    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float
    parts: tuple[Part, ...]

    @property
    def size_m(self) -> Vector3:
        """Extent along its own axes."""
        low, high = extent(self.parts)
        return high[0] - low[0], high[1] - low[1], high[2] - low[2]

    @property
    def centre_m(self) -> Vector3:
        """The middle of the box around it, in `map`."""
        low, high = extent(self.parts)
        x, y = (low[0] + high[0]) / 2.0, (low[1] + high[1]) / 2.0
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return (
            self.x_m + cos * x - sin * y,
            self.y_m + sin * x + cos * y,
            self.z_m + (low[2] + high[2]) / 2.0,
        )

    @property
    def footprint(self) -> Rect:
        """The rectangle around it, seen from above."""
        corners = self.corners_m()
        return Rect(
            x_min_m=float(corners[:, 0].min()),
            y_min_m=float(corners[:, 1].min()),
            x_max_m=float(corners[:, 0].max()),
            y_max_m=float(corners[:, 1].max()),
        )

    def corners_m(self) -> Float64:
        """The eight corners of the box around it, [8, 3] in `map`."""
        low, high = extent(self.parts)
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return np.array(
            [
                (self.x_m + cos * x - sin * y, self.y_m + sin * x + cos * y, self.z_m + z)
                for x in (low[0], high[0])
                for y in (low[1], high[1])
                for z in (low[2], high[2])
            ]
        )

    @property
    def attributes(self) -> tuple[tuple[str, str], ...]:
        """What can be said of it: class, colour, material, pattern, size, on (furniture, no number), room."""
        look = self.look
        return (
            ("class", self.label),
            ("colour", look.colour),
            ("material", str(look.substance)),
            ("pattern", str(look.pattern)),
            ("size", str(look.size)),
            ("on", NUMBER.sub("", self.furniture)),
            ("room", self.room),
        )

    def as_truth(self) -> ObjectInstance:
        """The object as ground truth travels."""
        x, y, z = self.centre_m
        return ObjectInstance(
            instance=self.instance,
            label=self.label,
            x_m=x,
            y_m=y,
            z_m=z,
            yaw_rad=self.yaw_rad,
            size_m=self.size_m,
            attributes=self.attributes,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Home:
    """A whole home. `bounds` reaches to the outer faces of the outer walls; `start` is the robot's.

    `seed` is None where a person wrote the scene. `labels` are the class names of the catalogue, in the order
    of their numbers: the same in every home.
    """

    name: str
    seed: int | None
    bounds: Rect
    rooms: tuple[Room, ...]
    doors: tuple[Door, ...]
    windows: tuple[Window, ...]
    walls: tuple[Wall, ...]
    furniture: tuple[Furniture, ...]
    objects: tuple[SmallObject, ...]
    labels: tuple[str, ...]
    start: Pose2D

    def room_at(self, x_m: float, y_m: float) -> Room | None:
        """The room whose floor holds the point; None in a wall, a doorway and outside."""
        return next((room for room in self.rooms if room.inside.holds(x_m, y_m)), None)

    def obstacles(self) -> tuple[Rect, ...]:
        """What the robot must keep off: walls and furniture, and what lies outside."""
        return (*self.solid(), *self.outside())

    def solid(self) -> tuple[Rect, ...]:
        """What walls and furniture cover as far up as the robot reaches."""
        walls = tuple(wall.base for wall in self.walls if wall.z_min_m < ROBOT_HEIGHT_M)
        return (*walls, *(piece.footprint for piece in self.furniture))

    def outside(self) -> tuple[Rect, ...]:
        """The parts of `bounds` that no room with its walls covers: none where the home is a rectangle."""
        covered = [room.inside.grown(WALL_THICKNESS_M) for room in self.rooms]
        xs = sorted({x for area in covered for x in (area.x_min_m, area.x_max_m)})
        ys = sorted({y for area in covered for y in (area.y_min_m, area.y_max_m)})
        cells = (
            Rect(x_min_m=x, y_min_m=y, x_max_m=X, y_max_m=Y)
            for x, X in pairwise(xs)
            for y, Y in pairwise(ys)
            if X - x > SLIVER_M and Y - y > SLIVER_M
        )
        return tuple(cell for cell in cells if not any(area.contains(cell) for area in covered))
