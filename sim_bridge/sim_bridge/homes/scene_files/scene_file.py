"""Scenes in files that people can write; docs/scene_format.md describes the format.

Names, types and numbers are checked here. Whether the rooms fit together and an object stands on something is
for `build.build_home` to find out.
"""

import contextlib
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from robustnav_msgs_py.errors import BadFileError, BadSceneError
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.materials import Pattern
from sim_bridge.homes.scene import Scene, SceneDoor, SceneFurniture, SceneObject, SceneRoom, SceneWindow, Size
from sim_bridge.homes.scene_files.scene_fields import Row, degrees_text, is_plain_text
from sim_bridge.homes.scene_files.scene_rows import (
    DEFAULT_SILL_M,
    DEFAULT_TOP_M,
    FACINGS,
    FIELDS,
    DefaultLook,
    DefaultStyle,
    door_of,
    object_of,
    piece_of,
    room_of,
    window_of,
)
from sim_bridge.homes.scene_files.scene_text import MAX_BYTES, Words, parse_table

FORMAT = "robustnav scene"
VERSION = 1

MAX_ROOMS = 100
MAX_DOORS = 500
MAX_WINDOWS = 500
MAX_FURNITURE = 2000
MAX_OBJECTS = 5000

HEADER = """\
# A home for robustnav's simulator; docs/scene_format.md describes what stands here.
# Metres; x to the east, y to the north. Headings in degrees, counter-clockwise from east.
"""
# To a micrometre.
_LENGTH_DECIMALS = 6
# What needs no quotes; the rest gets them, whether YAML asks for them or not.
_SIMPLE = re.compile(r"[^\W\d_][\w .()/'-]*")
# How YAML writes that there is no value.
_NULL = ("", "null", "~")


def read_scene(
    path: Path, *, default_style: DefaultStyle | None = None, default_look: DefaultLook | None = None
) -> Scene:
    """The scene in a file; the defaults are as for `parse_scene`.

    Raises BadFileError where the file cannot be read, is too large or no text in UTF-8, and BadSceneError as
    `parse_scene` does.
    """
    try:
        with path.open("rb") as file:
            content = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise BadFileError(
            f"cannot read the scene file {str(path)!r}: {error.strerror}; name one as "
            "docs/scene_format.md describes"
        ) from error
    if len(content) > MAX_BYTES:
        raise BadFileError(
            f"the scene file {str(path)!r} is larger than {MAX_BYTES} bytes; take furniture and objects "
            "out of it"
        )
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadFileError(
            f"the scene file {str(path)!r} is not text in UTF-8: {error}; save it in that encoding"
        ) from error
    return parse_scene(text, repr(str(path)), default_style=default_style, default_look=default_look)


def parse_scene(
    text: str,
    source: str,
    *,
    default_style: DefaultStyle | None = None,
    default_look: DefaultLook | None = None,
) -> Scene:
    """The scene that a scene file's text describes; `source` names the file in errors.

    `default_style(kind)` gives a piece of furniture the `width`, `main` and `accent` that the file leaves
    out, `default_look(class)` an object its `colour` and `material`; without them these fields are required.
    Raises BadSceneError, with the line, where the text does not hold to the format.
    """
    top = Row(source=source, place="", table=parse_table(text, source))
    _check_format(top)
    top.allow(FIELDS[""])
    rooms = tuple(room_of(row) for row in _rows(top, "rooms", MAX_ROOMS, named=True))
    if not rooms:
        raise top.error("'rooms' has no rows; a home needs a room at least", "rooms")
    room_names = [room.name for room in rooms]
    pieces = tuple(
        piece_of(row, room_names, default_style) for row in _rows(top, "furniture", MAX_FURNITURE, named=True)
    )
    piece_names = [piece.name for piece in pieces]
    x_m, y_m, yaw_rad = top.pose("start")
    return Scene(
        name=top.text("name"),
        seed=_seed(top),
        rooms=rooms,
        doors=tuple(door_of(row, room_names) for row in _rows(top, "doors", MAX_DOORS)),
        windows=tuple(window_of(row, room_names) for row in _rows(top, "windows", MAX_WINDOWS)),
        furniture=pieces,
        objects=tuple(
            object_of(row, piece_names, default_look) for row in _rows(top, "objects", MAX_OBJECTS)
        ),
        start=Pose2D(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad),
    )


def scene_text(scene: Scene) -> str:
    """A scene file's text: always the same for a scene, one row a line, without what is as by default.

    `parse_scene` reads the same scene from it, but for lengths, which are rounded to a micrometre, and
    quarter turns, which come back as 0..3. Raises BadSceneError where the scene does not hold to the format.
    """
    lists = {
        "rooms": map(_room_row, scene.rooms),
        "doors": map(_door_row, scene.doors),
        "windows": map(_window_row, scene.windows),
        "furniture": map(_piece_row, scene.furniture),
        "objects": map(_object_row, scene.objects),
    }
    lines = [f"format: {FORMAT}", f"version: {VERSION}", f"name: {_words(scene.name)}"]
    if scene.seed is not None:
        lines.append(f"seed: {scene.seed}")
    for name, texts in lists.items():
        rows = [f"  - {{{', '.join(field for field in row if field)}}}" for row in texts]
        lines += [f"{name}:", *rows] if rows else []
    start = scene.start
    lines.append(f"start: {_list(_metres(start.x_m), _metres(start.y_m), degrees_text(start.yaw_rad))}")
    text = HEADER + "\n".join(lines) + "\n"
    # What nobody could read again shall not be written.
    parse_scene(text, f"the text of the scene {scene.name!r}")
    return text


def write_scene(scene: Scene, path: Path, *, replace: bool = False) -> None:
    """Write `scene` to `path`, whole or not at all; a file that is there is kept unless `replace`.

    Raises BadFileError where `path` exists already or cannot be written, and BadSceneError as `scene_text`
    does.
    """
    text = scene_text(scene)
    if path.exists() and not replace:
        raise BadFileError(f"the scene file {str(path)!r} exists already: remove it, or name another one")
    unfinished = path.with_name(path.name + ".part")
    try:
        unfinished.write_text(text, encoding="utf-8", newline="\n")
        unfinished.replace(path)
    except OSError as error:
        raise BadFileError(
            f"cannot write the scene file {str(path)!r}: {error.strerror}; choose a place that can be written"
        ) from error
    finally:
        with contextlib.suppress(OSError):
            unfinished.unlink()


def _check_format(top: Row) -> None:
    """Before anything else, because another format or version has other fields."""
    word = top.text("format")
    if word != FORMAT:
        raise top.error(f"'format' is {word!r:.80}; a scene file says 'format: {FORMAT}'", "format")
    version = top.whole("version")
    if version != VERSION:
        advice = "get a newer robustnav" if version > VERSION else f"write 'version: {VERSION}'"
        raise top.error(
            f"it is of version {version}, and this robustnav reads {VERSION} only; {advice}", "version"
        )


def _rows(top: Row, name: str, limit: int, *, named: bool = False) -> Iterator[Row]:
    """The rows of a list, with known fields only, and where `named` with a name of their own."""
    taken: dict[str, int] = {}
    for row in top.rows(name, limit):
        row.allow(FIELDS[name])
        if named:
            own = row.text("name")
            if own in taken:
                raise row.error(f"the name is taken by line {taken[own]} already; choose another one", "name")
            taken[own] = row.table.line
        yield row


def _seed(top: Row) -> int | None:
    nothing = top.table.fields.get("seed")
    if nothing is None or (isinstance(nothing, Words) and not nothing.quoted and nothing.text in _NULL):
        return None
    return top.whole("seed")


def _room_row(room: SceneRoom) -> Iterable[str]:
    area = room.area
    corners = (area.x_min_m, area.y_min_m, area.x_max_m, area.y_max_m)
    return (
        f"name: {_words(room.name)}",
        f"kind: {_words(room.kind)}",
        f"area: {_list(*map(_metres, corners))}",
        f"floor: {_words(str(room.floor))}",
        f"walls: {_words(str(room.walls))}",
    )


def _door_row(door: SceneDoor) -> Iterable[str]:
    return (
        f"between: {_list(*map(_words, door.rooms))}",
        f"at: {_list(_metres(door.x_m), _metres(door.y_m))}",
        f"width: {_metres(door.width_m)}",
    )


def _window_row(window: SceneWindow) -> Iterable[str]:
    return (
        f"room: {_words(window.room)}",
        f"side: {window.side}",
        f"from: {_metres(window.from_m)}",
        f"to: {_metres(window.to_m)}",
        f"sill: {_metres(window.sill_m)}" if window.sill_m != DEFAULT_SILL_M else "",
        f"top: {_metres(window.top_m)}" if window.top_m != DEFAULT_TOP_M else "",
    )


def _piece_row(piece: SceneFurniture) -> Iterable[str]:
    return (
        f"name: {_words(piece.name)}",
        f"kind: {_words(piece.kind)}",
        f"room: {_words(piece.room)}",
        f"at: {_list(_metres(piece.x_m), _metres(piece.y_m))}",
        f"facing: {FACINGS[piece.quarter_turns % len(FACINGS)]}",
        f"width: {_metres(piece.style.width_m)}",
        f"main: {_words(str(piece.style.main))}",
        f"accent: {_words(str(piece.style.accent))}",
    )


def _object_row(thing: SceneObject) -> Iterable[str]:
    look = thing.look
    return (
        f"class: {_words(thing.label)}",
        f"on: {_words(thing.furniture)}",
        f"surface: {thing.surface}" if thing.surface else "",
        f"at: {_list(_metres(thing.x_m), _metres(thing.y_m))}",
        f"turn: {degrees_text(thing.turn_rad)}" if thing.turn_rad else "",
        f"colour: {_words(look.colour)}",
        f"material: {look.substance}",
        f"pattern: {look.pattern}" if look.pattern is not Pattern.PLAIN else "",
        f"size: {look.size}" if look.size is not Size.MEDIUM else "",
    )


def _list(*texts: str) -> str:
    return f"[{', '.join(texts)}]"


def _metres(length_m: float) -> str:
    rounded = round(length_m, _LENGTH_DECIMALS) + 0.0  # + 0.0: no "-0"
    return f"{rounded:.{_LENGTH_DECIMALS}f}".rstrip("0").rstrip(".")


def _words(text: str) -> str:
    if not text.isprintable():
        # YAML would fold some of these signs into others.
        raise BadSceneError(f"the name {text!r} has signs that nobody can see; choose one without them")
    if _SIMPLE.fullmatch(text) and is_plain_text(text):
        return text
    escaped = text.replace("\\", r"\\").replace('"', r"\"")
    return f'"{escaped}"'
