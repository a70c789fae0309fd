"""What stands where people come in."""

from sim_bridge.homes.furniture.carpentry import (
    BLACK_METAL,
    CUSHIONS,
    DARK_WOODS,
    FABRICS,
    FRONTS,
    STEEL,
    WOODS,
    Design,
    FurnitureKind,
    legs,
    materials,
    ring,
    slab,
    surface_at,
    wall_behind,
)
from sim_bridge.homes.rect import Rect
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import box, cylinder


def console_table(style: Style) -> Design:
    """Narrow, with a drawer under its top and a board near the floor."""
    depth_m, width_m, height_m, top_m, apron_m = 0.35, style.width_m, 0.80, 0.03, 0.12
    under_m = height_m - top_m
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box((0.0, 0.0, height_m - top_m / 2.0), (depth_m, width_m, top_m), style.main),
            box(
                (-0.01, 0.0, under_m - apron_m / 2.0),
                (depth_m - 0.12, width_m - 0.10, apron_m),
                style.main.shaded(0.8),
            ),
            box(
                (depth_m / 2.0 - 0.065, 0.0, under_m - apron_m / 2.0),
                (0.02, width_m * 0.5, apron_m - 0.03),
                style.accent,
            ),
            cylinder((depth_m / 2.0 - 0.045, 0.0, under_m - apron_m / 2.0 - 0.01), 0.02, 0.02, STEEL),
            *legs((depth_m, width_m, under_m), style.main, inset_m=0.01, thickness_m=0.04),
            box((0.0, 0.0, 0.16), (depth_m - 0.04, width_m - 0.09, 0.02), style.accent),
        ),
        surfaces=(surface_at(depth_m, width_m, height_m), wall_behind(depth_m, width_m, height_m)),
    )


def shoe_bench(style: Style) -> Design:
    """A cushion to sit on over two grates for shoes."""
    depth_m, width_m, height_m, cushion_m, side_m = 0.35, style.width_m, 0.45, 0.06, 0.03
    under_m = height_m - cushion_m
    grates = tuple(
        box((x, 0.0, z), (0.05, width_m - 2.0 * side_m, 0.02), style.main)
        for z in (0.10, 0.24)
        for x in (-0.12, -0.03, 0.06, 0.15)
    )
    sides = tuple(
        box(
            (0.0, sign * (width_m - side_m) / 2.0, (under_m - 0.03) / 2.0),
            (depth_m, side_m, under_m - 0.03),
            style.main,
        )
        for sign in (-1, 1)
    )
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            *sides,
            *grates,
            box((0.0, 0.0, under_m - 0.015), (depth_m, width_m, 0.03), style.main.shaded(0.85)),
            box(
                (0.0, 0.0, height_m - cushion_m / 2.0),
                (depth_m - 0.01, width_m - 0.01, cushion_m),
                style.accent,
            ),
        ),
        surfaces=(surface_at(depth_m - 0.01, width_m - 0.01, height_m),),
    )


def mat(style: Style) -> Design:
    """Flat on the floor, with a border; what belongs on the floor stands on it."""
    depth_m, width_m, height_m, border_m = 0.60, style.width_m, 0.01, 0.05
    outer = Rect(x_min_m=-depth_m / 2.0, y_min_m=-width_m / 2.0, x_max_m=depth_m / 2.0, y_max_m=width_m / 2.0)
    inner = outer.grown(-border_m)
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(slab(inner, (0.0, height_m), style.main), *ring(outer, inner, (0.0, height_m), style.accent)),
        surfaces=(surface_at(depth_m, width_m, height_m),),
        front_m=0.0,
    )


HALLWAY = (
    FurnitureKind(
        kind="console table",
        build=console_table,
        widths_m=(0.80, 1.00),
        mains=(*WOODS, BLACK_METAL),
        accents=(*FRONTS, *DARK_WOODS),
    ),
    FurnitureKind(
        kind="shoe bench", build=shoe_bench, widths_m=(0.70, 0.80), mains=WOODS, accents=(*FABRICS, *CUSHIONS)
    ),
    FurnitureKind(
        kind="mat",
        build=mat,
        widths_m=(0.90,),
        mains=materials(
            "beige striped carpet", "brown carpet", "green carpet", "blue dotted carpet", "red checked carpet"
        ),
        accents=materials("charcoal carpet", "cream carpet", "brown carpet"),
    ),
)
