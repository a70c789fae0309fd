"""Rectangles on the floor."""

from dataclasses import dataclass
from enum import StrEnum

from robustnav_msgs_py.errors import BadSceneError

# Wall lines lie on this grid, the resolution of the floor plan, so that the map shows walls where they are.
GRID_M = 0.05


def snapped(length_m: float) -> float:
    """The nearest multiple of the grid, rounded so that equal lines compare equal."""
    return round(round(length_m / GRID_M) * GRID_M, 6)


@dataclass(frozen=True, slots=True, kw_only=True)
class Rect:
    """A rectangle on the floor, aligned with the axes of `map`, in metres."""

    x_min_m: float
    y_min_m: float
    x_max_m: float
    y_max_m: float

    def __post_init__(self) -> None:
        if not (self.x_min_m < self.x_max_m and self.y_min_m < self.y_max_m):
            raise BadSceneError(f"a rectangle needs an extent: {self!r}")

    @property
    def width_m(self) -> float:
        """Extent along x."""
        return self.x_max_m - self.x_min_m

    @property
    def depth_m(self) -> float:
        """Extent along y."""
        return self.y_max_m - self.y_min_m

    @property
    def area_m2(self) -> float:
        """Area."""
        return self.width_m * self.depth_m

    @property
    def centre_m(self) -> tuple[float, float]:
        """The middle: x, y."""
        return (self.x_min_m + self.x_max_m) / 2.0, (self.y_min_m + self.y_max_m) / 2.0

    def grown(self, margin_m: float) -> "Rect":
        """The rectangle with `margin_m` added on every side (taken away where negative)."""
        return Rect(
            x_min_m=self.x_min_m - margin_m,
            y_min_m=self.y_min_m - margin_m,
            x_max_m=self.x_max_m + margin_m,
            y_max_m=self.y_max_m + margin_m,
        )

    def overlaps(self, other: "Rect", tolerance_m: float = 1e-6) -> bool:
        """Whether the two share more than an edge."""
        return (
            self.x_min_m < other.x_max_m - tolerance_m
            and other.x_min_m < self.x_max_m - tolerance_m
            and self.y_min_m < other.y_max_m - tolerance_m
            and other.y_min_m < self.y_max_m - tolerance_m
        )

    def contains(self, other: "Rect", tolerance_m: float = 1e-6) -> bool:
        """Whether `other` lies wholly inside."""
        return (
            self.x_min_m <= other.x_min_m + tolerance_m
            and other.x_max_m <= self.x_max_m + tolerance_m
            and self.y_min_m <= other.y_min_m + tolerance_m
            and other.y_max_m <= self.y_max_m + tolerance_m
        )

    def holds(self, x_m: float, y_m: float) -> bool:
        """Whether the point lies inside or on the edge."""
        return self.x_min_m <= x_m <= self.x_max_m and self.y_min_m <= y_m <= self.y_max_m


class Side(StrEnum):
    """The sides of a rectangle on the floor."""

    SOUTH = "south"
    NORTH = "north"
    WEST = "west"
    EAST = "east"
