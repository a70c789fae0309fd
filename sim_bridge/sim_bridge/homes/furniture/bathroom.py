"""What stands in a bathroom."""

from sim_bridge.homes.furniture.carpentry import (
    BOARD_M,
    CERAMIC,
    FRONTS,
    HANDLE_M,
    PLINTH_M,
    SKIN_M,
    STEEL,
    Design,
    Fronts,
    FurnitureKind,
    chest,
    materials,
    ring,
    slab,
    surface_at,
)
from sim_bridge.homes.materials import material
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import Axis, box, cylinder

WATER = material("sky glass")
# Bathrooms are small: one steps up to things rather than around them.
FRONT_M = 0.45


def washstand(style: Style) -> Design:
    """A cabinet with a round basin on its left; objects stand on the rest."""
    depth_m, height_m, basin_m, diameter_m = 0.50, 0.82, 0.45, 0.38
    width_m = style.width_m
    base = chest(
        (depth_m, width_m, height_m), style.main, Fronts(columns=2, rows=1, stuff=style.main), style.accent
    )
    y = width_m / 2.0 - basin_m / 2.0
    tap_x = -depth_m / 2.0 + 0.035
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m + 0.2,
        parts=(
            *base.parts,
            cylinder((0.03, y, height_m + 0.04), diameter_m, 0.08, CERAMIC),
            cylinder((0.03, y, height_m + 0.0825), diameter_m - 0.06, 0.005, WATER),
            cylinder((tap_x, y, height_m + 0.09), 0.03, 0.18, STEEL),
            cylinder((tap_x + 0.075, y, height_m + 0.17), 0.025, 0.15, STEEL, Axis.X),
        ),
        surfaces=(surface_at(depth_m, width_m - basin_m, height_m, y_m=-basin_m / 2.0),),
        front_m=FRONT_M,
    )


def toilet(style: Style) -> Design:
    """A bowl with a seat, and a cistern behind it whose lid carries small things."""
    depth_m, width_m, height_m, cistern_m, lid_m = 0.65, style.width_m, 0.80, 0.20, 0.03
    bowl_d, bowl_x = 0.38, 0.12
    back_x = -depth_m / 2.0
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box((-0.04, 0.0, 0.10), (0.40, 0.20, 0.20), style.main),
            cylinder((bowl_x, 0.0, 0.30), bowl_d, 0.20, style.main),
            box((-0.06, 0.0, 0.30), (0.16, 0.30, 0.20), style.main.shaded(0.97)),
            cylinder((bowl_x, 0.0, 0.415), bowl_d + 0.02, 0.03, style.accent),
            cylinder((bowl_x, 0.0, 0.4325), bowl_d - 0.12, 0.005, WATER),
            # The open lid of the seat leans on the cistern.
            box((back_x + cistern_m + 0.015, 0.0, 0.60), (0.03, width_m - 0.04, 0.34), style.accent),
            box(
                (back_x + cistern_m / 2.0, 0.0, (0.40 + height_m - lid_m) / 2.0),
                (cistern_m - 0.02, width_m - 0.02, height_m - lid_m - 0.40),
                style.main,
            ),
            box(
                (back_x + cistern_m / 2.0, 0.0, height_m - lid_m / 2.0),
                (cistern_m, width_m, lid_m),
                style.main,
            ),
            cylinder(
                (back_x + cistern_m + 0.015, width_m / 2.0 - 0.06, height_m - 0.015),
                0.025,
                0.03,
                STEEL,
                Axis.X,
            ),
        ),
        surfaces=(surface_at(cistern_m, width_m, height_m, x_m=back_x + cistern_m / 2.0),),
        front_m=FRONT_M,
    )


def bathtub(style: Style) -> Design:
    """Its long side at the wall, its head, with a broad rim to put things on, at the left."""
    depth_m, width_m, height_m, bottom_m, rim_m, head_m, skirt_m = (
        0.75,
        style.width_m,
        0.55,
        0.15,
        0.07,
        0.30,
        0.02,
    )
    outer = Rect(
        x_min_m=-depth_m / 2.0, y_min_m=-width_m / 2.0, x_max_m=depth_m / 2.0 - skirt_m, y_max_m=width_m / 2.0
    )
    hollow = Rect(
        x_min_m=outer.x_min_m + rim_m,
        y_min_m=outer.y_min_m + rim_m + 0.05,
        x_max_m=outer.x_max_m - rim_m,
        y_max_m=outer.y_max_m - head_m,
    )
    tap_y = outer.y_min_m + 0.06
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m + 0.15,
        parts=(
            slab(outer, (0.0, bottom_m), style.main),
            *ring(outer, hollow, (bottom_m, height_m), style.main),
            slab(hollow, (bottom_m, bottom_m + 0.08), WATER),
            box((depth_m / 2.0 - skirt_m / 2.0, 0.0, 0.25), (skirt_m, width_m, 0.50), style.accent),
            cylinder((0.0, tap_y, height_m + 0.07), 0.035, 0.14, STEEL),
            cylinder((0.0, tap_y + 0.075, height_m + 0.12), 0.03, 0.15, STEEL, Axis.Y),
            cylinder((-0.12, tap_y, height_m + 0.03), 0.05, 0.06, STEEL),
            cylinder((0.12, tap_y, height_m + 0.03), 0.05, 0.06, STEEL),
        ),
        surfaces=(
            surface_at(depth_m - skirt_m, head_m, height_m, x_m=-skirt_m / 2.0, y_m=(width_m - head_m) / 2.0),
        ),
        front_m=FRONT_M,
    )


def bathroom_cabinet(style: Style) -> Design:
    """Tall and narrow, with a mirror in its upper door."""
    depth_m, width_m, height_m = 0.35, style.width_m, 1.70
    base = chest(
        (depth_m, width_m, height_m), style.main, Fronts(columns=1, rows=2, stuff=style.accent), tall=True
    )
    upper_m = (height_m - BOARD_M - PLINTH_M) / 2.0
    mirror_x = depth_m / 2.0 - HANDLE_M + 0.0025
    mirror = box(
        (mirror_x, -0.03, PLINTH_M + upper_m * 1.5), (0.005, width_m - SKIN_M - 0.22, upper_m - 0.20), MIRROR
    )
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(*base.parts, mirror),
        tall=True,
    )


MIRROR = material("silver glass")
BATHROOM = (
    FurnitureKind(
        kind="washstand",
        build=washstand,
        widths_m=(0.80, 1.00),
        mains=(*FRONTS, *materials("oak wood", "walnut wood")),
        accents=materials("white stone", "charcoal stone", "oak wood"),
    ),
    FurnitureKind(
        kind="toilet",
        build=toilet,
        widths_m=(0.40,),
        mains=materials("white ceramic", "cream ceramic"),
        accents=materials("white plastic", "oak wood", "charcoal plastic", "turquoise plastic"),
    ),
    FurnitureKind(
        kind="bathtub",
        build=bathtub,
        widths_m=(1.50, 1.60),
        mains=materials("white ceramic", "cream ceramic"),
        accents=materials("white ceramic", "turquoise tiles", "oak wood", "navy tiles"),
    ),
    FurnitureKind(
        kind="bathroom cabinet",
        build=bathroom_cabinet,
        widths_m=(0.50, 0.60),
        mains=FRONTS,
        accents=(*FRONTS, *materials("oak wood")),
    ),
)
