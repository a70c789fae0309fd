"""What people work at."""

from dataclasses import replace

from sim_bridge.homes.furniture.carpentry import (
    BLACK_METAL,
    BLACK_PLASTIC,
    FABRICS,
    PLINTH_M,
    STEEL,
    WOODS,
    Design,
    Fronts,
    FurnitureKind,
    chest,
    materials,
    surface_at,
    table,
)
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import ball, box, cylinder


def desk(style: Style) -> Design:
    """A table to work at, with drawers under its left end."""
    depth_m, height_m, drawers_m = 0.65, 0.74, 0.40
    base = table(style, depth_m, height_m, front_m=0.8, hangs=True)
    unit = chest((0.50, drawers_m, 0.66), style.main, Fronts(columns=1, rows=3, stuff=style.accent))
    shift_y = style.width_m / 2.0 - 0.10 - drawers_m / 2.0
    moved = tuple(
        replace(part, centre_m=(part.centre_m[0], part.centre_m[1] + shift_y, part.centre_m[2]))
        for part in unit.parts
    )
    return replace(base, parts=(*base.parts, *moved))


def office_chair(style: Style) -> Design:
    """A seat and a back on a star foot with castors; its back is at -x."""
    side_m, seat_m, height_m, hub_z, castor_m = style.width_m, 0.48, 0.95, 0.075, 0.06
    half_m = side_m / 2.0
    castors = tuple(
        ball((x, y, castor_m / 2.0), castor_m, BLACK_PLASTIC)
        for x, y in ((half_m - 0.03, 0.0), (0.03 - half_m, 0.0), (0.0, half_m - 0.03), (0.0, 0.03 - half_m))
    )
    arms = tuple(
        part
        for sign in (-1, 1)
        for part in (
            box((0.02, sign * 0.255, 0.56), (0.04, 0.03, 0.20), BLACK_PLASTIC),
            box((0.03, sign * 0.265, 0.675), (0.26, 0.05, 0.03), BLACK_PLASTIC),
        )
    )
    return Design(
        depth_m=side_m,
        width_m=side_m,
        height_m=height_m,
        parts=(
            box((0.0, 0.0, hub_z), (side_m - 0.02, 0.05, 0.04), style.accent),
            box((0.0, (half_m + 0.015) / 2.0, hub_z), (0.05, half_m - 0.035, 0.04), style.accent),
            box((0.0, -(half_m + 0.015) / 2.0, hub_z), (0.05, half_m - 0.035, 0.04), style.accent),
            *castors,
            cylinder((0.0, 0.0, 0.24), 0.06, 0.30, STEEL),
            box((0.03, 0.0, seat_m - 0.045), (0.48, 0.48, 0.09), style.main),
            box((-0.225, 0.0, 0.54), (0.04, 0.08, 0.20), BLACK_METAL),
            box((-0.25, 0.0, 0.77), (0.07, 0.44, 0.36), style.main),
            *arms,
        ),
        surfaces=(surface_at(0.42, 0.44, seat_m, x_m=0.04),),
        front_m=0.0,
    )


def filing_cabinet(style: Style) -> Design:
    """Three drawers of painted metal, each with a label."""
    depth_m, width_m, height_m, drawers = 0.50, style.width_m, 0.75, 3
    base = chest(
        (depth_m, width_m, height_m), style.main, Fronts(columns=1, rows=drawers, stuff=style.accent)
    )
    pitch_m = (height_m - 0.04 - PLINTH_M) / drawers
    labels = tuple(
        box((depth_m / 2.0 - 0.0175, 0.0, PLINTH_M + (row + 0.28) * pitch_m), (0.005, 0.10, 0.04), LABEL)
        for row in range(drawers)
    )
    return replace(base, parts=(*base.parts, *labels))


LABEL = materials("white paper")[0]
OFFICE = (
    FurnitureKind(
        kind="desk", build=desk, widths_m=(1.20, 1.40), mains=WOODS, accents=(*WOODS, STEEL, BLACK_METAL)
    ),
    FurnitureKind(
        kind="office chair",
        build=office_chair,
        widths_m=(0.60,),
        mains=(*FABRICS, *materials("black leather", "orange fabric")),
        accents=materials("charcoal metal", "silver metal"),
    ),
    FurnitureKind(
        kind="filing cabinet",
        build=filing_cabinet,
        widths_m=(0.45,),
        mains=materials("grey metal", "charcoal metal", "green metal", "white metal"),
        accents=materials("grey metal", "white metal", "red metal", "navy metal"),
    ),
)
