"""What washes, dries and smooths clothes."""

from sim_bridge.homes.furniture.carpentry import (
    BLACK_GLASS,
    STEEL,
    Design,
    FurnitureKind,
    materials,
    surface_at,
)
from sim_bridge.homes.materials import Material
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import Axis, Part, box, cylinder

HEIGHT_M = 0.85
DEPTH_M = 0.60


def machine(style: Style, window: Material, window_m: float, details: tuple[Part, ...]) -> Design:
    """A white cube with a round window in a ring of the accent, and a strip of controls above it."""
    width_m, before_m, ring_m = style.width_m, 0.05, 0.03
    front_x = DEPTH_M / 2.0 - before_m
    window_z, panel_z, panel_m = 0.40, 0.745, 0.13
    return Design(
        depth_m=DEPTH_M,
        width_m=width_m,
        height_m=HEIGHT_M,
        parts=(
            box(
                (-before_m / 2.0, 0.0, (HEIGHT_M - 0.03) / 2.0),
                (DEPTH_M - before_m, width_m, HEIGHT_M - 0.03),
                style.main,
            ),
            box((0.0, 0.0, HEIGHT_M - 0.015), (DEPTH_M, width_m, 0.03), style.main.shaded(0.93)),
            box((front_x + 0.01, 0.0, panel_z), (0.02, width_m - 0.02, panel_m), style.main.shaded(0.85)),
            cylinder((front_x + ring_m / 2.0, 0.0, window_z), window_m + 0.10, ring_m, style.accent, Axis.X),
            cylinder((front_x + ring_m + 0.005, 0.0, window_z), window_m, 0.01, window, Axis.X),
            cylinder((front_x + 0.035, 0.0, panel_z), 0.07, 0.03, style.accent, Axis.X),
            *details,
        ),
        surfaces=(surface_at(DEPTH_M, width_m, HEIGHT_M),),
    )


def washing_machine(style: Style) -> Design:
    """Its window is dark, and a drawer for the powder is at the left."""
    x = DEPTH_M / 2.0 - 0.025
    drawer = box((x, style.width_m / 2.0 - 0.13, 0.745), (0.01, 0.18, 0.09), style.main)
    display = box((x, -style.width_m / 2.0 + 0.14, 0.745), (0.01, 0.12, 0.05), BLACK_GLASS)
    return machine(style, BLACK_GLASS, 0.28, (drawer, display))


def dryer(style: Style) -> Design:
    """Its door is large and shut with a grip; air comes out of a grille at the bottom."""
    x = DEPTH_M / 2.0 - 0.045
    grille = tuple(
        box((x, 0.0, z), (0.01, style.width_m - 0.16, 0.012), STEEL.shaded(0.5)) for z in (0.04, 0.07, 0.10)
    )
    grip = box((DEPTH_M / 2.0 - 0.01, style.width_m / 2.0 - 0.17, 0.40), (0.02, 0.03, 0.14), STEEL)
    return machine(style, style.main.shaded(0.9), 0.34, (*grille, grip))


def ironing_board(style: Style) -> Design:
    """A padded board on crossed legs; parts cannot lean, so that the legs go up in small steps."""
    depth_m, width_m, height_m, cover_m, tube_m, steps = 0.40, style.width_m, 0.85, 0.04, 0.03, 9
    under_m, reach_m = height_m - cover_m, 0.56
    step_y, step_z = reach_m / steps, (under_m - tube_m) / steps
    crossed = tuple(
        # The two legs pass beside each other.
        box(
            (sign * 0.03, sign * (index - (steps - 1) / 2.0) * step_y, tube_m + (index + 0.5) * step_z),
            (0.03, step_y, step_z),
            style.main,
        )
        for index in range(steps)
        for sign in (-1, 1)
    )
    feet = tuple(
        cylinder(
            (0.0, sign * (reach_m - step_y) / 2.0, tube_m / 2.0), tube_m, depth_m - 0.04, style.main, Axis.X
        )
        for sign in (-1, 1)
    )
    rest_m = 0.22
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box(
                (0.0, rest_m / 2.0, height_m - cover_m / 2.0),
                (depth_m, width_m - rest_m, cover_m),
                style.accent,
            ),
            # Where the iron is put down.
            box(
                (0.0, -width_m / 2.0 + rest_m / 2.0, height_m - cover_m / 2.0),
                (depth_m - 0.12, rest_m, 0.02),
                STEEL,
            ),
            *crossed,
            *feet,
        ),
        surfaces=(surface_at(depth_m, width_m - rest_m, height_m, y_m=rest_m / 2.0),),
        front_m=0.5,
    )


LAUNDRY_ROOM = (
    FurnitureKind(
        kind="washing machine",
        build=washing_machine,
        widths_m=(0.60,),
        mains=materials("white metal", "silver metal"),
        accents=materials("silver metal", "charcoal metal", "white plastic"),
    ),
    FurnitureKind(
        kind="dryer",
        build=dryer,
        widths_m=(0.60,),
        mains=materials("white metal", "cream metal"),
        accents=materials("silver metal", "charcoal metal", "navy plastic"),
    ),
    FurnitureKind(
        kind="ironing board",
        build=ironing_board,
        widths_m=(1.20, 1.30),
        mains=materials("silver metal", "white metal"),
        accents=materials(
            "blue striped fabric", "green dotted fabric", "pink checked fabric", "silver fabric"
        ),
    ),
)
