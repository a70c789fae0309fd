"""All kinds of furniture by name, and how a described piece gets its shape."""

import difflib

import numpy as np

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.furniture.bathroom import BATHROOM
from sim_bridge.homes.furniture.bedroom import BEDROOM
from sim_bridge.homes.furniture.carpentry import Design, FurnitureKind
from sim_bridge.homes.furniture.dining_room import DINING_ROOM
from sim_bridge.homes.furniture.hallway import HALLWAY
from sim_bridge.homes.furniture.kitchen import KITCHEN
from sim_bridge.homes.furniture.laundry_room import LAUNDRY_ROOM
from sim_bridge.homes.furniture.living_room import LIVING_ROOM
from sim_bridge.homes.furniture.office import OFFICE
from sim_bridge.homes.furniture.shelves import SHELVES
from sim_bridge.homes.home import Furniture
from sim_bridge.homes.scene import SceneFurniture, Style

KINDS: dict[str, FurnitureKind] = {
    entry.kind: entry
    for entry in (
        *KITCHEN,
        *DINING_ROOM,
        *LIVING_ROOM,
        *SHELVES,
        *BEDROOM,
        *OFFICE,
        *BATHROOM,
        *LAUNDRY_ROOM,
        *HALLWAY,
    )
}
WIDTH_TOLERANCE_M = 1e-6


def furniture_kind(kind: str) -> FurnitureKind:
    """The kind of that name. Raises BadSceneError with the nearest name where there is none."""
    if kind in KINDS:
        return KINDS[kind]
    near = difflib.get_close_matches(kind, KINDS, n=1)
    hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(KINDS)}"
    raise BadSceneError(f"no furniture is of the kind {kind!r}; {hint}")


def draw_style(rng: np.random.Generator, kind: str) -> Style:
    """One of the looks that a kind comes in."""
    entry = furniture_kind(kind)
    return Style(
        width_m=entry.widths_m[int(rng.integers(len(entry.widths_m)))],
        main=entry.mains[int(rng.integers(len(entry.mains)))],
        accent=entry.accents[int(rng.integers(len(entry.accents)))],
    )


def default_style(kind: str) -> Style:
    """How a kind looks where nobody says: the first of its widths and materials."""
    entry = furniture_kind(kind)
    return Style(width_m=entry.widths_m[0], main=entry.mains[0], accent=entry.accents[0])


def design(kind: str, style: Style) -> Design:
    """The shape of a kind in a style. Raises BadSceneError for an unknown kind and an unfit width."""
    entry = furniture_kind(kind)
    low_m, high_m = min(entry.widths_m), max(entry.widths_m)
    if not low_m - WIDTH_TOLERANCE_M <= style.width_m <= high_m + WIDTH_TOLERANCE_M:
        raise BadSceneError(
            f"a {kind} is {low_m:g}..{high_m:g} m wide, not {style.width_m!r} m; choose a width in that range"
        )
    return entry.build(style)


def build_furniture(piece: SceneFurniture) -> Furniture:
    """The piece with its shape. Raises BadSceneError for an unknown kind and a width that it cannot have."""
    return shaped(piece, design(piece.kind, piece.style))


def shaped(piece: SceneFurniture, shape: Design) -> Furniture:
    """The piece with a shape that `design` made of its kind and style."""
    return Furniture(
        name=piece.name,
        kind=piece.kind,
        room=piece.room,
        x_m=piece.x_m,
        y_m=piece.y_m,
        quarter_turns=piece.quarter_turns,
        style=piece.style,
        depth_m=shape.depth_m,
        width_m=shape.width_m,
        height_m=shape.height_m,
        tall=shape.tall,
        surfaces=shape.surfaces,
        parts=shape.parts,
    )
