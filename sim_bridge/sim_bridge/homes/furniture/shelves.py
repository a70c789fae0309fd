"""Shelves: a bookcase that hides what is behind it, and a low one that carries."""

from sim_bridge.homes.furniture.carpentry import (
    STEEL,
    WOODS,
    Design,
    FurnitureKind,
    materials,
    surface_at,
    wall_behind,
)
from sim_bridge.homes.scene import Style
from sim_bridge.homes.shapes import box, cylinder


def bookcase(style: Style) -> Design:
    """Tall and open, full of books; it hides what is behind it."""
    depth_m, height_m, board_m, back_m, shelves = 0.35, 1.90, 0.03, 0.02, 5
    width_m, inner_m = style.width_m, style.width_m - 2.0 * board_m
    pitch_m = (height_m - board_m) / shelves
    sides = tuple(
        box((0.0, sign * (width_m - board_m) / 2.0, height_m / 2.0), (depth_m, board_m, height_m), style.main)
        for sign in (-1, 1)
    )
    boards = tuple(
        box(
            (back_m / 2.0, 0.0, board_m / 2.0 + index * pitch_m),
            (depth_m - back_m, inner_m, board_m),
            style.main,
        )
        for index in range(shelves + 1)
    )
    books = []
    for shelf in range(shelves):
        at_m = -inner_m / 2.0 + 0.01
        for index in range(BOOKS_PER_SHELF):
            # Any steps that share no factor with the lengths of the tables: no two shelves look alike.
            number = shelf * 7 + index * 5
            thickness_m = inner_m * BOOK_SHARES[number % len(BOOK_SHARES)]
            tall_m = BOOK_HEIGHTS_M[number % len(BOOK_HEIGHTS_M)]
            deep_m = BOOK_DEPTHS_M[number % len(BOOK_DEPTHS_M)]
            books.append(
                box(
                    (
                        -depth_m / 2.0 + 0.03 + deep_m / 2.0,
                        at_m + thickness_m / 2.0,
                        board_m + shelf * pitch_m + tall_m / 2.0,
                    ),
                    (deep_m, thickness_m - 0.004, tall_m),
                    style.accent
                    if index == shelf % BOOKS_PER_SHELF
                    else BOOK_COVERS[number % len(BOOK_COVERS)],
                )
            )
            at_m += thickness_m
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            box(
                (-(depth_m - back_m) / 2.0, 0.0, height_m / 2.0),
                (back_m, inner_m, height_m),
                style.main.shaded(0.6),
            ),
            *sides,
            *boards,
            *books,
        ),
        tall=True,
    )


def low_shelf(style: Style) -> Design:
    """Two boards high, open to the front: objects stand on the middle board and on top."""
    depth_m, height_m, middle_m, board_m, foot_m = 0.35, 0.70, 0.35, 0.03, 0.04
    width_m, inner_m = style.width_m, style.width_m - 2.0 * board_m
    sides = tuple(
        box(
            (0.0, sign * (width_m - board_m) / 2.0, (height_m - board_m) / 2.0),
            (depth_m, board_m, height_m - board_m),
            style.main,
        )
        for sign in (-1, 1)
    )
    boxes_w = inner_m / 2.0 - 0.04
    bins = tuple(
        part
        for sign in (-1, 1)
        for part in (
            box(
                (0.01, sign * inner_m / 4.0, foot_m + board_m + 0.11),
                (depth_m - 0.06, boxes_w, 0.22),
                style.accent,
            ),
            cylinder(
                (depth_m / 2.0 - 0.015, sign * inner_m / 4.0, foot_m + board_m + 0.15), 0.03, 0.01, STEEL
            ),
        )
    )
    return Design(
        depth_m=depth_m,
        width_m=width_m,
        height_m=height_m,
        parts=(
            *sides,
            box((0.0, 0.0, height_m - board_m / 2.0), (depth_m, width_m, board_m), style.main),
            box((0.0, 0.0, middle_m - board_m / 2.0), (depth_m, inner_m, board_m), style.main),
            box((0.0, 0.0, foot_m + board_m / 2.0), (depth_m, inner_m, board_m), style.main),
            box(
                (-depth_m / 2.0 + 0.01, 0.0, (middle_m + height_m - board_m) / 2.0),
                (0.02, inner_m, height_m - board_m - middle_m),
                style.main.shaded(0.6),
            ),
            *bins,
        ),
        surfaces=(
            surface_at(depth_m, width_m, height_m),
            surface_at(depth_m - 0.02, inner_m, middle_m, x_m=0.01),
            wall_behind(depth_m, width_m, height_m),
        ),
    )


BOOKS_PER_SHELF = 6
BOOK_SHARES = (0.13, 0.16, 0.11, 0.18, 0.12, 0.15, 0.14)
BOOK_HEIGHTS_M = (0.27, 0.23, 0.29, 0.21, 0.25, 0.28, 0.24, 0.22, 0.26)
BOOK_DEPTHS_M = (0.21, 0.24, 0.19, 0.22)
BOOK_COVERS = materials(
    "red paper",
    "navy paper",
    "green paper",
    "cream paper",
    "orange paper",
    "brown leather",
    "turquoise paper",
    "charcoal paper",
    "yellow paper",
    "purple paper",
    "beige paper",
)
SHELVES = (
    FurnitureKind(
        kind="bookcase", build=bookcase, widths_m=(0.80, 0.90, 1.00), mains=WOODS, accents=BOOK_COVERS
    ),
    FurnitureKind(
        kind="low shelf",
        build=low_shelf,
        widths_m=(0.80, 1.00),
        mains=WOODS,
        accents=materials(
            "blue fabric", "grey checked fabric", "yellow plastic", "red striped fabric", "turquoise plastic"
        ),
    ),
)
