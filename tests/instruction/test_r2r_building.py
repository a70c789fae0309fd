"""The pack of real walks from copies of its sources: a made-up scan in their formats, with known places."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.r2r_building import build_r2r_pack
from robustnav_nodes.benchmarks.r2r_objects import angular_box, bearing, locate
from robustnav_nodes.benchmarks.r2r_sources import BoxedObject, SourceFolders, read_connectivity
from robustnav_nodes.instruction.pack_lines import PackFolder
from robustnav_nodes.instruction.r2r_pack import R2rPack

SAID = "Walk out of the bedroom past the bed. Turn right and stop in the kitchen next to the sink."
BOXES = "reverie/tasks/REVERIE/data/BBox/one_onea.json"
CHUNKS = [[["walk", "out", "of", "the", "bedroom", "past", "the", "bed"], ["turn", "right", "and", "stop"]]]


def box_in(view: int, heading: float, elevation: float, half_px: float = 20.0) -> list[float]:
    """A box around a direction in a level view (12..23)."""
    focal = 240.0 / math.tan(math.radians(30.0))
    aside = heading - math.radians(30.0) * (view - 12)
    u = 320.0 + focal * math.tan(aside)
    v = 240.0 - focal * math.tan(elevation) / math.cos(aside)
    return [u - half_px, v - half_px, 2.0 * half_px, 2.0 * half_px]


def write(path: Path, content: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(content if isinstance(content, str) else json.dumps(content))


@pytest.fixture
def folders(tmp_path: Path) -> SourceFolders:
    """Two scans alike: viewpoints a (0, 0), b (0, 3), c (4, 3); a bed at (1, 1.5) seen from a and b."""
    sources = SourceFolders(
        fine_grained=tmp_path / "fg",
        simulator=tmp_path / "sim",
        reverie=tmp_path / "reverie",
        matterport=tmp_path / "mp",
    )
    places = {"a": (0.0, 0.0), "b": (0.0, 3.0), "c": (4.0, 3.0)}
    images, labels, rows = [], [], []
    for scan in ("one", "two"):
        names = [f"{scan}{name}" for name in places]
        visible = [[i != j for j in range(4)] for i in range(4)]
        walkable = [[abs(i - j) == 1 for j in range(4)] for i in range(4)]
        points = [
            {
                "image_id": name,
                "pose": [1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, 1.5, 0, 0, 0, 1],
                "included": name in names,
                "visible": visible[k],
                "unobstructed": walkable[k],
                "height": 1.5,
            }
            for k, (name, (x, y)) in enumerate([*zip(names, places.values(), strict=True), ("x", (9, 9))])
        ]
        write(sources.simulator / "connectivity" / f"{scan}_connectivity.json", points)
        boxes = sources.reverie / "tasks/REVERIE/data/BBox"
        for name, view in (("a", 13), ("b", 17)):
            heading, elevation = bearing(np.array([*places[name], 1.5]), (1.0, 1.5, 0.7))
            bed = {
                "name": "bed",
                "visible_pos": [view],
                "bbox2d": [box_in(view, heading, elevation)],
            }
            write(boxes / f"{scan}_{scan}{name}.json", {f"{scan}{name}": {"7": bed}})
        sink = {"name": "sink", "visible_pos": [], "bbox2d": []}
        write(boxes / f"{scan}_{scan}c.json", {f"{scan}c": {"8": sink}})
        images += [f"./data/mp_sb/{scan}/{name}.jpg" for name in names]
        labels += ["11", "12", "8"]
        rows.append(
            {
                "distance": 7.0,
                "scan": scan,
                "path_id": len(rows),
                "path": names,
                "heading": 0.5,
                "instructions": [SAID + " "] * 3,
                "new_instructions": repr(CHUNKS * 3),
                "chunk_view": [[[1, 2], [2, 3]]] * 3,
            }
        )
    write(sources.fine_grained / "data/FGR2R_val_seen.json", rows)
    for row in rows:
        del row["new_instructions"], row["chunk_view"]
    write(sources.fine_grained / "source/R2R-original/R2R_train.json", rows)
    regions = sources.matterport / "tasks/region_classification/data"
    write(regions / "train_room_pano_image.txt", "\n".join(images))
    write(regions / "train_room_pano_label.txt", "\n".join(labels))
    write(regions / "test_room_pano_image.txt", "")
    write(regions / "test_room_pano_label.txt", "")
    write(sources.matterport / "metadata/category_mapping.tsv", "raw_category\tmpcat40\nbed\tbed\n")
    return sources


def test_a_pack_from_sources(folders: SourceFolders, tmp_path: Path) -> None:
    pytest.importorskip("sklearn")
    counts = build_r2r_pack(folders, tmp_path / "pack", ["train", "val_seen"], seed=1)
    assert (counts["scans"], counts["viewpoints"], counts["objects"]) == (2, 6, 4)
    pack = R2rPack(tmp_path / "pack")
    first, second, third = pack.paths("train")[0].trajectory.viewpoints
    assert (first.x_m, first.y_m, third.x_m) == (0.0, 0.0, 4.0)
    assert first.yaw_in_rad == pytest.approx(math.pi / 2.0 - 0.5)
    assert second.turn_rad == pytest.approx(-math.pi / 2.0)
    (bed,) = (seen for seen in first.objects if seen.name == "bed")
    assert bed.bearing_rad == pytest.approx(math.atan2(1.5, 1.0) - first.yaw_in_rad, abs=0.02)
    assert bed.range_m == pytest.approx(math.hypot(1.0, 1.5, 0.8), abs=0.05)
    assert pack.instructions("train")[0].tokens[-1] == "."
    (line, _) = PackFolder(tmp_path / "pack").rows("r2r_val_seen.jsonl.gz")
    assert line.items("sub_instructions")[0] == [[CHUNKS[0][0], 0, 1], [CHUNKS[0][1], 1, 2]]
    assert pack.episodes("val_seen", "uniform", "direction")


def test_two_rays_meet_and_one_does_not(folders: SourceFolders) -> None:
    seen = [view for view in read_connectivity(folders, "one") if view.included]
    here, there = (np.array(view.position_m) for view in seen[:2])
    target = (1.0, 1.5, 0.7)
    boxes = []
    for origin, view in ((here, 13), (there, 17)):
        edges = box_in(view, *bearing(origin, target))
        listed = BoxedObject(number=1, name="bed", boxes=((view, (edges[0], edges[1], edges[2], edges[3])),))
        boxes.append(angular_box(listed))
    met = locate([(here, boxes[0]), (there, boxes[1])])
    assert met.method == "tri"
    assert met.position_m == pytest.approx(target, abs=0.03)
    alone = locate([(here, boxes[0]), (there, None)])
    assert alone.method == "ray"
    assert math.dist(alone.position_m, here) == pytest.approx(1.5)
    assert locate([(here, None), (there, None)]).method == "near"


@pytest.mark.parametrize(
    ("path", "old", "new", "said"),
    [
        ("fg/data/FGR2R_val_seen.json", '"scan": "one"', '"scam": "one"', "no field 'scan'"),
        ("fg/data/FGR2R_val_seen.json", "[", "", "not JSON"),
        ("sim/connectivity/one_connectivity.json", '"pose": [1, ', '"pose": [', "16 numbers"),
        (
            "reverie/tasks/REVERIE/data/BBox/one_onea.json",
            '"visible_pos": [13]',
            '"visible_pos": []',
            "0 views",
        ),
        (BOXES, '{"7": {', '{"seven": {', "objects by their numbers"),
        (BOXES, '"bbox2d": [[', '"bbox2d": [["left", ', "four numbers"),
        (BOXES, '"visible_pos": [13]', '"visible_pos": [36]', "below 36"),
        (
            "fg/data/FGR2R_val_seen.json",
            '"chunk_view": [[[1, 2]',
            '"chunk_view": [[[1]',
            "a first and a last",
        ),
        ("fg/data/FGR2R_val_seen.json", "[[['walk'", "[[[7", "lists .chunks. of words"),
        ("fg/data/FGR2R_val_seen.json", '"heading": 0.5', '"heading": 1' + "0" * 400, "a finite number"),
        ("sim/connectivity/one_connectivity.json", '"visible": [false, ', '"visible": [', "each of the 4"),
        ("mp/tasks/region_classification/data/train_room_pano_label.txt", "11\n", "", "6 pictures"),
        ("mp/tasks/region_classification/data/train_room_pano_label.txt", "11", "hall", "room label"),
        ("mp/metadata/category_mapping.tsv", "mpcat40", "mpcat", "the columns raw_category and mpcat40"),
        ("mp/tasks/region_classification/data/train_room_pano_label.txt", "11", "13", "room label"),
        (
            "fg/source/R2R-original/R2R_train.json",
            '"path": ["onea"',
            '"path": ["nowhere"',
            "'nowhere'.*viewpoints of viewpoints",  # noticed when all but the errors is written
        ),
    ],
)
def test_a_bad_source_is_named_and_no_pack_is_left(
    folders: SourceFolders, tmp_path: Path, path: str, old: str, new: str, said: str
) -> None:
    text = (tmp_path / path).read_text()
    assert old in text
    (tmp_path / path).write_text(text.replace(old, new, 1))
    before = sorted(tmp_path.iterdir())
    with pytest.raises(BadFileError, match=said):
        build_r2r_pack(folders, tmp_path / "new" / "pack", ["train", "val_seen"], seed=1)
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("gone", ["fg", "sim", "mp", "reverie"])
def test_a_missing_source_is_named(folders: SourceFolders, tmp_path: Path, gone: str) -> None:
    (tmp_path / gone).rename(tmp_path / "elsewhere")
    with pytest.raises(BadFileError, match=gone):
        build_r2r_pack(folders, tmp_path / "pack", ["train", "val_seen"], seed=1)
