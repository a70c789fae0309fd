"""Writes a tiny pack of one home with two walks, in the format of the semantic R2R pack."""

import gzip
import json
from pathlib import Path
from typing import Any

from robustnav_nodes.instruction.concepts import OBJECTS, ROOMS
from robustnav_nodes.instruction.trajectory import ROOM_TYPES


def write_lines(path: Path, rows: list[dict[str, Any]]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(gzip.compress("".join(json.dumps(row) + "\n" for row in rows).encode()))


def write_pack(folder: Path, *, walks: int = 2) -> Path:
    """Three viewpoints going north and then east; a bed at the first, a sofa that only the second lists."""
    folder.mkdir()
    meta = {"rooms": list(ROOM_TYPES), "scans": ["home"]}
    (folder / "meta.json").write_text(json.dumps(meta))
    places = [("a", 0.0, 0.0, "bedroom"), ("b", 0.0, 3.0, "hallway"), ("c", 4.0, 3.0, "kitchen")]
    listed: dict[str, list[list[Any]]] = {
        "a": [["bed", 0.0, -0.3, 0.5, 1.0, 0.5, 1]],
        "b": [["sofa", None, None, None, None, None, 2]],
        "c": [],
    }
    write_lines(
        folder / "viewpoints.jsonl.gz",
        [
            {
                "scan": "home",
                "vp": name,
                "x": x,
                "y": y,
                "z": 1.5,
                "height": 1.5,
                "room": room,
                "objects": listed[name],
            }
            for name, x, y, room in places
        ],
    )
    write_lines(
        folder / "objects3d.jsonl.gz",
        [
            {"scan": "home", "id": number, "name": name, "x": x, "y": y, "z": 0.5}
            for number, name, x, y in ((1, "bed", 0.0, 1.5), (2, "sofa", -1.0, 3.0))
        ],
    )
    write_lines(
        folder / "graph.jsonl.gz",
        [
            {
                "scan": "home",
                "viewpoints": ["a", "b", "c"],
                "edges": [[0, 1, 3.0]],
                "visible": [[0, 1], [1, 2]],
            }
        ],
    )
    write_lines(
        folder / "rooms.jsonl.gz",
        [
            {"scan": "home", "vp": name, "probs": [0.89 if r == room else 0.01 for r in ROOM_TYPES]}
            for name, _, _, room in places
        ],
    )
    said = "Walk past the bed out of the bedroom. Turn right at the couch and stop in the kitchen."
    for split in ("train", "val_seen"):
        write_lines(
            folder / f"r2r_{split}.jsonl.gz",
            [
                {
                    "path_id": number,
                    "scan": "home",
                    "heading": 0.0,
                    "distance": 7.0,
                    "path": ["a", "b", "c"],
                    "instructions": [said],
                    "sub_instructions": [[[["walk", "out"], 0, 1], [["turn", "right"], 1, 2]]],
                }
                for number in range(walks)
            ],
        )
    priors = {
        "room_adjacency": {room: [other for other in ROOMS if other != room] for room in ROOMS},
        "object_colocation": {one: [other for other in OBJECTS if other != one] for one in OBJECTS},
    }
    (folder / "priors.json").write_text(json.dumps(priors))
    return folder


def write_episodes(folder: Path, rows: list[dict[str, Any]], split: str = "val_seen") -> None:
    write_lines(folder / "errors_uniform" / f"{split}_direction.jsonl.gz", rows)
