"""The public repositories that the semantic R2R pack is made of, as they lie in local copies.

Fine-Grained-R2R: data/FGR2R_<split>.json, or source/R2R-original/R2R_<split>.json where that is missing.
Matterport3DSimulator: connectivity/<scan>_connectivity.json. REVERIE: tasks/REVERIE/data/BBox/, a file
<scan>_<viewpoint>.json each. Matterport: tasks/region_classification/data/ and metadata/category_mapping.tsv.
"""

import ast
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.text_files import read_json_object, read_lines, read_text
from robustnav_nodes.instruction.pack_lines import Row
from robustnav_nodes.instruction.trajectory import ROOM_TYPES

_POSE = 16
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
        chunks = ast.literal_eval(row.text("new_instructions"))
    except (ValueError, SyntaxError) as error:
        raise row.wrong("new_instructions", row.text("new_instructions"), "nested lists of words") from error
    spans = row.items("chunk_view")
    found = []
    for words, views in zip(chunks, spans, strict=False):
        found.append(
            [(list(chunk), first - 1, last - 1) for chunk, (first, last) in zip(words, views, strict=False)]
        )
    return found


def read_connectivity(folders: SourceFolders, scan: str) -> list[ScanViewpoint]:
    """The viewpoints of a scan in the order of the file. Raises BadFileError."""
    path = folders.simulator / "connectivity" / f"{scan}_connectivity.json"
    found = []
    for number, item in enumerate(_list(path)):
        row = Row(item, f"viewpoint {number} of {str(path)!r}")
        pose = row.numbers("pose", _POSE)
        found.append(
            ScanViewpoint(
                name=row.text("image_id"),
                position_m=(pose[3], pose[7], pose[11]),
                height_m=row.number("height"),
                unobstructed=tuple(bool(flag) for flag in row.items("unobstructed")),
                visible=tuple(bool(flag) for flag in row.items("visible")),
                included=row.flag("included"),
            )
        )
    return found


def read_boxes(folders: SourceFolders, scan: str, viewpoint: str) -> list[BoxedObject]:
    """The objects listed near a viewpoint, by number; none where it has no file."""
    path = folders.reverie / "tasks/REVERIE/data/BBox" / f"{scan}_{viewpoint}.json"
    if not path.exists():
        return []
    listed = Row(read_json_object(path), repr(str(path)))
    found = []
    for number, item in sorted(listed.objects(viewpoint).items(), key=lambda pair: int(pair[0])):
        views = item.items("visible_pos")
        boxes = item.items("bbox2d")
        if len(views) != len(boxes):
            raise item.wrong("bbox2d", boxes, f"one box for each of {len(views)} views")
        found.append(
            BoxedObject(
                number=int(number),
                name=item.text("name"),
                boxes=tuple(
                    (int(view), (float(box[0]), float(box[1]), float(box[2]), float(box[3])))
                    for view, box in zip(views, boxes, strict=True)
                ),
            )
        )
    return found


def read_rooms(folders: SourceFolders) -> dict[str, str]:
    """The room type of each viewpoint that Matterport's lists of panoramas name."""
    found = {}
    for part in ("train", "test"):
        images = read_lines(folders.matterport / _REGIONS / f"{part}_room_pano_image.txt")
        labels = read_lines(folders.matterport / _REGIONS / f"{part}_room_pano_label.txt")
        for image, label in zip(images, labels, strict=True):
            number = int(label) - 1
            if not 0 <= number < len(ROOM_TYPES):
                raise BadFileError(f"the room label {label!r} is none of 1..{len(ROOM_TYPES)}")
            found[Path(image.strip()).stem] = ROOM_TYPES[number]
    return found


def read_categories(folders: SourceFolders) -> dict[str, str]:
    """Matterport's class (mpcat40) of each raw name."""
    lines = read_text(folders.matterport / "metadata/category_mapping.tsv").splitlines()
    names = lines[0].split("\t")
    raw, category = names.index("raw_category"), names.index("mpcat40")
    return {cells[raw]: cells[category] for line in lines[1:] if len(cells := line.split("\t")) > category}


def _list(path: Path) -> Iterator[Any]:
    try:
        content = json.loads(read_text(path))
    except ValueError as error:
        raise BadFileError(f"{str(path)!r} is not JSON: {error}; get the file anew") from error
    if not isinstance(content, list):
        raise BadFileError(f"{str(path)!r} must hold a list, not {str(content)[:60]!r}")
    yield from content
