"""How right detections are: matching, average precision, calibration. Pure numpy."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Bool, Float32, Float64

NONE = -1
Int64 = NDArray[np.int64]


def overlaps(boxes_px: Float32, others_px: Float32) -> Float64:
    """Intersection over union: float64 [n, m] for boxes [n, 4] and [m, 4] as u_min, v_min, u_max, v_max."""
    a, b = (np.asarray(boxes, dtype=np.float64).reshape(-1, 4) for boxes in (boxes_px, others_px))
    low = np.maximum(a[:, None, :2], b[None, :, :2])
    high = np.minimum(a[:, None, 2:], b[None, :, 2:])
    shared = np.prod(np.maximum(high - low, 0.0), axis=2)
    area_a, area_b = (np.prod(np.maximum(boxes[:, 2:] - boxes[:, :2], 0.0), axis=1) for boxes in (a, b))
    union = area_a[:, None] + area_b[None, :] - shared
    found: Float64 = np.divide(shared, union, out=np.zeros_like(shared), where=union > 0.0)
    return found


def match_boxes(
    found_px: Float32, score: Float32, true_px: Float32, counts: Bool, iou_min: float = 0.5
) -> Int64:
    """Which true box each found box stands for: int64 [n], NONE for none; all boxes are of one class.

    The best score chooses first; each true box is taken once, by a found box that overlaps it by `iou_min`
    at least. True boxes that count (bool [m]) go before those that do not, nearer overlaps before others.
    """
    overlap = overlaps(found_px, true_px)
    chosen = np.full(len(found_px), NONE, dtype=np.int64)
    free = np.ones(len(true_px), dtype=np.bool_)
    for found in np.argsort(-np.asarray(score), kind="stable"):
        fits = free & (overlap[found] >= iou_min)
        if fits.any():
            best = int(np.argmax(np.where(fits, overlap[found] + 2.0 * counts, -1.0)))
            chosen[found], free[best] = best, False
    return chosen


def average_precision(score: Float64, is_true: Bool, objects: int) -> float:
    """Area under precision over recall, precision made to fall only (all points); NaN without objects.

    score: float64 [n], is_true: bool [n] of all detections of a class; objects: how many there were to find.
    """
    if objects == 0:
        return float("nan")
    order = np.argsort(-np.asarray(score), kind="stable")
    true = np.cumsum(np.asarray(is_true, dtype=np.float64)[order])
    precision = true / np.arange(1, len(true) + 1)
    envelope = np.maximum.accumulate(precision[::-1])[::-1]
    gained = np.diff(true / objects, prepend=0.0)
    return float((gained * envelope).sum())


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreBin:
    """Detections whose scores lie in low .. high: how many, their mean score, and how many were right."""

    low: float
    high: float
    detections: int
    mean_score: float
    precision: float


def reliability(score: Float64, is_true: Bool, bins: int = 10) -> list[ScoreBin]:
    """Scores against what they turned out to be worth; empty bins are left out."""
    place = np.clip((np.asarray(score, dtype=np.float64) * bins).astype(np.int64), 0, bins - 1)
    rows = []
    for number in range(bins):
        inside = place == number
        if inside.any():
            rows.append(
                ScoreBin(
                    low=number / bins,
                    high=(number + 1) / bins,
                    detections=int(inside.sum()),
                    mean_score=float(np.mean(score[inside])),
                    precision=float(np.mean(is_true[inside])),
                )
            )
    return rows


def calibration_error(rows: Sequence[ScoreBin]) -> float:
    """Expected calibration error: mean of |precision - mean score|, weighted by detections; NaN for none."""
    total = sum(row.detections for row in rows)
    if total == 0:
        return float("nan")
    return sum(row.detections * abs(row.precision - row.mean_score) for row in rows) / total
