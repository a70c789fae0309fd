"""Builds the semantic R2R pack from local copies of the public repositories that it is made of."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.r2r_objects import AngularBox, Located, angular_box, bearing, locate_all
from robustnav_nodes.benchmarks.r2r_rooms import out_of_fold_evidence
from robustnav_nodes.benchmarks.r2r_sources import (
    BoxedObject,
    ScanViewpoint,
    SourceFolders,
    check_boxes,
    read_boxes,
    read_categories,
    read_connectivity,
    read_paths,
    read_rooms,
    sub_instructions,
)
from robustnav_nodes.instruction.pack_errors import TRAIN, write_errors
from robustnav_nodes.instruction.pack_lines import Row
from robustnav_nodes.instruction.pack_writing import PackWriter

Line = dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Scan:
    """One scan: its included viewpoints, the objects that each lists, and where the objects are."""

    name: str
    viewpoints: tuple[ScanViewpoint, ...]
    numbers: tuple[int, ...]  # of the viewpoints, in the file of the connectivity
    listed: Mapping[str, Sequence[tuple[BoxedObject, AngularBox | None]]]
    objects: Mapping[int, tuple[str, Located, int]]


def build_r2r_pack(
    folders: SourceFolders,
    folder: Path,
    splits: Sequence[str],
    seed: int,
    advanced: Callable[[str], object] = lambda scan: None,
) -> dict[str, int]:
    """Write the pack of these splits into `folder`, with errors put in by our own injection.

    `advanced` is told each scan that is done. Returns how much there is of what. Raises BadFileError, and
    leaves nothing, where a source is not as it should be, the folder holds anything, or `train`, of which
    common sense is learnt, is not among the splits.
    """
    if TRAIN not in splits:
        raise BadFileError(f"the splits {', '.join(splits)} lack {TRAIN}, of which common sense is learnt")
    check_boxes(folders)
    with PackWriter(folder) as writer:
        return _write(writer, folders, splits, seed, advanced)


def _write(
    writer: PackWriter,
    folders: SourceFolders,
    splits: Sequence[str],
    seed: int,
    advanced: Callable[[str], object],
) -> dict[str, int]:
    paths = {split: read_paths(folders, split) for split in splits}
    labels = read_rooms(folders)
    names = sorted({row.text("scan") for rows in paths.values() for row in rows})
    scans = []
    for name in names:
        scans.append(_read_scan(folders, name))
        advanced(name)
    evidence = out_of_fold_evidence(
        {
            viewpoint.name: (scan.name, [item.name for item, _ in scan.listed[viewpoint.name]])
            for scan in scans
            for viewpoint in scan.viewpoints
        },
        labels,
    )
    categories = read_categories(folders)
    counts = {
        "scans": len(scans),
        "viewpoints": sum(len(scan.viewpoints) for scan in scans),
        "objects": sum(len(scan.objects) for scan in scans),
        **{f"{split} paths": len(rows) for split, rows in paths.items()},
    }
    writer.meta(source="R2R, Fine-Grained-R2R, REVERIE, Matterport3D", scans=names, counts=counts)
    writer.rows("viewpoints.jsonl.gz", (line for scan in scans for line in _viewpoints(scan, labels)))
    writer.rows("objects3d.jsonl.gz", (line for scan in scans for line in _objects(scan, categories)))
    writer.rows("graph.jsonl.gz", map(_graph, scans))
    writer.rows(
        "rooms.jsonl.gz",
        (
            {"scan": scan.name, "vp": viewpoint.name, "probs": evidence[viewpoint.name]}
            for scan in scans
            for viewpoint in scan.viewpoints
        ),
    )
    for split, rows in paths.items():
        writer.rows(f"r2r_{split}.jsonl.gz", map(_path, rows))
    write_errors(writer, splits, seed)
    return counts


def _read_scan(folders: SourceFolders, name: str) -> _Scan:
    everything = read_connectivity(folders, name)
    numbers = tuple(number for number, viewpoint in enumerate(everything) if viewpoint.included)
    viewpoints = tuple(everything[number] for number in numbers)
    listed = {
        viewpoint.name: [(item, angular_box(item)) for item in read_boxes(folders, name, viewpoint.name)]
        for viewpoint in viewpoints
    }
    positions = {viewpoint.name: np.array(viewpoint.position_m) for viewpoint in viewpoints}
    return _Scan(
        name=name,
        viewpoints=viewpoints,
        numbers=numbers,
        listed=listed,
        objects=locate_all(positions, listed),
    )


def _viewpoints(scan: _Scan, labels: Mapping[str, str]) -> Iterator[Line]:
    for viewpoint in scan.viewpoints:
        x, y, z = viewpoint.position_m
        yield {
            "scan": scan.name,
            "vp": viewpoint.name,
            "x": round(x, 3),
            "y": round(y, 3),
            "z": round(z, 3),
            "height": round(viewpoint.height_m, 3),
            "room": labels.get(viewpoint.name),
            "objects": [
                _listed(np.array(viewpoint.position_m), item, box, scan.objects[item.number][1])
                for item, box in scan.listed[viewpoint.name]
            ],
        }


def _listed(origin: Float64, item: BoxedObject, box: AngularBox | None, located: Located) -> list[Any]:
    """A line's object: measured here, or computed from where it is, or only its name."""
    if box is not None:
        numbers = (box.heading_rad, box.elevation_rad, box.size_sr, box.width_rad, box.height_rad)
        digits = (4, 4, 4, 3, 3)
        return [item.name, *(round(n, d) for n, d in zip(numbers, digits, strict=True)), item.number]
    if located.method == "near":
        return [item.name, None, None, None, None, None, item.number]
    heading, elevation = bearing(origin, located.position_m)
    return [item.name, round(heading, 4), round(elevation, 4), None, None, None, item.number]


def _objects(scan: _Scan, categories: Mapping[str, str]) -> Iterator[Line]:
    for number, (name, located, views) in scan.objects.items():
        x, y, z = located.position_m
        yield {
            "scan": scan.name,
            "id": number,
            "name": name,
            "x": round(x, 2),
            "y": round(y, 2),
            "z": round(z, 2),
            "method": located.method,
            "views": views,
            "residual": None if located.residual_m is None else round(located.residual_m, 3),
            "mpcat40": categories.get(name, "misc"),
        }


def _graph(scan: _Scan) -> Line:
    edges, visible = [], []
    for i, (a, here) in enumerate(zip(scan.numbers, scan.viewpoints, strict=True)):
        for j in range(i + 1, len(scan.numbers)):
            b, there = scan.numbers[j], scan.viewpoints[j]
            if here.unobstructed[b] or there.unobstructed[a]:
                edges.append([i, j, round(math.dist(here.position_m, there.position_m), 3)])
            if here.visible[b] or there.visible[a]:
                visible.append([i, j])
    return {
        "scan": scan.name,
        "viewpoints": [viewpoint.name for viewpoint in scan.viewpoints],
        "edges": edges,
        "visible": visible,
    }


def _path(row: Row) -> Line:
    line: Line = {
        "path_id": row.whole("path_id"),
        "scan": row.text("scan"),
        "heading": row.number("heading"),
        "distance": row.number("distance"),
        "path": row.texts("path"),
        "instructions": [said.strip() for said in row.texts("instructions")],
    }
    chunks = sub_instructions(row)
    if chunks is not None:
        line["sub_instructions"] = chunks
    return line
