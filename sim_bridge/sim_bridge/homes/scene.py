"""A home as it is described: what a scene file says, and what a seed decides.

Nothing here has a shape yet: `build.build_home` makes the walls, boards and handles out of it. Lengths are
metres, angles radians, positions in `map` unless a frame is named.
"""

from dataclasses import dataclass
from enum import StrEnum

from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.materials import Material, Pattern, Substance
from sim_bridge.homes.rect import Rect, Side


class Size(StrEnum):
    """How large an object is among those of its class."""

    SMALL = "small"
    MEDIUM = "medium"
    LARGE = "large"


SCALE: dict[Size, float] = {Size.SMALL: 0.8, Size.MEDIUM: 1.0, Size.LARGE: 1.25}


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneRoom:
    """One room. `area` reaches to the middles of its walls: rooms side by side share an edge."""

    name: str
    kind: str
    area: Rect
    floor: Material
    walls: Material


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneDoor:
    """An opening without a leaf between two rooms; (x_m, y_m) is its middle, on the edge that they share."""

    rooms: tuple[str, str]
    x_m: float
    y_m: float
    width_m: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneWindow:
    """A window in an outer wall of a room, from `from_m` to `to_m` along x or y (`map`)."""

    room: str
    side: Side
    from_m: float
    to_m: float
    sill_m: float = 0.9
    top_m: float = 2.1


@dataclass(frozen=True, slots=True, kw_only=True)
class Style:
    """What may differ between two pieces of one kind."""

    width_m: float
    main: Material
    accent: Material


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneFurniture:
    """A piece of furniture; its front looks along +x after 0 quarter turns, +y after 1, and so on."""

    name: str
    kind: str
    room: str
    x_m: float
    y_m: float
    quarter_turns: int
    style: Style


@dataclass(frozen=True, slots=True, kw_only=True)
class Look:
    """What a person would name to tell an object from others of its class."""

    colour: str
    substance: Substance
    pattern: Pattern = Pattern.PLAIN
    size: Size = Size.MEDIUM

    @property
    def material(self) -> Material:
        """What its main parts are made of."""
        return Material(substance=self.substance, colour=self.colour, pattern=self.pattern)


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneObject:
    """A small object on surface number `surface` of a piece of furniture, in the furniture's frame."""

    label: str
    look: Look
    furniture: str
    surface: int
    x_m: float
    y_m: float
    turn_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """A whole home, described. `seed` is None where a person wrote it."""

    name: str
    seed: int | None
    rooms: tuple[SceneRoom, ...]
    doors: tuple[SceneDoor, ...]
    windows: tuple[SceneWindow, ...]
    furniture: tuple[SceneFurniture, ...]
    objects: tuple[SceneObject, ...]
    start: Pose2D
