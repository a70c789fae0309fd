"""What people sit on in the evening, and what stands around it."""

import math
from dataclasses import replace

from sim_bridge.homes.furniture.carpentry import (
    BLACK_GLASS,
    BLACK_METAL,
    CUSHIONS,
    DARK_WOODS,
    EDGE_M,
    FABRICS,
    FRONTS,
    STEEL,
    WOODS,
    Design,
    Fronts,
    FurnitureKind,
    chest,
    legs,
    materials,
    surface_at,
    table,
    wall_behind,
)
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import box, cylinder


def seating(style: Style, seats: int) -> Design:
    """Base, back, two arms, seat cushions, and a loose cushion of the accent at each end."""
    depth_m, seat_m, height_m, arm_m, back_m = 0.85, 0.42, 0.80, 0.15, 0.20
    arm_top_m, cushion_m, foot_m, loose_m = 0.60, 0.14, 0.10, 0.13
    width_m, inner_m = style.width_m, style.width_m - 2.0 * arm_m
    base_top_m = seat_m - cushion_m
    sitting_m = depth_m - back_m
    seat_w = inner_m / seats
    loose_w = min(0.38, seat_w - 0.05)
    ends = (-1, 1) if seats > 1 else (1,)
    loose = tuple(
        box(
            (-depth_m / 2.0 + back_m + loose_m / 2.0, sign * (inner_m - loose_w) / 2.0 * 0.97, seat_m + 0.15),
            (loose_m, loose_w, 0.30),
            style.accent,
        )
        for sign in ends
    )
    cushions = tuple(
        box(
            (back_m / 2.0, -inner_m / 2.0 + seat_w * (index + 0.5), seat_m - cushion_m / 2.0),
            (sitting_m, seat_w - 0.01, cushion_m),
            style.main.shaded(1.2),
        )
        for index in range(seats)
    )
    arms = tuple(
        box(
            (0.0, sign * (width_m - arm_m) / 2.0, (foot_m + arm_top_m) / 2.0),
            (depth_m, arm_m, arm_top_m - foot_m),
            style.main,
        )
        for sign in (-1, 1)
    )
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box(
                (back_m / 2.0, 0.0, (foot_m + base_top_m) / 2.0),
                (sitting_m - 0.02, inner_m, base_top_m - foot_m),
                style.main.shaded(0.8),
            ),
            box(
                (-sitting_m / 2.0, 0.0, (foot_m + height_m) / 2.0),
                (back_m, inner_m, height_m - foot_m),
                style.main,
            ),
            *arms,
            *cushions,
            *loose,
            *legs((depth_m, width_m, foot_m), BLACK_METAL, inset_m=0.05),
        ),
        surfaces=(surface_at(sitting_m - loose_m, inner_m, seat_m, x_m=(back_m + loose_m) / 2.0),),
    )


def sofa(style: Style) -> Design:
    """A sofa for two or three."""
    base = seating(style, 2 if style.width_m < 1.8 else 3)
    return replace(base, surfaces=(*base.surfaces, wall_behind(base.depth_m, base.width_m, base.height_m)))


def armchair(style: Style) -> Design:
    """A sofa for one."""
    return seating(style, 1)


def coffee_table(style: Style) -> Design:
    """A low table with a board for magazines under its top."""
    depth_m, height_m = 0.60, 0.42
    base = table(style, depth_m, height_m, front_m=0.0)
    board = box((0.0, 0.0, 0.14), (depth_m - 0.15, style.width_m - 0.15, 0.02), style.main)
    return replace(base, parts=(*base.parts, board))


def side_table(style: Style) -> Design:
    """A small round table on one foot."""
    height_m, plate_m, top_m = 0.55, 0.02, 0.03
    diameter_m = style.width_m
    # The largest square on a disc, and objects keep off its edge.
    square_m = diameter_m / math.sqrt(2.0)
    return Design(
        depth_m=diameter_m,
        width_m=diameter_m,
        height_m=height_m,
        parts=(
            cylinder((0.0, 0.0, height_m - top_m / 2.0), diameter_m, top_m, style.main),
            cylinder(
                (0.0, 0.0, (plate_m + height_m - top_m) / 2.0), 0.05, height_m - top_m - plate_m, style.accent
            ),
            cylinder((0.0, 0.0, plate_m / 2.0), diameter_m * 0.7, plate_m, style.accent),
        ),
        surfaces=(surface_at(square_m + EDGE_M, square_m + EDGE_M, height_m),),
        front_m=0.0,
    )


def tv_stand(style: Style) -> Design:
    """Low and wide: drawers at both ends, and an open middle with a player in it."""
    depth_m, height_m, width_m = 0.40, 0.50, style.width_m
    side_m, board_m, middle_m = 0.03, 0.03, width_m * 0.4
    wing_m = (width_m - middle_m) / 2.0
    inner_m = height_m - board_m
    wings = tuple(
        part
        for sign in (-1, 1)
        for part in (
            box(
                (-0.02, sign * (width_m - wing_m) / 2.0, 0.04 + (inner_m - 0.04) / 2.0),
                (depth_m - 0.04, wing_m, inner_m - 0.04),
                style.main.shaded(0.75),
            ),
            box(
                (depth_m / 2.0 - 0.03, sign * (width_m - wing_m) / 2.0, 0.27),
                (0.02, wing_m - 0.04, 0.36),
                style.accent,
            ),
            cylinder((depth_m / 2.0 - 0.01, sign * (width_m - wing_m) / 2.0, 0.30), 0.02, 0.03, STEEL),
        )
    )
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box((0.0, 0.0, height_m - board_m / 2.0), (depth_m, width_m, board_m), style.main),
            box((-0.02, 0.0, 0.055), (depth_m - 0.04, middle_m, board_m), style.main),
            box((-depth_m / 2.0 + side_m / 2.0, 0.0, 0.27), (side_m, middle_m, 0.40), style.main.shaded(0.5)),
            *wings,
            box((-0.01, 0.0, 0.11), (0.25, middle_m * 0.7, 0.08), BLACK_METAL),
            box((0.1175, 0.0, 0.11), (0.005, middle_m * 0.3, 0.03), BLACK_GLASS),
            *legs((depth_m, width_m, 0.04), BLACK_METAL, inset_m=0.03),
        ),
        surfaces=(surface_at(depth_m, width_m, height_m),),
    )


def sideboard(style: Style) -> Design:
    """A chest as high as a hip, on short legs."""
    size = (0.40, style.width_m, 0.80)
    return chest(size, style.main, Fronts(columns=3, rows=1, stuff=style.accent), hangs=True)


UPHOLSTERY = (*FABRICS, *materials("brown leather", "black leather", "cream leather"))
LIVING_ROOM = (
    FurnitureKind(kind="sofa", build=sofa, widths_m=(1.60, 2.00), mains=UPHOLSTERY, accents=CUSHIONS),
    FurnitureKind(kind="armchair", build=armchair, widths_m=(0.85,), mains=UPHOLSTERY, accents=CUSHIONS),
    FurnitureKind(
        kind="coffee table",
        build=coffee_table,
        widths_m=(0.90, 1.10),
        mains=(*WOODS, *materials("white stone", "turquoise glass")),
        accents=(*DARK_WOODS, STEEL),
    ),
    FurnitureKind(
        kind="side table",
        build=side_table,
        widths_m=(0.45,),
        mains=(*WOODS, *materials("white stone", "yellow metal")),
        accents=materials("charcoal metal", "silver metal", "gold metal"),
    ),
    FurnitureKind(
        kind="tv stand",
        build=tv_stand,
        widths_m=(1.20, 1.40, 1.60),
        mains=WOODS,
        accents=(*FRONTS, *DARK_WOODS),
    ),
    FurnitureKind(
        kind="sideboard", build=sideboard, widths_m=(1.20, 1.40), mains=WOODS, accents=(*FRONTS, *WOODS)
    ),
)
