"""Where rooms meet, and where they meet the outside: stretches of wall line, seen from above."""

from collections.abc import Iterable
from dataclasses import dataclass

from sim_bridge.homes.rect import Rect, Side

# Edges that are no farther apart are one edge: what is left of rounding in numbers that a file holds.
SAME_LINE_M = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class Stretch:
    """A straight stretch of wall line: along x at y = line_m, or along y at x = line_m."""

    along_x: bool
    line_m: float
    low_m: float
    high_m: float

    @property
    def length_m(self) -> float:
        """From end to end."""
        return self.high_m - self.low_m

    def strip(self, low_m: float, high_m: float, half_thickness_m: float) -> Rect:
        """The rectangle from low_m to high_m along the line, `half_thickness_m` to either side."""
        near_m, far_m = self.line_m - half_thickness_m, self.line_m + half_thickness_m
        if self.along_x:
            return Rect(x_min_m=low_m, y_min_m=near_m, x_max_m=high_m, y_max_m=far_m)
        return Rect(x_min_m=near_m, y_min_m=low_m, x_max_m=far_m, y_max_m=high_m)


def edge(area: Rect, side: Side) -> Stretch:
    """One whole side of a room."""
    if side in (Side.SOUTH, Side.NORTH):
        line_m = area.y_min_m if side is Side.SOUTH else area.y_max_m
        return Stretch(along_x=True, line_m=line_m, low_m=area.x_min_m, high_m=area.x_max_m)
    line_m = area.x_min_m if side is Side.WEST else area.x_max_m
    return Stretch(along_x=False, line_m=line_m, low_m=area.y_min_m, high_m=area.y_max_m)


def shared_stretch(a: Rect, b: Rect) -> Stretch | None:
    """The wall line between two rooms that do not overlap; None where they share none."""
    if abs(a.x_max_m - b.x_min_m) <= SAME_LINE_M or abs(b.x_max_m - a.x_min_m) <= SAME_LINE_M:
        along_x = False
        line_m = a.x_max_m if abs(a.x_max_m - b.x_min_m) <= SAME_LINE_M else a.x_min_m
        low_m, high_m = max(a.y_min_m, b.y_min_m), min(a.y_max_m, b.y_max_m)
    elif abs(a.y_max_m - b.y_min_m) <= SAME_LINE_M or abs(b.y_max_m - a.y_min_m) <= SAME_LINE_M:
        along_x = True
        line_m = a.y_max_m if abs(a.y_max_m - b.y_min_m) <= SAME_LINE_M else a.y_min_m
        low_m, high_m = max(a.x_min_m, b.x_min_m), min(a.x_max_m, b.x_max_m)
    else:
        return None
    if high_m - low_m <= SAME_LINE_M:
        return None
    return Stretch(along_x=along_x, line_m=line_m, low_m=low_m, high_m=high_m)


def outer_stretches(area: Rect, side: Side, others: Iterable[Rect]) -> list[Stretch]:
    """What of one side of a room faces no other room, from low to high."""
    whole = edge(area, side)
    shared = [shared_stretch(area, other) for other in others]
    taken = sorted(
        (stretch.low_m, stretch.high_m)
        for stretch in shared
        if stretch and stretch.along_x == whole.along_x and abs(stretch.line_m - whole.line_m) <= SAME_LINE_M
    )
    free = []
    at_m = whole.low_m
    for low_m, high_m in [*taken, (whole.high_m, whole.high_m)]:
        if low_m - at_m > SAME_LINE_M:
            free.append(Stretch(along_x=whole.along_x, line_m=whole.line_m, low_m=at_m, high_m=low_m))
        at_m = max(at_m, high_m)
    return free
