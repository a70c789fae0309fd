"""Tables that people eat at, and what they sit on there."""

from sim_bridge.homes.furniture.carpentry import (
    BOARD_M,
    CUSHIONS,
    DARK_WOODS,
    FABRICS,
    STEEL,
    WOODS,
    Design,
    FurnitureKind,
    legs,
    materials,
    surface_at,
    table,
)
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import Axis, box, cylinder

TABLE_M = 0.74


def dining_table(style: Style) -> Design:
    """A table that people sit around."""
    return table(style, 0.80, TABLE_M, front_m=0.0, leg_m=0.07)


def chair(style: Style) -> Design:
    """A wooden chair with a seat cushion of the accent; its back is at -x."""
    side_m, seat_m, height_m, post_m = style.width_m, 0.45, 0.90, 0.04
    cushion_m = 0.03
    under_m = seat_m - cushion_m - BOARD_M
    back_x = -side_m / 2.0 + post_m / 2.0
    sitting_m = side_m - post_m
    posts = tuple(
        box(
            (back_x, sign * (side_m - post_m) / 2.0, (under_m + height_m) / 2.0),
            (post_m, post_m, height_m - under_m),
            style.main,
        )
        for sign in (-1, 1)
    )
    slats = tuple(
        box((back_x, y, 0.66), (0.02, 0.05, 0.26), style.main.shaded(0.85)) for y in (-0.11, 0.0, 0.11)
    )
    return Design(
        depth_m=side_m,
        width_m=side_m,
        height_m=height_m,
        parts=(
            box((post_m / 2.0, 0.0, under_m + BOARD_M / 2.0), (sitting_m, side_m, BOARD_M), style.main),
            box(
                (post_m / 2.0, 0.0, seat_m - cushion_m / 2.0),
                (sitting_m - 0.03, side_m - 0.03, cushion_m),
                style.accent,
            ),
            *posts,
            box((back_x, 0.0, 0.84), (0.025, side_m - 2.0 * post_m, 0.10), style.main),
            box((back_x, 0.0, 0.515), (0.025, side_m - 2.0 * post_m, 0.04), style.main),
            *slats,
            *legs((side_m, side_m, under_m), style.main.shaded(0.85), thickness_m=post_m),
        ),
        surfaces=(surface_at(sitting_m - 0.03, side_m - 0.03, seat_m, x_m=post_m / 2.0),),
        front_m=0.0,
    )


def stool(style: Style) -> Design:
    """A round seat on four legs with a foot rest of tubes."""
    seat_m, thickness_m, rest_m = 0.48, 0.06, 0.18
    span_m = style.width_m * 0.62
    post_m = 0.035
    tubes = tuple(
        cylinder((0.0, sign * (span_m - post_m) / 2.0, rest_m), 0.02, span_m - post_m, STEEL, Axis.X)
        for sign in (-1, 1)
    )
    return Design(
        depth_m=style.width_m,
        width_m=style.width_m,
        height_m=seat_m,
        parts=(
            cylinder((0.0, 0.0, seat_m - thickness_m / 2.0), style.width_m, thickness_m, style.accent),
            *legs((span_m, span_m, seat_m - thickness_m), style.main, thickness_m=post_m),
            *tubes,
        ),
        surfaces=(surface_at(0.30, 0.30, seat_m),),
        front_m=0.0,
    )


DINING_ROOM = (
    FurnitureKind(
        kind="dining table",
        build=dining_table,
        widths_m=(1.20, 1.40, 1.60),
        mains=WOODS,
        accents=(*WOODS, STEEL),
    ),
    FurnitureKind(kind="chair", build=chair, widths_m=(0.45,), mains=WOODS, accents=(*FABRICS, *CUSHIONS)),
    FurnitureKind(
        kind="stool",
        build=stool,
        widths_m=(0.35,),
        mains=DARK_WOODS,
        accents=materials("oak wood", "red leather", "black leather", "yellow plastic"),
    ),
)
