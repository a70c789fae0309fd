"""The detector's figures from a bag, on images that are small enough to count."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.serialization import serialize_message

from bags.bag_commands import bag_app
from bags.definitions import message_definition
from bags.detection_metrics import detection_figures
from bags.manifest import Manifest
from bags.reader import open_bag
from bags.writer import BagWriter
from robustnav_msgs_py import contract, conversions
from robustnav_msgs_py.detector_statistics import read_detector_statistics
from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import Detections, VisibleObjects

BOXES = np.array([[10, 10, 30, 30], [50, 10, 70, 30]], np.float32)
Say = tuple[str, Any]


def seen(stamp_ns: int, labels: Sequence[int]) -> Say:
    """Objects at BOXES, 2 m ahead."""
    count = len(labels)
    objects = VisibleObjects(
        position_m=np.tile(np.array([0.0, 0.0, 2.0], np.float32), (count, 1)),
        label=np.array(labels, np.uint32),
        instance=np.arange(count, dtype=np.uint32),
        visible_fraction=np.ones(count, np.float32),
        box_px=BOXES[:count],
        stamp_ns=stamp_ns,
    )
    return "truth/visible", conversions.visible_to_message(objects)


def said(stamp_ns: int, labels: Sequence[int]) -> Say:
    """Detections at BOXES."""
    count = len(labels)
    found = Detections(
        position_m=np.zeros((count, 3), np.float32),
        score=np.full(count, 0.8, np.float32),
        label=np.array(labels, np.uint32),
        box_px=BOXES[:count],
        stamp_ns=stamp_ns,
    )
    return "detections", conversions.detections_to_message(found)


NAMES = (
    ("truth/labels", conversions.labels_to_message(("mug", "book", "cat"))),
    ("detections/labels", conversions.labels_to_message(("book", "mug", "dog"))),
)


@pytest.fixture
def bag_of(tmp_path: Path, manifest: Manifest) -> Callable[..., Path]:
    def make(messages: Sequence[Say], folder: str = "bag") -> Path:
        with BagWriter(tmp_path / folder, manifest=manifest) as writer:
            channels = {
                name: writer.add_topic(f"/{name}", message_definition(contract.topic(name).type, ()))
                for name, _ in messages
            }
            for number, (name, message) in enumerate(messages):
                data = serialize_message(message)
                writer.write(channels[name], log_time_ns=number, publish_time_ns=number, data=data)
        return tmp_path / folder

    return make


def test_figures_by_hand(bag_of: Callable[..., Path]) -> None:
    """Numbers differ between the two lists of names; a cat and a dog that only one of them knows do not
    count, nor does an image that only one of them saw.
    """
    first = (seen(1, [0, 1]), said(1, [1, 0]))
    second = (seen(2, [0, 2]), said(2, [0, 2]))
    with open_bag(bag_of([*NAMES, *first, *second, seen(3, [0])])) as bag:
        tally = detection_figures(bag)
    assert tally.images == 2
    rows = {row.label: row for row in tally.class_scores()}
    assert (rows["mug"].objects, rows["mug"].precision, rows["mug"].recall) == (2, 1.0, 0.5)
    assert (rows["book"].objects, rows["book"].precision, rows["book"].recall) == (1, 0.5, 1.0)
    assert rows["all"].objects == 3
    assert [(share.low, share.objects) for share in tally.recall_by_range()] == [(2.0, 3)]


@pytest.mark.parametrize(
    ("messages", "words"),
    [
        ([*NAMES, said(1, [0])], "has no truth/visible"),
        ([NAMES[1], seen(1, [0]), said(1, [0])], "has no truth/labels"),
        ([*NAMES, seen(1, [0]), said(2, [0])], "never of the same image"),
    ],
)
def test_a_bag_that_cannot_tell_is_refused(
    bag_of: Callable[..., Path], messages: Sequence[Say], words: str
) -> None:
    with open_bag(bag_of(messages)) as bag, pytest.raises(BadFileError, match=words):
        detection_figures(bag)


def run(*arguments: object) -> None:
    bag_app(["detection", *map(str, arguments)], standalone_mode=False)


def test_bags_become_the_statistics_that_belief_and_planner_read(
    bag_of: Callable[..., Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Over both bags a mug is found in two of four images, and nothing else is ever taken for one."""
    bags = [bag_of([*NAMES, seen(1, [0]), said(1, [1]), seen(2, [0]), said(2, [])], name) for name in "ab"]
    run(*bags, "--statistics", tmp_path / "s.json", "--plots", tmp_path, "--json", tmp_path / "r.json")
    told = read_detector_statistics(tmp_path / "s.json")
    mug = told.of("mug")
    assert 0.3 < mug.recall < 0.7
    assert 0.7 < mug.precision < 0.8  # a class of few detections borrows from all
    assert mug.recall_by_range is not None
    report = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
    rows = {row["class"]: row for row in report["rows"]}
    assert (rows["mug"]["recall"], rows["mug"]["objects"], rows["all"]["images"]) == (0.5, 4, 4)
    assert {path.name for path in tmp_path.glob("*.png")} == {"reliability.png", "recall_over_distance.png"}
    assert "4 images" in capsys.readouterr().out


def test_bags_of_different_detectors_are_not_mixed(bag_of: Callable[..., Path]) -> None:
    first = bag_of([*NAMES, seen(1, [0]), said(1, [1])], "a")
    other = ("detections/labels", conversions.labels_to_message(("mug", "book")))
    second = bag_of([NAMES[0], other, seen(1, [0]), said(1, [0])], "b")
    with pytest.raises(BadFileError, match="other classes"):
        run(first, second)


def test_a_folder_for_plots_must_be_there(bag_of: Callable[..., Path], tmp_path: Path) -> None:
    with pytest.raises(BadParameterError, match="make it first"):
        run(bag_of([*NAMES, seen(1, [0]), said(1, [1])]), "--plots", tmp_path / "nowhere")
