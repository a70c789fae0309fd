"""What a kitchen is furnished with."""

from dataclasses import replace

from sim_bridge.homes.furniture.carpentry import (
    BLACK_GLASS,
    BLACK_METAL,
    BOARD_M,
    FRONTS,
    HANDLE_M,
    PLINTH_M,
    SKIN_M,
    STEEL,
    WHITE_PAINT,
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

# Pieces side by side in a row look like one kitchen only where these agree.
DEPTH_M = 0.60
WORKTOP_M = 0.90
FRONT_M = 0.80
DOOR_WIDTH_M = 0.50
GLOWING_RING = material("red glass")


def kitchen_counter(style: Style) -> Design:
    """Cupboards with doors of the main material under a worktop of the accent."""
    columns = max(1, round(style.width_m / DOOR_WIDTH_M))
    fronts = Fronts(columns=columns, rows=1, stuff=style.main)
    size = (DEPTH_M, style.width_m, WORKTOP_M)
    return chest(size, WHITE_PAINT, fronts, style.accent, front_m=FRONT_M)


def sink_unit(style: Style) -> Design:
    """A counter with a steel basin on its left; objects stand on the rest."""
    width_m, basin_m, margin_m, bottom_m = style.width_m, 0.45, 0.05, 0.72
    under_m, front_x = WORKTOP_M - BOARD_M, DEPTH_M / 2.0 - SKIN_M - HANDLE_M
    outer = Rect(x_min_m=-DEPTH_M / 2.0, y_min_m=-width_m / 2.0, x_max_m=DEPTH_M / 2.0, y_max_m=width_m / 2.0)
    hole = Rect(
        x_min_m=outer.x_min_m + 0.14,
        y_min_m=outer.y_max_m - basin_m,
        x_max_m=front_x - 0.04,
        y_max_m=outer.y_max_m - margin_m,
    )
    body = Rect(x_min_m=outer.x_min_m, y_min_m=outer.y_min_m, x_max_m=front_x, y_max_m=outer.y_max_m)
    y = (hole.y_min_m + hole.y_max_m) / 2.0
    tap_x = outer.x_min_m + 0.07
    fronts = Fronts(columns=2, rows=1, stuff=style.main)
    return Design(
        depth_m=DEPTH_M,
        width_m=width_m,
        height_m=WORKTOP_M + 0.22,
        parts=(
            slab(body, (0.0, bottom_m), WHITE_PAINT),
            slab(hole, (bottom_m, bottom_m + 0.02), BLACK_METAL),
            *ring(body, hole, (bottom_m, under_m), STEEL),
            *ring(outer, hole, (under_m, WORKTOP_M), style.accent),
            *fronts.parts(DEPTH_M, width_m, (PLINTH_M, under_m)),
            cylinder((tap_x, y, WORKTOP_M + 0.01), 0.07, 0.02, STEEL),
            cylinder((tap_x, y, WORKTOP_M + 0.12), 0.035, 0.20, STEEL),
            cylinder((tap_x + 0.085, y, WORKTOP_M + 0.20), 0.03, 0.17, STEEL, Axis.X),
        ),
        surfaces=(surface_at(DEPTH_M, width_m - basin_m, WORKTOP_M, y_m=-basin_m / 2.0),),
        front_m=FRONT_M,
    )


def stove(style: Style) -> Design:
    """An oven with a window under a hob of four rings; pans stand on the hob."""
    width_m, panel_m, rings_m, door_m = style.width_m, 0.12, 0.006, 0.60
    before_m = 0.05
    body_m, front_x = WORKTOP_M - 0.03, DEPTH_M / 2.0 - before_m
    panel_z = body_m - panel_m / 2.0
    knobs = tuple(
        cylinder((front_x + 0.035, y, panel_z), 0.045, 0.03, style.accent, Axis.X)
        for y in (-0.22, -0.11, 0.11, 0.22)
    )
    hob_top = WORKTOP_M - rings_m
    rings = tuple(
        cylinder((x, y, WORKTOP_M - rings_m / 2.0), diameter, rings_m, GLOWING_RING)
        for x, y, diameter in (
            (-0.13, 0.14, 0.20),
            (-0.13, -0.14, 0.16),
            (0.13, 0.14, 0.16),
            (0.13, -0.14, 0.20),
        )
    )
    return Design(
        depth_m=DEPTH_M,
        width_m=width_m,
        height_m=WORKTOP_M,
        parts=(
            box((-before_m / 2.0, 0.0, body_m / 2.0), (DEPTH_M - before_m, width_m, body_m), style.main),
            box((0.0, 0.0, (body_m + hob_top) / 2.0), (DEPTH_M, width_m, hob_top - body_m), BLACK_GLASS),
            *rings,
            box(
                (front_x + 0.01, 0.0, panel_z),
                (0.02, width_m - 0.02, panel_m - 0.02),
                style.accent.shaded(0.6),
            ),
            *knobs,
            box(
                (front_x + 0.01, 0.0, PLINTH_M + door_m / 2.0),
                (0.02, width_m - 0.04, door_m),
                style.main.shaded(0.9),
            ),
            box((front_x + 0.0225, 0.0, PLINTH_M + 0.27), (0.005, width_m - 0.18, 0.32), BLACK_GLASS),
            cylinder(
                (front_x + 0.035, 0.0, PLINTH_M + door_m - 0.07), 0.025, width_m - 0.14, style.accent, Axis.Y
            ),
            box((front_x + 0.0225, 0.0, 0.02), (0.005, width_m - 0.04, 0.04), style.main.shaded(0.7)),
        ),
        surfaces=(surface_at(DEPTH_M - 0.06, width_m, WORKTOP_M),),
        front_m=FRONT_M,
    )


def fridge(style: Style) -> Design:
    """Tall, with a freezer door below."""
    width_m, height_m, split_m, gap_m = style.width_m, 1.80, 0.65, 0.01
    handle_m, skin_m = 0.03, 0.05
    depth_m = DEPTH_M
    front_x = depth_m / 2.0 - handle_m - skin_m / 2.0
    body_m = depth_m - handle_m - skin_m
    doors = tuple(
        box((front_x, 0.0, (low + high) / 2.0), (skin_m, width_m - gap_m, high - low - gap_m), style.main)
        for low, high in ((0.05, split_m), (split_m, height_m))
    )
    handles = tuple(
        cylinder((depth_m / 2.0 - handle_m / 2.0, width_m / 2.0 - 0.07, z), handle_m, length, style.accent)
        for z, length in ((split_m - 0.2, 0.3), (split_m + 0.35, 0.5))
    )
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box(
                (-(depth_m - body_m) / 2.0, 0.0, height_m / 2.0),
                (body_m, width_m, height_m),
                style.main.shaded(0.8),
            ),
            *doors,
            *handles,
            box((front_x + skin_m / 2.0 + 0.005, 0.0, 1.62), (0.01, 0.14, 0.05), BLACK_GLASS),
        ),
        tall=True,
        front_m=FRONT_M,
    )


def cupboard(style: Style) -> Design:
    """A tall kitchen cupboard of four doors on a dark plinth."""
    size = (0.40, style.width_m, 1.90)
    base = chest(size, style.accent, Fronts(columns=2, rows=2, stuff=style.main), tall=True)
    shadow_m = SKIN_M + HANDLE_M
    plinth = box(
        (size[0] / 2.0 - shadow_m * 0.75, 0.0, PLINTH_M / 2.0 - 0.005),
        (shadow_m / 2.0, style.width_m - 0.04, PLINTH_M - 0.01),
        BLACK_METAL,
    )
    return replace(base, parts=(*base.parts, plinth))


WORKTOPS = materials("charcoal stone", "grey stone", "oak wood", "white stone", "brown stone")
APPLIANCES = materials("white metal", "silver metal", "charcoal metal", "red metal", "cream metal")
KITCHEN = (
    FurnitureKind(
        kind="kitchen counter",
        build=kitchen_counter,
        widths_m=(0.60, 0.80, 1.00, 1.20, 1.60),
        mains=FRONTS,
        accents=WORKTOPS,
    ),
    FurnitureKind(
        kind="sink unit", build=sink_unit, widths_m=(0.80, 1.00, 1.20), mains=FRONTS, accents=WORKTOPS
    ),
    FurnitureKind(
        kind="stove",
        build=stove,
        widths_m=(0.60,),
        mains=APPLIANCES,
        accents=materials("silver metal", "black plastic"),
    ),
    FurnitureKind(
        kind="fridge",
        build=fridge,
        widths_m=(0.60,),
        mains=APPLIANCES,
        accents=materials("charcoal metal", "silver metal"),
    ),
    FurnitureKind(
        kind="cupboard",
        build=cupboard,
        widths_m=(0.80, 1.00),
        mains=FRONTS,
        accents=materials("white paint", "oak wood"),
    ),
)
