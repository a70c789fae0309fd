"""What the rows of a scene file's lists say, each kind of row with its fields and their defaults."""

from collections.abc import Callable, Sequence
from typing import TypeVar

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.materials import Material, Pattern, Substance
from sim_bridge.homes.rect import Rect, Side
from sim_bridge.homes.scene import (
    Look,
    SceneDoor,
    SceneFurniture,
    SceneObject,
    SceneRoom,
    SceneWindow,
    Size,
    Style,
)
from sim_bridge.homes.scene_files.scene_fields import Row

# The fields of the file and of the rows in each of its lists, in the order in which they are written.
FIELDS: dict[str, tuple[str, ...]] = {
    "": (
        "format",
        "version",
        "name",
        "seed",
        "rooms",
        "doors",
        "windows",
        "furniture",
        "objects",
        "start",
    ),
    "rooms": ("name", "kind", "area", "floor", "walls"),
    "doors": ("between", "at", "width"),
    "windows": ("room", "side", "from", "to", "sill", "top"),
    "furniture": ("name", "kind", "room", "at", "facing", "width", "main", "accent"),
    "objects": ("class", "on", "surface", "at", "turn", "colour", "material", "pattern", "size"),
}
# By the number of quarter turns.
FACINGS = (Side.EAST, Side.NORTH, Side.WEST, Side.SOUTH)

DEFAULT_FLOOR = Material(substance=Substance.BOARDS, colour="oak")
DEFAULT_WALLS = Material(substance=Substance.PAINT, colour="cream")
DEFAULT_DOOR_WIDTH_M = 0.9
DEFAULT_SILL_M = 0.9
DEFAULT_TOP_M = 2.1

DefaultStyle = Callable[[str], Style]
DefaultLook = Callable[[str], Look]
Usual = TypeVar("Usual", Style, Look)


def room_of(row: Row) -> SceneRoom:
    """A row of `rooms`."""
    x_min, y_min, x_max, y_max = row.lengths_m("area", "[x min, y min, x max, y max]")
    try:
        area = Rect(x_min_m=x_min, y_min_m=y_min, x_max_m=x_max, y_max_m=y_max)
    except BadSceneError as wrong:
        raise row.error(
            f"'area' is {[x_min, y_min, x_max, y_max]}; each minimum must be below its maximum",
            "area",
        ) from wrong
    return SceneRoom(
        name=row.text("name"),
        kind=row.text("kind"),
        area=area,
        floor=row.material("floor", DEFAULT_FLOOR),
        walls=row.material("walls", DEFAULT_WALLS),
    )


def door_of(row: Row, rooms: Sequence[str]) -> SceneDoor:
    """A row of `doors`, between two of the named rooms."""
    one, other = row.texts("between", "[a room, another room]")
    for name in (one, other):
        row.require_known("between", name, rooms, "room")
    x_m, y_m = row.lengths_m("at", "[x, y]")
    return SceneDoor(
        rooms=(one, other), x_m=x_m, y_m=y_m, width_m=row.length_m("width", DEFAULT_DOOR_WIDTH_M)
    )


def window_of(row: Row, rooms: Sequence[str]) -> SceneWindow:
    """A row of `windows`, in one of the named rooms."""
    return SceneWindow(
        room=row.one_of("room", rooms, "room"),
        side=row.choice("side", Side),
        from_m=row.length_m("from"),
        to_m=row.length_m("to"),
        sill_m=row.length_m("sill", DEFAULT_SILL_M),
        top_m=row.length_m("top", DEFAULT_TOP_M),
    )


def piece_of(row: Row, rooms: Sequence[str], default_style: DefaultStyle | None) -> SceneFurniture:
    """A row of `furniture`, in one of the named rooms; `default_style` gives what it leaves out."""
    kind = row.text("kind")
    style = None
    if default_style is not None and not all(field in row for field in ("width", "main", "accent")):
        style = _default(row, "kind", kind, default_style)
    x_m, y_m = row.lengths_m("at", "[x, y]")
    return SceneFurniture(
        name=row.text("name"),
        kind=kind,
        room=row.one_of("room", rooms, "room"),
        x_m=x_m,
        y_m=y_m,
        quarter_turns=FACINGS.index(row.choice("facing", Side, Side.EAST)),
        style=Style(
            width_m=row.length_m("width", style.width_m if style else None),
            main=row.material("main", style.main if style else None),
            accent=row.material("accent", style.accent if style else None),
        ),
    )


def object_of(row: Row, pieces: Sequence[str], default_look: DefaultLook | None) -> SceneObject:
    """A row of `objects`, on one of the named pieces; `default_look` gives what it leaves out."""
    label = row.text("class")
    usual = None
    if default_look is not None and not all(field in row for field in ("colour", "material")):
        usual = _default(row, "class", label, default_look)
    look = Look(
        colour=row.colour("colour", usual.colour if usual else None),
        substance=row.choice("material", Substance, usual.substance if usual else None),
        pattern=row.choice("pattern", Pattern, Pattern.PLAIN),
        size=row.choice("size", Size, Size.MEDIUM),
    )
    x_m, y_m = row.lengths_m("at", "[x, y]")
    return SceneObject(
        label=label,
        look=look,
        furniture=row.one_of("on", pieces, "piece of furniture"),
        surface=row.whole("surface", 0),
        x_m=x_m,
        y_m=y_m,
        turn_rad=row.heading_rad("turn", 0.0),
    )


def _default(row: Row, field: str, word: str, default: Callable[[str], Usual]) -> Usual:
    try:
        return default(word)
    except BadSceneError as wrong:
        raise row.error(f"{field!r}: {wrong}", field) from wrong
