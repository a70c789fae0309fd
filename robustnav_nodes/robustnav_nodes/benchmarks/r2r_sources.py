"""The public repositories that the semantic R2R pack is made of, as they lie in local copies.

Fine-Grained-R2R: data/FGR2R_<split>.json, or source/R2R-original/R2R_<split>.json where that is missing.
Matterport3DSimulator: connectivity/<scan>_connectivity.json. REVERIE: tasks/REVERIE/data/BBox/, a file
<scan>_<viewpoint>.json each. Matterport: tasks/region_classification/data/ and metadata/category_mapping.tsv.
"""

import ast
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.text_files import read_json_object, read_lines, read_text
from robustnav_nodes.instruction.pack_lines import Row, as_number
from robustnav_nodes.instruction.trajectory import ROOM_TYPES

_POSE = 16
_VIEWS = 36
_LABELS = {str(number): room for number, room in enumerate(ROOM_TYPES, start=1)}
_BOXES = Path("tasks/REVERIE/data/BBox")
_REGIONS = Path("tasks/region_classification/data")


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceFolders:
    """Where the four copies lie."""

    fine_grained: Path
    simulator: Path
    reverie: Path
    matterport: Path


@dataclass(frozen=True, slots=True, kw_only=True)
class ScanViewpoint:
    """A viewpoint of a scan's connectivity file; `unobstructed` and `visible` by number in the file."""

    name: str
    position_m: tuple[float, float, float]
    height_m: float
    unobstructed: tuple[bool, ...]
    visible: tuple[bool, ...]
    included: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class BoxedObject:
    """An object near a viewpoint, with its boxes (x, y, w, h in pixels) by the number of the view."""

    number: int
    name: str
    boxes: tuple[tuple[int, tuple[float, float, float, float]], ...]


def read_paths(folders: SourceFolders, split: str) -> list[Row]:
    """The paths of a split with their instructions; of its copy of R2R where it has no aligned ones."""
    path = folders.fine_grained / "data" / f"FGR2R_{split}.json"
    if not path.exists():
        path = folders.fine_grained / "source/R2R-original" / f"R2R_{split}.json"
    return [Row(item, f"path {k} of {str(path)!r}") for k, item in enumerate(_list(path))]


def sub_instructions(row: Row) -> list[list[tuple[list[str], int, int]]] | None:
    """Chunks of each instruction with the first and last viewpoint, from 0; None where there are none."""
    if not (row.has("new_instructions") and row.has("chunk_view")):
        return None
    try:
        said = ast.literal_eval(row.text("new_instructions"))
    except (ValueError, SyntaxError, MemoryError, RecursionError) as error:
        raise row.wrong("new_instructions", row.text("new_instructions"), "nested lists of words") from error
    if not _is_nested(said, 3, str):
        raise row.wrong("new_instructions", said, "lists (instructions) of lists (chunks) of words")
    spans = row.items("chunk_view")
    if not _is_nested(spans, 3, int) or any(len(span) != 2 for views in spans for span in views):
        raise row.wrong(
            "chunk_view", spans, "a first and a last viewpoint for each chunk of each instruction"
        )
    count = len(row.items("path"))
    if any(not 1 <= first <= last <= count for views in spans for first, last in views):
        raise row.wrong("chunk_view", spans, f"viewpoints from 1 to {count}, the first before the last")
    # a few instructions of the public file have more chunks than views: those are left out
    return [
        [(chunk, first - 1, last - 1) for chunk, (first, last) in zip(chunks, views, strict=False)]
        for chunks, views in zip(said, spans, strict=False)
    ]


def read_connectivity(folders: SourceFolders, scan: str) -> list[ScanViewpoint]:
    """The viewpoints of a scan in the order of the file. Raises BadFileError."""
    path = folders.simulator / "connectivity" / f"{scan}_connectivity.json"
    found = []
    items = _list(path)
    for number, item in enumerate(items):
        row = Row(item, f"viewpoint {number} of {str(path)!r}")
        pose = row.numbers("pose", _POSE)
        found.append(
            ScanViewpoint(
                name=row.text("image_id"),
                position_m=(pose[3], pose[7], pose[11]),
                height_m=row.number("height"),
                unobstructed=_flags(row, "unobstructed", len(items)),
                visible=_flags(row, "visible", len(items)),
                included=row.flag("included"),
            )
        )
    return found


def check_boxes(folders: SourceFolders) -> None:
    """Raises BadFileError where there is no file of boxes at all: a pack without objects would come of it."""
    folder = folders.reverie / _BOXES
    if not any(folder.glob("*.json")):
        raise BadFileError(
            f"{str(folder)!r} holds no boxes of objects; name a copy of REVERIE whose {_BOXES} is unpacked"
        )


def read_boxes(folders: SourceFolders, scan: str, viewpoint: str) -> list[BoxedObject]:
    """The objects listed near a viewpoint, by number; none where it has no file."""
    path = folders.reverie / _BOXES / f"{scan}_{viewpoint}.json"
    if not path.exists():
        return []
    listed = Row(read_json_object(path), repr(str(path)))
    found = []
    objects = listed.objects(viewpoint)
    for name in objects:
        if not name.isdecimal():
            raise listed.wrong(viewpoint, name, "an object of objects by their numbers")
    for number, item in sorted(objects.items(), key=lambda pair: int(pair[0])):
        views = item.items("visible_pos")
        if not all(isinstance(view, int) and 0 <= view < _VIEWS for view in views):
            raise item.wrong("visible_pos", views, f"numbers of views below {_VIEWS}")
        boxes = item.items("bbox2d")
        if len(views) != len(boxes):
            raise item.wrong("bbox2d", boxes, f"one box for each of {len(views)} views")
        found.append(
            BoxedObject(
                number=int(number),
                name=item.text("name"),
                boxes=tuple((view, _box(item, box)) for view, box in zip(views, boxes, strict=True)),
            )
        )
    return found


def read_rooms(folders: SourceFolders) -> dict[str, str]:
    """The room type of each viewpoint that Matterport's lists of panoramas name."""
    found = {}
    for part in ("train", "test"):
        images = read_lines(folders.matterport / _REGIONS / f"{part}_room_pano_image.txt")
        labels = read_lines(folders.matterport / _REGIONS / f"{part}_room_pano_label.txt")
        if len(images) != len(labels):
            raise BadFileError(
                f"{part}_room_pano_image.txt in {str(folders.matterport / _REGIONS)!r} names {len(images)} "
                f"pictures, and {part}_room_pano_label.txt {len(labels)} labels; get both anew"
            )
        for image, label in zip(images, labels, strict=True):
            if label.strip() not in _LABELS:
                raise BadFileError(
                    f"the room label {label!r} of {image.strip()!r} in {part}_room_pano_label.txt is none of "
                    f"1..{len(ROOM_TYPES)}"
                )
            found[Path(image.strip()).stem] = _LABELS[label.strip()]
    return found


def read_categories(folders: SourceFolders) -> dict[str, str]:
    """Matterport's class (mpcat40) of each raw name."""
    path = folders.matterport / "metadata/category_mapping.tsv"
    lines = read_text(path).splitlines()
    names = lines[0].split("\t") if lines else []
    if not {"raw_category", "mpcat40"} <= set(names):
        raise BadFileError(f"{str(path)!r} must have the columns raw_category and mpcat40; get the file anew")
    raw, category = names.index("raw_category"), names.index("mpcat40")
    rows = [cells for line in lines[1:] if len(cells := line.split("\t")) > max(raw, category)]
    return {cells[raw]: cells[category] for cells in rows}


def _is_nested(value: object, depth: int, leaf: type) -> bool:
    """Whether it is lists in lists, so many deep, of `leaf`."""
    if depth == 0:
        return isinstance(value, leaf) and not isinstance(value, bool)
    return isinstance(value, list) and all(_is_nested(item, depth - 1, leaf) for item in value)


def _flags(row: Row, name: str, count: int) -> tuple[bool, ...]:
    """One for each viewpoint of the file."""
    flags = row.items(name)
    if len(flags) != count:
        raise row.wrong(name, flags, f"a flag for each of the {count} viewpoints of the file")
    return tuple(bool(flag) for flag in flags)


def _box(item: Row, box: object) -> tuple[float, float, float, float]:
    numbers = [as_number(side) for side in box] if isinstance(box, list) else []
    x, y, w, h = numbers if len(numbers) == len("xywh") else [None] * len("xywh")
    if x is None or y is None or w is None or h is None:
        raise item.wrong("bbox2d", box, "boxes of four numbers: x, y, width, height")
    return x, y, w, h


def _list(path: Path) -> list[Any]:
    try:
        content = json.loads(read_text(path))
    except (ValueError, RecursionError) as error:
        raise BadFileError(f"{str(path)!r} is not JSON: {error}; get the file anew") from error
    if not isinstance(content, list):
        raise BadFileError(f"{str(path)!r} must hold a list, not {str(content)[:60]!r}")
    return content
