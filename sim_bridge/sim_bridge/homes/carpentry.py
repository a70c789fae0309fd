"""How furniture is built from boards and boxes: what the kinds in `furniture` have in common.

Every design has its own frame: x out of its front, y to its left, the origin on the floor below its
middle. Footprints are multiples of the floor plan's resolution.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from sim_bridge.homes.home import Rect, Surface
from sim_bridge.homes.shapes import Colour, Part, Size, box

T = TypeVar("T")

WOODS: tuple[Colour, ...] = ((0.55, 0.36, 0.20), (0.42, 0.26, 0.15), (0.72, 0.54, 0.34))
FABRICS: tuple[Colour, ...] = ((0.62, 0.20, 0.18), (0.20, 0.34, 0.52), (0.30, 0.45, 0.30), (0.45, 0.42, 0.40))
FRONTS: tuple[Colour, ...] = ((0.86, 0.87, 0.88), (0.55, 0.70, 0.66), (0.36, 0.46, 0.58))
WHITE: Colour = (0.95, 0.95, 0.94)
STEEL: Colour = (0.70, 0.72, 0.75)
DARK: Colour = (0.14, 0.14, 0.16)
STONE: Colour = (0.30, 0.30, 0.33)
LINEN: Colour = (0.92, 0.90, 0.85)

LEG_M = 0.05
BOARD_M = 0.04
HANDLE_M = 0.015
# Objects keep this far from a surface's edge.
EDGE_M = 0.03


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """One piece of furniture, not yet placed. `front_m` is the floor that must stay free before it."""

    kind: str
    depth_m: float
    width_m: float
    height_m: float
    parts: tuple[Part, ...]
    surfaces: tuple[Surface, ...] = ()
    tall: bool = False
    front_m: float = 0.6


def surface_at(
    depth_m: float, width_m: float, height_m: float, x_m: float = 0.0, y_m: float = 0.0
) -> Surface:
    """Where objects stand on a board of this size around (x_m, y_m)."""
    area = Rect(
        x_min_m=x_m - depth_m / 2.0 + EDGE_M,
        y_min_m=y_m - width_m / 2.0 + EDGE_M,
        x_max_m=x_m + depth_m / 2.0 - EDGE_M,
        y_max_m=y_m + width_m / 2.0 - EDGE_M,
    )
    return Surface(area=area, height_m=height_m)


def legs(size_m: Size, colour: Colour, inset_m: float = 0.0) -> tuple[Part, ...]:
    """Four square legs in the corners of a footprint, as high as `size_m` says."""
    x, y = size_m[0] / 2.0 - LEG_M / 2.0 - inset_m, size_m[1] / 2.0 - LEG_M / 2.0 - inset_m
    return tuple(
        box((sx * x, sy * y, size_m[2] / 2.0), (LEG_M, LEG_M, size_m[2]), colour)
        for sx in (-1, 1)
        for sy in (-1, 1)
    )


def table(kind: str, depth_m: float, width_m: float, height_m: float, wood: Colour, front_m: float) -> Design:
    """A board on four legs."""
    top = box((0.0, 0.0, height_m - BOARD_M / 2.0), (depth_m, width_m, BOARD_M), wood)
    darker = (wood[0] * 0.7, wood[1] * 0.7, wood[2] * 0.7)
    return Design(
        kind=kind,
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(top, *legs((depth_m, width_m, height_m - BOARD_M), darker)),
        surfaces=(surface_at(depth_m, width_m, height_m),),
        front_m=front_m,
    )


def chest(
    kind: str,
    size_m: Size,
    body: Colour,
    front: Colour,
    columns: int,
    rows: int,
    top: Colour | None = None,
    *,
    tall: bool = False,
    front_m: float = 0.6,
) -> Design:
    """A body with a grid of doors or drawers in front, each with a handle, and a top board."""
    depth_m, width_m, height_m = size_m
    skin_m, gap_m, plinth_m = 0.02, 0.02, 0.06
    body_height_m = height_m - BOARD_M
    parts = [
        box((-skin_m / 2.0, 0.0, body_height_m / 2.0), (depth_m - skin_m, width_m, body_height_m), body),
        box((0.0, 0.0, height_m - BOARD_M / 2.0), (depth_m, width_m, BOARD_M), top or body),
    ]
    panel_w = (width_m - gap_m) / columns - gap_m
    panel_h = (body_height_m - plinth_m) / rows - gap_m
    x = depth_m / 2.0 - skin_m / 2.0
    for column in range(columns):
        y = -width_m / 2.0 + gap_m + panel_w / 2.0 + column * (panel_w + gap_m)
        for row in range(rows):
            z = plinth_m + panel_h / 2.0 + row * (panel_h + gap_m)
            parts.append(box((x, y, z), (skin_m, panel_w, panel_h), front))
    handle_h = min(0.2, panel_h * 0.5)
    for column in range(columns):
        y = -width_m / 2.0 + gap_m + panel_w / 2.0 + column * (panel_w + gap_m)
        parts.append(
            box((x, y + panel_w * 0.35, height_m * 0.55), (skin_m + HANDLE_M, HANDLE_M, handle_h), DARK)
        )
    surfaces = () if tall else (surface_at(depth_m, width_m, height_m),)
    return Design(
        kind=kind,
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=tuple(parts),
        surfaces=surfaces,
        tall=tall,
        front_m=front_m,
    )


def pick(rng: np.random.Generator, options: Sequence[T]) -> T:
    """One of the options."""
    return options[int(rng.integers(len(options)))]


def seating(kind: str, width_m: float, fabric: Colour, cushions: int) -> Design:
    """A sofa or an armchair: base, back, two arms and seat cushions."""
    depth_m, seat_m, height_m, arm_m, back_m = 0.85, 0.42, 0.80, 0.15, 0.20
    lighter = (min(1.0, fabric[0] * 1.25), min(1.0, fabric[1] * 1.25), min(1.0, fabric[2] * 1.25))
    cushion_h, foot_m = 0.14, 0.10
    inner_m = width_m - 2 * arm_m
    base_m, rise_m = seat_m - cushion_h - foot_m, height_m - foot_m
    parts = [
        box((0.0, 0.0, foot_m + base_m / 2.0), (depth_m, width_m, base_m), fabric),
        box((-(depth_m - back_m) / 2.0, 0.0, foot_m + rise_m / 2.0), (back_m, width_m, rise_m), fabric),
        *legs((depth_m, width_m, foot_m), DARK, inset_m=0.05),
    ]
    for sign in (-1, 1):
        y = sign * (width_m - arm_m) / 2.0
        parts.append(box((0.0, y, 0.35), (depth_m, arm_m, 0.50), fabric))
    for index in range(cushions):
        cushion_w = inner_m / cushions
        y = -inner_m / 2.0 + cushion_w * (index + 0.5)
        size = (depth_m - back_m, cushion_w - 0.01, cushion_h)
        parts.append(box((back_m / 2.0, y, seat_m - cushion_h / 2.0), size, lighter))
    return Design(
        kind=kind,
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=tuple(parts),
        surfaces=(surface_at(depth_m - back_m, inner_m, seat_m, x_m=back_m / 2.0),),
    )
