"""How good detections are: boxes matched with the truth, average precision, recall. Knows no detector."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Bool, Float32, Float64
from robustnav_nodes.detection.boxes import Boxes

MATCH_IOU = 0.5


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TrueBoxes:
    """What one image really shows; n may be 0.

    box_px: float32 [n, 4]; label: uint32 [n]; counts: bool [n], False for what need not be found and is no
    mistake if it is (too small, too hidden).
    """

    box_px: Float32
    label: NDArray[np.uint32]
    counts: Bool

    def __len__(self) -> int:
        return len(self.label)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Matches:
    """Which detection of an image found which object.

    truth_of: int64 [detections], the row of the object that each found, -1 for none; ignored: bool
    [detections], neither right nor wrong: what they found does not count; found_by: int64 [objects], the row
    of the detection that found each, -1 for none.
    """

    truth_of: NDArray[np.int64]
    ignored: Bool
    found_by: NDArray[np.int64]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PrecisionRecall:
    """Precision over recall of one class, threshold by threshold from the highest score down; n may be 0.

    score, precision, recall: float64 [n]; average_precision: NaN where no object of the class counts.
    """

    score: Float64
    precision: Float64
    recall: Float64
    objects: int
    average_precision: float


def iou(first: Float32, second: Float32) -> Float64:
    """Intersection over union of boxes [n, 4] with boxes [m, 4]: [n, m]; 0 where both have no area."""
    low = np.maximum(first[:, None, :2], second[None, :, :2]).astype(np.float64)
    high = np.minimum(first[:, None, 2:], second[None, :, 2:])
    shared = np.clip(high - low, 0.0, None).prod(axis=2)
    union = area(first)[:, None] + area(second)[None, :] - shared
    return np.asarray(np.divide(shared, union, out=np.zeros_like(shared), where=union > 0.0))


def area(box_px: Float32) -> Float64:
    """Area of boxes [n, 4]: [n]; 0 where the upper bound is not above the lower."""
    return np.asarray(np.clip(box_px[:, 2:].astype(np.float64) - box_px[:, :2], 0.0, None).prod(axis=1))


def match_boxes(found: Boxes, truth: TrueBoxes, iou_min: float = MATCH_IOU) -> Matches:
    """Give each detection, best score first, the object of its class that it overlaps most and is still free.

    An overlap below `iou_min` is none. Objects that count go first; a detection that finds none of them but
    one that does not count is ignored (any number of them may find the same one).
    """
    overlap = iou(found.box_px, truth.box_px)
    overlap[found.label[:, None] != truth.label[None, :]] = 0.0
    truth_of = np.full(len(found), -1, dtype=np.int64)
    found_by = np.full(len(truth), -1, dtype=np.int64)
    ignored = np.zeros(len(found), dtype=np.bool_)
    for at in np.argsort(-found.score, kind="stable").tolist():
        own = np.where(overlap[at] >= iou_min, overlap[at], 0.0)
        free = np.where(truth.counts & (found_by < 0), own, 0.0)
        harmless = np.where(truth.counts, 0.0, own)
        if free.any():
            best = int(free.argmax())
            truth_of[at], found_by[best] = best, at
        elif harmless.any():
            best = int(harmless.argmax())
            truth_of[at], ignored[at] = best, True
            if found_by[best] < 0:
                found_by[best] = at
    return Matches(truth_of=truth_of, ignored=ignored, found_by=found_by)


def precision_recall(
    found: Sequence[Boxes], truth: Sequence[TrueBoxes], label: int, iou_min: float = MATCH_IOU
) -> PrecisionRecall:
    """Of one class, over images: `found[i]` and `truth[i]` are of the same one."""
    scores, rights = [], []
    objects = 0
    for detections, real in zip(found, truth, strict=True):
        matches = match_boxes(detections, real, iou_min)
        judged = (detections.label == label) & ~matches.ignored
        scores.append(detections.score[judged])
        rights.append(matches.truth_of[judged] >= 0)
        objects += int(((real.label == label) & real.counts).sum())
    score = np.concatenate([np.zeros(0), *scores]).astype(np.float64)
    order = np.argsort(-score, kind="stable")
    right = np.concatenate([np.zeros(0, dtype=np.bool_), *rights])[order]
    hits = np.cumsum(right)
    precision = hits / np.arange(1, len(hits) + 1)
    recall = hits / max(1, objects)
    return PrecisionRecall(
        score=score[order],
        precision=precision,
        recall=recall,
        objects=objects,
        average_precision=average_precision(precision, recall) if objects else float("nan"),
    )


def average_precision(precision: Float64, recall: Float64) -> float:
    """The area under precision over recall, precision at a recall being the best at that recall or more.

    Both [n], by falling score; nothing detected gives 0.
    """
    best = np.maximum.accumulate(precision[::-1])[::-1]
    return float((np.diff(recall, prepend=0.0) * best).sum())


def mean_average_precision(
    found: Sequence[Boxes], truth: Sequence[TrueBoxes], classes: int, iou_min: float = MATCH_IOU
) -> tuple[float, Float64]:
    """The mean over the classes of which objects count, and each class's own [classes] (NaN: none counts)."""
    each = np.array(
        [precision_recall(found, truth, label, iou_min).average_precision for label in range(classes)]
    )
    known = each[~np.isnan(each)]
    return (float(known.mean()) if len(known) else float("nan")), each


def share_found(values: Float64, found: Bool, edges: Float64) -> tuple[Float64, NDArray[np.int64]]:
    """Per bin of `values` [n] between `edges` [b + 1]: the share of `found` [n] (NaN: empty), and how many.

    What lies at an edge belongs to the bin above it; what lies outside the edges to none.
    """
    bins = len(edges) - 1
    at = np.searchsorted(edges, values, side="right") - 1
    inside = (at >= 0) & (at < bins)
    count = np.bincount(at[inside], minlength=bins)
    hits = np.bincount(at[inside], weights=found[inside].astype(np.float64), minlength=bins)
    share = np.full(bins, np.nan)
    np.divide(hits, count, out=share, where=count > 0)
    return share, count.astype(np.int64)


def first_is_right(likeness: Float64, right: int) -> bool:
    """Whether, among candidates [n], the right one alone is most alike: a tie is no recognition."""
    others = np.delete(likeness, right)
    return bool((likeness[right] > others).all())
