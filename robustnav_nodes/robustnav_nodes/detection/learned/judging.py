"""How good the learned detector is on pictures of homes that it has never seen."""

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Bool, ColorImage, Float32, Float64
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.evaluation import (
    TrueBoxes,
    first_is_right,
    match_boxes,
    mean_average_precision,
    share_found,
)
from robustnav_nodes.detection.learned.detector import LearnedDetector
from robustnav_nodes.detection.learned.network import EMBEDDING
from robustnav_nodes.detection.learned.training_pictures import ObjectTable, PictureSet

# What a detector is asked to find: so many pixels, so much of itself.
COUNTS_PX, COUNTS_FRACTION = 150, 0.50
DISTANCE_EDGES_M = np.array([0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0])
ALIKE, ALIKE_RANGE_M = 5, 2.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judgement:
    """What was measured.

    mean_ap and ap [classes] at an IoU of 0.5, over objects that count (COUNTS_PX, COUNTS_FRACTION); objects
    [classes], how many there were; recall [bins] over DISTANCE_EDGES_M of the boxes of at least `score_min`,
    and of how many objects [bins], all that are visible enough, however small; precision and recall_at_score
    of those boxes.
    """

    mean_ap: float
    ap: Float64
    objects: NDArray[np.int64]
    score_min: float
    precision: float
    recall_at_score: float
    recall: Float64
    recall_objects: NDArray[np.int64]


def image_of(pictures: PictureSet, number: int) -> ColorImage:
    """One picture as a detector gets it."""
    return ColorImage(pixels=np.array(pictures.pixels[number]), stamp_ns=0, frame_id="camera_optical_frame")


def truth_of(table: ObjectTable, number: int) -> TrueBoxes:
    """What one picture shows, and what of it counts."""
    rows = table.rows_of(number)
    return TrueBoxes(
        box_px=table.box_px[rows],
        label=table.label[rows].astype(np.uint32),
        counts=(table.visible_px[rows] >= COUNTS_PX) & (table.visible_fraction[rows] >= COUNTS_FRACTION),
    )


def judge(found: list[Boxes], pictures: PictureSet, score_min: float) -> Judgement:
    """Judge what was found in each of the pictures (with low scores too)."""
    table = pictures.objects
    truth = [truth_of(table, number) for number in range(len(pictures))]
    mean_ap, ap = mean_average_precision(found, truth, len(pictures.labels))
    counts = np.concatenate([real.counts for real in truth])
    sure = [boxes.above(score_min) for boxes in found]
    matches = [match_boxes(boxes, real) for boxes, real in zip(sure, truth, strict=True)]
    is_found = np.concatenate([matched.found_by >= 0 for matched in matches])
    judged = np.concatenate([~matched.ignored for matched in matches])
    right = np.concatenate([matched.truth_of >= 0 for matched in matches])
    visible = table.visible_fraction >= COUNTS_FRACTION
    recall, recall_objects = share_found(
        table.distance_m[visible].astype(np.float64), is_found[visible], DISTANCE_EDGES_M
    )
    return Judgement(
        mean_ap=mean_ap,
        ap=ap,
        objects=np.bincount(table.label[counts], minlength=len(pictures.labels)),
        score_min=score_min,
        precision=float(right[judged].mean()) if judged.any() else float("nan"),
        recall_at_score=float(is_found[counts].mean()) if counts.any() else float("nan"),
        recall=recall,
        recall_objects=recall_objects,
    )


def look_alike_trials(
    detector: LearnedDetector,
    found: list[Boxes],
    pictures: PictureSet,
    rng: np.random.Generator,
) -> tuple[float, float, int]:
    """How often the reference is recognised among five of its class in its home, each seen from somewhere.

    The reference is one view of the object; the candidates are another view of it and one of each of four
    others, all within ALIKE_RANGE_M and visible enough. A view's box is the detector's where it found the
    object, else the true one. Gives the share by look alone, that with known depth, and the trials.
    """
    table = pictures.objects
    near = (
        (table.distance_m <= ALIKE_RANGE_M)
        & (table.visible_px >= COUNTS_PX)
        & (table.visible_fraction >= COUNTS_FRACTION)
    )
    boxes = _boxes_of_objects(found, pictures)
    unknown = np.full(len(table), np.nan, dtype=np.float32)
    by_look = _looks(detector, pictures, boxes, unknown, near)
    by_both = _looks(detector, pictures, boxes, table.ahead_m / table.focal_px, near)
    views: dict[tuple[int, int], dict[int, list[int]]] = defaultdict(lambda: defaultdict(list))
    for row in np.flatnonzero(near).tolist():
        views[int(table.home[row]), int(table.label[row])][int(table.instance[row])].append(row)
    right: tuple[list[bool], list[bool]] = ([], [])
    for objects in views.values():
        if len(objects) < ALIKE:
            continue
        for target, own in objects.items():
            if len({int(table.picture[row]) for row in own}) < 2:
                continue
            reference, again = rng.choice(own, 2, replace=False).tolist()
            others = rng.choice([other for other in objects if other != target], ALIKE - 1, replace=False)
            rows = np.array([again, *(int(rng.choice(objects[other])) for other in others.tolist())])
            for found_right, looks in zip(right, (by_look, by_both), strict=True):
                found_right.append(first_is_right(looks[rows].astype(np.float64) @ looks[reference], 0))
    if not right[0]:
        return float("nan"), float("nan"), 0
    return float(np.mean(right[0])), float(np.mean(right[1])), len(right[0])


def _boxes_of_objects(found: list[Boxes], pictures: PictureSet) -> Float32:
    """For each object in each picture the box that a detector found, else the true one: [rows, 4]."""
    table = pictures.objects
    boxes = table.box_px.copy()
    for number in range(len(pictures)):
        rows = table.rows_of(number)
        found_by = match_boxes(found[number], truth_of(table, number)).found_by
        is_found: Bool = found_by >= 0
        boxes[rows][is_found] = found[number].box_px[found_by[is_found]]
    return boxes


def _looks(
    detector: LearnedDetector, pictures: PictureSet, boxes: Float32, metres_per_px: Float32, wanted: Bool
) -> Float32:
    table = pictures.objects
    looks = np.zeros((len(table), EMBEDDING), dtype=np.float32)
    for number in np.unique(table.picture[wanted]).tolist():
        rows = np.arange(len(table))[table.rows_of(number)]
        rows = rows[wanted[rows]]
        looks[rows] = detector.embed(image_of(pictures, number), boxes[rows], metres_per_px[rows])
    return looks
