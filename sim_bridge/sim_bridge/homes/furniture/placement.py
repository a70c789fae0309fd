"""Where in a room a piece of furniture might stand: at walls, in the middle, in rows, beside others.

These are candidates only; whether there is room for them is for `free_floor` to say.
"""

from dataclasses import dataclass

import numpy as np

from sim_bridge.homes.furniture.carpentry import GAP_M, Design
from sim_bridge.homes.rect import GRID_M, Rect, snapped

# Between furniture that stands in the middle and the walls.
AROUND_M = 0.55
# Between a sofa and the table before it, and what must remain between the table and what is opposite.
TABLE_GAP_M = 0.40
OPPOSITE_M = 0.75
_COS_SIN = ((1, 0), (0, 1), (-1, 0), (0, -1))


@dataclass(frozen=True, slots=True, kw_only=True)
class Spot:
    """Where a design would stand in `map`: its middle, and which way its front looks."""

    x_m: float
    y_m: float
    quarter_turns: int

    def point_in_map(self, x_m: float, y_m: float) -> tuple[float, float]:
        """A point of the design's frame, moved to `map`."""
        cos, sin = _COS_SIN[self.quarter_turns % 4]
        return self.x_m + cos * x_m - sin * y_m, self.y_m + sin * x_m + cos * y_m

    def in_map(self, area: Rect) -> Rect:
        """A rectangle of the design's frame, moved to `map`."""
        a, b = self.point_in_map(area.x_min_m, area.y_min_m), self.point_in_map(area.x_max_m, area.y_max_m)
        return Rect(
            x_min_m=min(a[0], b[0]), y_min_m=min(a[1], b[1]), x_max_m=max(a[0], b[0]), y_max_m=max(a[1], b[1])
        )


def at_walls(rng: np.random.Generator, inside: Rect, depth_m: float, width_m: float) -> list[Spot]:
    """Every place of the grid with the back to one of the four walls, shuffled."""
    spots = []
    back_m = GAP_M + depth_m / 2.0
    for turns in range(4):
        along_m = inside.depth_m if turns % 2 == 0 else inside.width_m
        spare = int(np.floor((along_m - width_m - 2.0 * GAP_M) / GRID_M + 1e-6))
        for step in range(spare + 1):
            along = GAP_M + step * GRID_M + width_m / 2.0
            x_m, y_m = (
                (inside.x_min_m + back_m, inside.y_min_m + along),
                (inside.x_min_m + along, inside.y_min_m + back_m),
                (inside.x_max_m - back_m, inside.y_min_m + along),
                (inside.x_min_m + along, inside.y_max_m - back_m),
            )[turns]
            spots.append(Spot(x_m=round(x_m, 6), y_m=round(y_m, 6), quarter_turns=turns))
    return [spots[at] for at in rng.permutation(len(spots))]


def corners_first(spots: list[Spot], inside: Rect, width_m: float) -> list[Spot]:
    """Places at walls, those in the corners of the room before all others; their order is kept otherwise."""

    def off_corner(spot: Spot) -> bool:
        low_m, high_m, at_m = (
            (inside.y_min_m, inside.y_max_m, spot.y_m)
            if spot.quarter_turns % 2 == 0
            else (inside.x_min_m, inside.x_max_m, spot.x_m)
        )
        return min(at_m - low_m, high_m - at_m) > width_m / 2.0 + GAP_M + GRID_M / 2.0

    return sorted(spots, key=off_corner)


def in_middle(
    rng: np.random.Generator, inside: Rect, depth_m: float, width_m: float, tries: int
) -> list[Spot]:
    """Places away from the walls, along either axis."""
    spots = []
    for _ in range(tries):
        turns = int(rng.integers(2))
        size_x, size_y = (depth_m, width_m) if turns == 0 else (width_m, depth_m)
        spare_x = inside.width_m - size_x - 2.0 * AROUND_M
        spare_y = inside.depth_m - size_y - 2.0 * AROUND_M
        if spare_x < 0.0 or spare_y < 0.0:
            continue
        low_x = inside.x_min_m + AROUND_M + rng.uniform(0.0, spare_x)
        low_y = inside.y_min_m + AROUND_M + rng.uniform(0.0, spare_y)
        middle = Spot(x_m=low_x + size_x / 2.0, y_m=low_y + size_y / 2.0, quarter_turns=turns)
        spots.append(aligned(middle, depth_m, width_m))
    return spots


def along_row(row: Spot, depths_m: list[float], widths_m: list[float]) -> list[Spot]:
    """Where the members of a row stand, left to right; their backs are in one line.

    `row` is where one piece as deep as the deepest and as wide as all together would stand.
    """
    deepest_m, at_m = max(depths_m), sum(widths_m) / 2.0
    spots = []
    for depth_m, width_m in zip(depths_m, widths_m, strict=True):
        x_m, y_m = row.point_in_map((depth_m - deepest_m) / 2.0, at_m - width_m / 2.0)
        spots.append(Spot(x_m=round(x_m, 6), y_m=round(y_m, 6), quarter_turns=row.quarter_turns))
        at_m -= width_m
    return spots


def opposite(inside: Rect, host: Spot, host_depth_m: float, guest: Design) -> tuple[Spot, float]:
    """Where a guest stands at the wall that the host looks at, and the floor between their fronts (m)."""
    room_m = inside.width_m if host.quarter_turns % 2 == 0 else inside.depth_m
    ahead_m = room_m - 2.0 * GAP_M - (host_depth_m + guest.depth_m) / 2.0
    x_m, y_m = host.point_in_map(ahead_m, 0.0)
    spot = Spot(x_m=x_m, y_m=y_m, quarter_turns=(host.quarter_turns + 2) % 4)
    return aligned(spot, guest.depth_m, guest.width_m), ahead_m - (host_depth_m + guest.depth_m) / 2.0


def in_front(host: Spot, host_depth_m: float, guest: Design, gap_m: float = GAP_M) -> Spot:
    """Before the host's front, looking at it."""
    x_m, y_m = host.point_in_map((host_depth_m + guest.depth_m) / 2.0 + gap_m, 0.0)
    spot = Spot(x_m=x_m, y_m=y_m, quarter_turns=(host.quarter_turns + 2) % 4)
    return aligned(spot, guest.depth_m, guest.width_m)


def around(host: Spot, table: Design, guest: Design) -> list[Spot]:
    """Facing the host: two on each long side (along its y), one on each short side."""
    long_x = (table.depth_m + guest.depth_m) / 2.0 + GAP_M
    short_y = (table.width_m + guest.depth_m) / 2.0 + GAP_M
    seat_y = table.width_m / 4.0
    seats = [(sign * long_x, y, 2 if sign > 0 else 0) for sign in (1, -1) for y in (-seat_y, seat_y)]
    seats += [(0.0, short_y, 3), (0.0, -short_y, 1)]
    spots = []
    for x, y, turns in seats:
        x_m, y_m = host.point_in_map(x, y)
        spot = Spot(x_m=x_m, y_m=y_m, quarter_turns=(host.quarter_turns + turns) % 4)
        spots.append(aligned(spot, guest.depth_m, guest.width_m))
    return spots


def beside(host: Spot, neighbour: Design, guest: Design) -> list[Spot]:
    """To the host's left and right, backs in one line."""
    back_x = (guest.depth_m - neighbour.depth_m) / 2.0
    side_y = (neighbour.width_m + guest.width_m) / 2.0 + GAP_M
    spots = []
    for sign in (1, -1):
        x_m, y_m = host.point_in_map(back_x, sign * side_y)
        spot = Spot(x_m=x_m, y_m=y_m, quarter_turns=host.quarter_turns)
        spots.append(aligned(spot, guest.depth_m, guest.width_m))
    return spots


def aligned(spot: Spot, depth_m: float, width_m: float) -> Spot:
    """The spot moved so that the footprint's edges lie on the floor plan's grid."""
    even = spot.quarter_turns % 2 == 0
    half_x, half_y = (depth_m / 2.0, width_m / 2.0) if even else (width_m / 2.0, depth_m / 2.0)
    return Spot(
        x_m=round(snapped(spot.x_m - half_x) + half_x, 6),
        y_m=round(snapped(spot.y_m - half_y) + half_y, 6),
        quarter_turns=spot.quarter_turns,
    )
