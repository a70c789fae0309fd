"""What people sleep in, and where they keep their clothes and toys."""

from dataclasses import replace

from sim_bridge.homes.furniture.carpentry import (
    BLACK_METAL,
    COVERS,
    FRONTS,
    LINEN,
    PLINTH_M,
    STEEL,
    WOODS,
    Design,
    Fronts,
    FurnitureKind,
    chest,
    legs,
    materials,
    surface_at,
    wall_behind,
)
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import Axis, Part, box, cylinder


def sleeping(style: Style, depth_m: float, pillows: int) -> Design:
    """Head at -x, against the wall; a blanket of the accent lies on the foot's two thirds."""
    width_m, height_m, top_m, head_m, foot_m = style.width_m, 0.95, 0.52, 0.05, 0.10
    frame_top_m, mattress_top_m, board_m = 0.32, 0.48, 0.03
    cover_m, fold_m = depth_m * 0.58, 0.14
    lying_m = depth_m - head_m - board_m
    middle_x = (head_m - board_m) / 2.0
    cover_x = depth_m / 2.0 - board_m - cover_m / 2.0
    fold_x = cover_x - cover_m / 2.0 - fold_m / 2.0
    pillow_w = width_m / pillows - 0.12
    heads = tuple(
        box(
            (
                -depth_m / 2.0 + head_m + 0.22,
                (index + 0.5) * width_m / pillows - width_m / 2.0,
                mattress_top_m + 0.06,
            ),
            (0.36, pillow_w, 0.12),
            LINEN,
        )
        for index in range(pillows)
    )
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            *legs((depth_m, width_m, foot_m), style.main.shaded(0.7), inset_m=0.02),
            box(
                (middle_x, 0.0, (foot_m + frame_top_m) / 2.0),
                (lying_m, width_m, frame_top_m - foot_m),
                style.main,
            ),
            box(
                (-(depth_m - head_m) / 2.0, 0.0, (foot_m + height_m) / 2.0),
                (head_m, width_m, height_m - foot_m),
                style.main,
            ),
            box(
                ((depth_m - board_m) / 2.0, 0.0, (foot_m + 0.44) / 2.0),
                (board_m, width_m, 0.44 - foot_m),
                style.main,
            ),
            box(
                (middle_x - 0.005, 0.0, (frame_top_m + mattress_top_m) / 2.0),
                (lying_m - 0.01, width_m - 0.06, mattress_top_m - frame_top_m),
                LINEN,
            ),
            *heads,
            box((cover_x, 0.0, (0.36 + top_m) / 2.0), (cover_m, width_m - 0.02, top_m - 0.36), style.accent),
            box((fold_x, 0.0, (0.36 + top_m) / 2.0), (fold_m, width_m - 0.02, top_m - 0.36), LINEN),
        ),
        surfaces=(
            surface_at(cover_m, width_m - 0.02, top_m, x_m=cover_x),
            wall_behind(depth_m, width_m, height_m),
        ),
        front_m=0.4,
    )


def bed(style: Style) -> Design:
    """A bed for two."""
    return sleeping(style, 2.05, 2)


def single_bed(style: Style) -> Design:
    """A bed for one."""
    return sleeping(style, 2.00, 1)


def nightstand(style: Style) -> Design:
    """A small chest beside a bed."""
    size = (0.40, style.width_m, 0.50)
    return chest(size, style.main, Fronts(columns=1, rows=2, stuff=style.accent), front_m=0.5)


def wardrobe(style: Style) -> Design:
    """Tall and wide: doors above a long drawer, a cornice on top."""
    depth_m, height_m, split_m = 0.60, 2.00, 0.40
    width_m, columns = style.width_m, max(2, round(style.width_m / 0.6))
    base = chest(
        (depth_m, width_m, height_m), style.main, Fronts(columns=1, rows=1, stuff=style.accent), tall=True
    )
    drawers = Fronts(columns=2, rows=1, stuff=style.accent, handles=BLACK_METAL)
    doors = Fronts(columns=columns, rows=1, stuff=style.accent, handles=BLACK_METAL)
    return replace(
        base,
        parts=(
            *base.parts[:2],
            *drawers.parts(depth_m, width_m, (PLINTH_M, split_m)),
            *doors.parts(depth_m, width_m, (split_m, height_m - 0.04)),
        ),
    )


def dresser(style: Style) -> Design:
    """A chest of drawers."""
    size = (0.45, style.width_m, 0.85)
    return chest(size, style.main, Fronts(columns=2, rows=3, stuff=style.accent), hangs=True)


def toy_chest(style: Style) -> Design:
    """A low box with a bright lid and coloured squares on its front."""
    depth_m, height_m, lid_m, board_m = 0.45, 0.45, 0.04, 0.01
    width_m, body_m = style.width_m, 0.41
    count = 4
    pitch_m = width_m / count
    squares: tuple[Part, ...] = tuple(
        box(
            (depth_m / 2.0 - 1.5 * board_m, -width_m / 2.0 + (index + 0.5) * pitch_m, 0.22),
            (board_m, pitch_m - 0.06, pitch_m - 0.06),
            stuff,
        )
        for index, stuff in enumerate(TOY_COLOURS)
    )
    handle = cylinder((depth_m / 2.0 - 0.01, 0.0, 0.37), 0.02, 0.16, STEEL, Axis.Y)
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box((-0.01, 0.0, body_m / 2.0), (depth_m - 0.02, width_m, body_m), style.main),
            box((0.0, 0.0, height_m - lid_m / 2.0), (depth_m, width_m, lid_m), style.accent),
            *squares,
            handle,
        ),
        surfaces=(surface_at(depth_m, width_m, height_m),),
    )


TOY_COLOURS = materials("red paint", "yellow paint", "blue paint", "green paint")
BEDROOM = (
    FurnitureKind(kind="bed", build=bed, widths_m=(1.20, 1.40, 1.60), mains=WOODS, accents=COVERS),
    FurnitureKind(kind="single bed", build=single_bed, widths_m=(0.90, 1.00), mains=WOODS, accents=COVERS),
    FurnitureKind(
        kind="nightstand", build=nightstand, widths_m=(0.40, 0.45), mains=WOODS, accents=(*WOODS, *FRONTS)
    ),
    FurnitureKind(
        kind="wardrobe",
        build=wardrobe,
        widths_m=(0.80, 1.00, 1.20, 1.60),
        mains=WOODS,
        accents=(*WOODS, *materials("white paint", "cream paint")),
    ),
    FurnitureKind(
        kind="dresser", build=dresser, widths_m=(0.80, 1.00), mains=WOODS, accents=(*FRONTS, *WOODS)
    ),
    FurnitureKind(
        kind="toy chest",
        build=toy_chest,
        widths_m=(0.70, 0.80),
        mains=materials("white wood", "oak wood", "turquoise wood"),
        accents=materials("red paint", "blue dotted fabric", "yellow paint", "pink dotted fabric"),
    ),
)
