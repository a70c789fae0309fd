"""Collects what a detector said beside what was there, over many images, and tells how good it is."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Bool, Float32, Float64
from robustnav_nodes.benchmarks.detection_scores import (
    NONE,
    Int64,
    ScoreBin,
    average_precision,
    match_boxes,
    reliability,
)
from robustnav_nodes.detection.boxes import Boxes

RANGE_EDGES_M = tuple(0.5 * edge for edge in range(13))
VISIBLE_EDGES = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
ALL = "all"
MISSED = -1.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class TrueObjects:
    """What one image really shows, n objects.

    box_px: float32 [n, 4]; label: uint32 [n], in the detector's list of names; distance_m: float64 [n], on
    the floor from the robot; visible: [n] in 0..1, the part that nothing hides; pixels: [n] that show it.
    """

    box_px: Float32
    label: NDArray[np.uint32]
    distance_m: Float64
    visible: Float64
    pixels: Float64


@dataclass(frozen=True, slots=True, kw_only=True)
class Floors:
    """Which objects count: smaller or more hidden ones are no miss, and no false alarm when found."""

    pixels_min: float = 150.0
    visible_min: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class ClassScore:
    """One class, or ALL (map50: the mean over the classes); None where there is nothing to tell it from."""

    label: str
    objects: int
    detections: int
    map50: float | None
    precision: float | None
    recall: float | None
    f1: float | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Share:
    """Recall of the objects whose distance or visible part lies in low .. high."""

    low: float
    high: float
    objects: int
    recall: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Found:
    """All detections: label; score; is_true, of an object that counts; is_void, of one that does not."""

    label: NDArray[np.uint32]
    score: Float64
    is_true: Bool
    is_void: Bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class There:
    """All objects: as TrueObjects, whether they count, and the score they were found with, or MISSED."""

    label: NDArray[np.uint32]
    distance_m: Float64
    visible: Float64
    counts: Bool
    score: Float64


class Tally:
    """Of one detector, whose classes are `labels`. Precision and recall are of scores from `score_min` up."""

    def __init__(self, labels: Sequence[str], score_min: float, floors: Floors | None = None) -> None:
        self.labels = tuple(labels)
        self.score_min = score_min
        self._floors = floors or Floors()
        self._found: list[Found] = []
        self._there: list[There] = []

    @property
    def images(self) -> int:
        """How many were added."""
        return len(self._found)

    def add(self, truth: TrueObjects, boxes: Boxes) -> Int64:
        """One image; returns which of the true objects each box stands for, NONE for none (IoU 0.5)."""
        floors = self._floors
        counts = (truth.pixels >= floors.pixels_min) & (truth.visible >= floors.visible_min)
        chosen = np.full(len(boxes), NONE, dtype=np.int64)
        for label in np.unique(boxes.label):
            found, there = np.flatnonzero(boxes.label == label), np.flatnonzero(truth.label == label)
            matched = match_boxes(boxes.box_px[found], boxes.score[found], truth.box_px[there], counts[there])
            right = matched != NONE
            chosen[found[right]] = there[matched[right]]
        hit = chosen != NONE
        score = np.full(len(truth.label), MISSED)
        score[chosen[hit]] = boxes.score[hit]
        is_true = hit.copy()
        is_true[hit] = counts[chosen[hit]]
        self._found.append(
            Found(
                label=boxes.label,
                score=boxes.score.astype(np.float64),
                is_true=is_true,
                is_void=hit & ~is_true,
            )
        )
        self._there.append(
            There(
                label=truth.label,
                distance_m=np.asarray(truth.distance_m, dtype=np.float64),
                visible=np.asarray(truth.visible, dtype=np.float64),
                counts=counts,
                score=score,
            )
        )
        return chosen

    def found(self) -> Found:
        """Every detection so far."""
        return Found(
            label=_joined([row.label for row in self._found], np.uint32),
            score=_joined([row.score for row in self._found], np.float64),
            is_true=_joined([row.is_true for row in self._found], np.bool_),
            is_void=_joined([row.is_void for row in self._found], np.bool_),
        )

    def there(self) -> There:
        """Every object so far."""
        return There(
            label=_joined([row.label for row in self._there], np.uint32),
            distance_m=_joined([row.distance_m for row in self._there], np.float64),
            visible=_joined([row.visible for row in self._there], np.float64),
            counts=_joined([row.counts for row in self._there], np.bool_),
            score=_joined([row.score for row in self._there], np.float64),
        )

    def class_scores(self) -> list[ClassScore]:
        """ALL first, then each class that was there or was imagined."""
        found, there = self.found(), self.there()
        rows = []
        for number, label in enumerate(self.labels):
            said, real = found.label == number, there.label == number
            if (real & there.counts).any() or (said & ~found.is_void).any():
                rows.append(self._class_score(label, found, said, there, real))
        means = [row.map50 for row in rows if row.map50 is not None]
        total = self._class_score(ALL, found, np.ones_like(found.is_true), there, np.ones_like(there.counts))
        overall = ClassScore(
            label=ALL,
            objects=total.objects,
            detections=total.detections,
            map50=float(np.mean(means)) if means else None,
            precision=total.precision,
            recall=total.recall,
            f1=total.f1,
        )
        return [overall, *rows]

    def _class_score(self, label: str, found: Found, said: Bool, there: There, real: Bool) -> ClassScore:
        said, real = said & ~found.is_void, real & there.counts
        objects = int(real.sum())
        firm = said & (found.score >= self.score_min)
        precision = float(found.is_true[firm].mean()) if firm.any() else None
        recall = float((there.score[real] >= self.score_min).mean()) if objects else None
        return ClassScore(
            label=label,
            objects=objects,
            detections=int(firm.sum()),
            map50=average_precision(found.score[said], found.is_true[said], objects) if objects else None,
            precision=precision,
            recall=recall,
            f1=_harmonic_mean(precision, recall),
        )

    def recall_by_range(self, edges_m: Sequence[float] = RANGE_EDGES_M) -> list[Share]:
        """Of the objects that count, nearest first; empty bins are left out."""
        there = self.there()
        return self._shares(there.distance_m, there, edges_m)

    def recall_by_visible_part(self) -> list[Share]:
        """Of all objects, also those that do not count, the most hidden first; empty bins are left out."""
        there = self.there()
        return self._shares(there.visible, there, VISIBLE_EDGES, hidden_too=True)

    def _shares(
        self, value: Float64, there: There, edges: Sequence[float], *, hidden_too: bool = False
    ) -> list[Share]:
        rows = []
        for low, high in pairwise(edges):
            last = high == edges[-1]
            inside = (value >= low) & ((value <= high) if last else (value < high))
            inside &= hidden_too | there.counts
            if inside.any():
                recall = float((there.score[inside] >= self.score_min).mean())
                rows.append(Share(low=low, high=high, objects=int(inside.sum()), recall=recall))
        return rows

    def score_bins(self) -> list[ScoreBin]:
        """Scores against precision, of all detections but those of objects that do not count."""
        found = self.found()
        said = ~found.is_void
        return reliability(found.score[said], found.is_true[said])


def _harmonic_mean(precision: float | None, recall: float | None) -> float | None:
    if precision is None or recall is None:
        return None
    total = precision + recall
    return 2.0 * precision * recall / total if total > 0.0 else 0.0


def _joined(parts: Sequence[NDArray[Any]], kind: type[np.generic]) -> NDArray[Any]:
    return np.concatenate([np.zeros(0, dtype=kind), *parts]).astype(kind, copy=False)
