"""The kinds of furniture that homes are furnished with, and where objects stand on each."""

from collections.abc import Callable

import numpy as np

from sim_bridge.homes.carpentry import (
    BOARD_M,
    DARK,
    FABRICS,
    FRONTS,
    HANDLE_M,
    LINEN,
    STEEL,
    STONE,
    WHITE,
    WOODS,
    Design,
    chest,
    legs,
    pick,
    seating,
    surface_at,
    table,
)
from sim_bridge.homes.shapes import box, cylinder


def kitchen_counter(rng: np.random.Generator) -> Design:
    """Cupboards under a stone worktop, with a hob on its right; objects stand on the rest."""
    depth_m, width_m, height_m, hob_m = 0.60, pick(rng, (1.60, 1.80, 2.00)), 0.90, 0.55
    base = chest(
        "kitchen counter", (depth_m, width_m, height_m), WHITE, pick(rng, FRONTS), 3, 1, STONE, front_m=0.8
    )
    hob_y = -width_m / 2.0 + hob_m / 2.0
    thickness_m = 0.01
    hob = box((0.0, hob_y, height_m + thickness_m / 2.0), (0.48, hob_m - 0.06, thickness_m), DARK)
    rings = tuple(
        cylinder((x, hob_y + y, height_m + thickness_m * 1.2), 0.16, thickness_m, (0.62, 0.18, 0.12))
        for x in (-0.12, 0.12)
        for y in (-0.12, 0.12)
    )
    worktop = surface_at(depth_m, width_m - hob_m, height_m, y_m=hob_m / 2.0)
    return Design(
        kind=base.kind,
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(*base.parts, hob, *rings),
        surfaces=(worktop,),
        front_m=base.front_m,
    )


def fridge(rng: np.random.Generator) -> Design:
    """Tall, of steel, with a freezer door below."""
    del rng
    depth_m, width_m, height_m, split_m = 0.65, 0.60, 1.80, 0.65
    front_x, skin_m, gap_m = depth_m / 2.0 - 0.02, 0.04, 0.01
    body = box((-0.02, 0.0, height_m / 2.0), (depth_m - 0.04, width_m, height_m), (0.52, 0.54, 0.57))
    lower = box((front_x, 0.0, split_m / 2.0), (skin_m, width_m - gap_m, split_m - gap_m), STEEL)
    upper_h = height_m - split_m
    upper = box(
        (front_x, 0.0, split_m + upper_h / 2.0), (skin_m, width_m - gap_m, upper_h - gap_m), (0.78, 0.8, 0.82)
    )
    handles = tuple(
        box((depth_m / 2.0 - 0.005, 0.24, z), (0.01 + HANDLE_M, 0.03, length), DARK)
        for z, length in ((split_m - 0.2, 0.3), (split_m + 0.35, 0.5))
    )
    return Design(
        kind="fridge",
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(body, lower, upper, *handles),
        tall=True,
        front_m=0.8,
    )


def cupboard(rng: np.random.Generator) -> Design:
    """Tall kitchen cupboard."""
    return chest("cupboard", (0.40, 0.80, 1.90), WHITE, pick(rng, FRONTS), 2, 2, tall=True)


def dining_table(rng: np.random.Generator) -> Design:
    """A table that people sit around."""
    return table("dining table", 0.80, pick(rng, (1.20, 1.40)), 0.74, pick(rng, WOODS), 0.0)


def chair(rng: np.random.Generator) -> Design:
    """A wooden chair; its back is at -x."""
    side_m, seat_m, height_m, back_m = 0.45, 0.45, 0.88, 0.04
    wood = pick(rng, WOODS)
    seat = box((0.0, 0.0, seat_m - BOARD_M / 2.0), (side_m, side_m, BOARD_M), wood)
    back_x = -side_m / 2.0 + back_m / 2.0
    posts = tuple(
        box(
            (back_x, sign * (side_m / 2.0 - back_m / 2.0), (seat_m + height_m) / 2.0),
            (back_m, back_m, height_m - seat_m),
            wood,
        )
        for sign in (-1, 1)
    )
    rail = (back_m / 2.0, side_m - 2 * back_m, 0.08)
    rails = tuple(box((back_x, 0.0, z), rail, wood) for z in (0.65, 0.83))
    return Design(
        kind="chair",
        depth_m=side_m,
        width_m=side_m,
        height_m=height_m,
        parts=(seat, *posts, *rails, *legs((side_m, side_m, seat_m - BOARD_M), wood)),
        surfaces=(surface_at(side_m - back_m, side_m, seat_m, x_m=back_m / 2.0),),
        front_m=0.0,
    )


def sofa(rng: np.random.Generator) -> Design:
    """A sofa for two or three."""
    width_m = pick(rng, (1.60, 2.00))
    return seating("sofa", width_m, pick(rng, FABRICS), 2 if width_m < 1.8 else 3)


def armchair(rng: np.random.Generator) -> Design:
    """An armchair."""
    return seating("armchair", 0.85, pick(rng, FABRICS), 1)


def coffee_table(rng: np.random.Generator) -> Design:
    """A low table."""
    return table("coffee table", 0.60, pick(rng, (0.90, 1.10)), 0.42, pick(rng, WOODS), 0.0)


def tv_stand(rng: np.random.Generator) -> Design:
    """A low, wide chest."""
    wood = pick(rng, WOODS)
    return chest("tv stand", (0.40, 1.40, 0.50), DARK, wood, 2, 1, wood)


def sideboard(rng: np.random.Generator) -> Design:
    """A chest as high as a hip."""
    wood = pick(rng, WOODS)
    return chest("sideboard", (0.40, 1.20, 0.80), wood, pick(rng, FRONTS), 3, 1, wood)


def bookcase(rng: np.random.Generator) -> Design:
    """Tall and open, with boards; it hides what is behind it."""
    depth_m, width_m, height_m, board_m, boards = 0.35, 0.90, 1.90, 0.03, 6
    wood = pick(rng, WOODS)
    darker = (wood[0] * 0.6, wood[1] * 0.6, wood[2] * 0.6)
    back = box(
        (-depth_m / 2.0 + board_m / 2.0, 0.0, height_m / 2.0),
        (board_m, width_m - board_m, height_m - board_m),
        darker,
    )
    sides = tuple(
        box((0.0, sign * (width_m - board_m) / 2.0, height_m / 2.0), (depth_m, board_m, height_m), wood)
        for sign in (-1, 1)
    )
    shelves = tuple(
        box((0.0, 0.0, z), (depth_m, width_m - 2 * board_m, board_m), wood)
        for z in np.linspace(board_m / 2.0, height_m - board_m / 2.0, boards).tolist()
    )
    return Design(
        kind="bookcase",
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(back, *sides, *shelves),
        tall=True,
    )


def bed(rng: np.random.Generator) -> Design:
    """A bed; its head is at -x, against the wall."""
    depth_m, width_m, top_m, head_m = 2.05, pick(rng, (1.40, 1.60)), 0.50, 0.05
    wood, fabric = pick(rng, WOODS), pick(rng, FABRICS)
    mattress_m, frame_m = 0.20, 0.25
    cover_m = depth_m * 0.6
    thickness_m = 0.02
    foot_m = 0.05
    parts = (
        *legs((depth_m, width_m, foot_m), wood),
        box((0.0, 0.0, foot_m + frame_m / 2.0), (depth_m, width_m, frame_m), wood),
        box((-depth_m / 2.0 + head_m / 2.0, 0.0, 0.5), (head_m, width_m, 0.9), wood),
        box(
            (0.0, 0.0, top_m - mattress_m / 2.0 - thickness_m),
            (depth_m - 2 * head_m, width_m - 0.04, mattress_m - 2 * thickness_m),
            LINEN,
        ),
        box(
            (depth_m / 2.0 - cover_m / 2.0, 0.0, top_m - 0.06),
            (cover_m, width_m, 0.12),
            fabric,
        ),
    )
    cover = surface_at(cover_m, width_m, top_m, x_m=depth_m / 2.0 - cover_m / 2.0)
    return Design(
        kind="bed",
        depth_m=depth_m,
        width_m=width_m,
        height_m=0.95,
        parts=parts,
        surfaces=(cover,),
        front_m=0.5,
    )


def nightstand(rng: np.random.Generator) -> Design:
    """A small chest beside a bed."""
    wood = pick(rng, WOODS)
    return chest("nightstand", (0.40, 0.45, 0.50), wood, WHITE, 1, 2, wood, front_m=0.5)


def wardrobe(rng: np.random.Generator) -> Design:
    """Tall and wide."""
    wood = pick(rng, WOODS)
    return chest("wardrobe", (0.60, pick(rng, (1.20, 1.60)), 2.00), wood, LINEN, 2, 1, tall=True)


def dresser(rng: np.random.Generator) -> Design:
    """A chest of drawers."""
    wood = pick(rng, WOODS)
    return chest("dresser", (0.45, 1.00, 0.85), wood, pick(rng, WOODS), 2, 3, wood)


def desk(rng: np.random.Generator) -> Design:
    """A table to work at."""
    return table("desk", 0.65, pick(rng, (1.20, 1.40)), 0.74, pick(rng, WOODS), 0.8)


def washstand(rng: np.random.Generator) -> Design:
    """A cabinet with a basin on its left; objects stand on the rest."""
    depth_m, width_m, height_m, basin_m = 0.50, 1.00, 0.82, 0.45
    base = chest("washstand", (depth_m, width_m, height_m), WHITE, pick(rng, FRONTS), 2, 1, WHITE)
    y = width_m / 2.0 - basin_m / 2.0
    basin = (
        cylinder((0.0, y, height_m + 0.03), 0.38, 0.06, (0.99, 0.99, 0.99)),
        cylinder((0.0, y, height_m + 0.055), 0.30, 0.012, (0.60, 0.72, 0.78)),
        box((-depth_m / 2.0 + 0.05, y, height_m + 0.1), (0.03, 0.03, 0.2), STEEL),
        box((-depth_m / 2.0 + 0.1, y, height_m + 0.19), (0.12, 0.03, 0.03), STEEL),
    )
    return Design(
        kind="washstand",
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(*base.parts, *basin),
        surfaces=(surface_at(depth_m, width_m - basin_m, height_m, y_m=-basin_m / 2.0),),
    )


def washing_machine(rng: np.random.Generator) -> Design:
    """A white cube with a round window."""
    del rng
    side_m, height_m = 0.60, 0.85
    body = box((-0.01, 0.0, height_m / 2.0), (side_m - 0.02, side_m, height_m), WHITE)
    panel = box((0.0, 0.0, height_m - 0.07), (side_m, side_m - 0.02, 0.1), STEEL)
    # An upright cylinder cannot lie on its side; two boxes make an octagon of a window.
    window = tuple(
        box((side_m / 2.0 - 0.005, 0.0, 0.42), (0.01, width, height), DARK)
        for width, height in ((0.36, 0.2), (0.2, 0.36), (0.3, 0.3))
    )
    return Design(
        kind="washing machine",
        depth_m=side_m,
        width_m=side_m,
        height_m=height_m,
        parts=(body, panel, *window),
        surfaces=(surface_at(side_m, side_m, height_m),),
    )


def bathroom_cabinet(rng: np.random.Generator) -> Design:
    """A tall, narrow cabinet."""
    return chest("bathroom cabinet", (0.35, 0.60, 1.70), WHITE, pick(rng, FRONTS), 1, 2, tall=True)


BUILDERS: dict[str, Callable[[np.random.Generator], Design]] = {
    "kitchen counter": kitchen_counter,
    "fridge": fridge,
    "cupboard": cupboard,
    "dining table": dining_table,
    "chair": chair,
    "sofa": sofa,
    "armchair": armchair,
    "coffee table": coffee_table,
    "tv stand": tv_stand,
    "sideboard": sideboard,
    "bookcase": bookcase,
    "bed": bed,
    "nightstand": nightstand,
    "wardrobe": wardrobe,
    "dresser": dresser,
    "desk": desk,
    "washstand": washstand,
    "washing machine": washing_machine,
    "bathroom cabinet": bathroom_cabinet,
}
