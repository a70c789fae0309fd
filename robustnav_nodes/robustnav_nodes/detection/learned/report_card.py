"""Judges weights on homes that were never trained on, and writes the figures down."""

import json
import math
import os
import time
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np
import torch

from robustnav_msgs_py.values import Float64
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.learned.detector import SCORE_MIN, LearnedDetector
from robustnav_nodes.detection.learned.judging import (
    ALIKE,
    ALIKE_RANGE_M,
    COUNTS_FRACTION,
    COUNTS_PX,
    DISTANCE_EDGES_M,
    Judgement,
    image_of,
    judge,
    look_alike_trials,
)
from robustnav_nodes.detection.learned.rendering import Kind, RenderPlan, render_pictures
from robustnav_nodes.detection.learned.training import TEST_SEED
from robustnav_nodes.detection.learned.training_pictures import PictureSet
from robustnav_nodes.detection.learned.weights import Weights

# So low that the whole curve of precision over recall is seen.
LOWEST_SCORE = 0.02
TIMED = 50
# Look-alikes are drawn with other seeds than the homes of the test.
LOOK_ALIKE_SEED = TEST_SEED + 100_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Figures:
    """All that is measured of weights."""

    labels: tuple[str, ...]
    pictures: int
    judgement: Judgement
    trials: int
    first_is_right: float
    first_is_right_with_depth: float
    one_core_ms: float


def judge_weights(weights: Weights, work: Path, homes: int, per_home: int) -> Figures:
    """Judge on `homes` homes of the test's seeds; pictures are rendered into `work` once."""
    cores = len(os.sched_getaffinity(0))
    detector = LearnedDetector(weights, score_min=LOWEST_SCORE)
    plan = RenderPlan(kind=Kind.TEST, first_seed=TEST_SEED, homes=homes, per_home=per_home)
    pictures = render_pictures(plan, work / "test", cores)
    judgement = judge(_found(detector, pictures), pictures, SCORE_MIN)
    plan = RenderPlan(kind=Kind.LOOK_ALIKES, first_seed=LOOK_ALIKE_SEED, homes=homes, per_home=2 * per_home)
    alike = render_pictures(plan, work / "look_alikes", cores)
    by_look, by_both, trials = look_alike_trials(
        detector,
        _found(detector, alike),
        alike,
        np.random.default_rng(TEST_SEED),
    )
    return Figures(
        labels=weights.labels,
        pictures=len(pictures),
        judgement=judgement,
        trials=trials,
        first_is_right=by_look,
        first_is_right_with_depth=by_both,
        one_core_ms=_one_core_ms(weights, pictures),
    )


def save_figures(path: Path, figures: Figures) -> None:
    """Write PATH.json, PATH.md (tables) and PATH.png (recall over distance)."""
    from matplotlib.figure import Figure

    path.with_suffix(".json").write_text(json.dumps(_as_data(figures), indent=1) + "\n", encoding="utf-8")
    path.with_suffix(".md").write_text(tables(figures), encoding="utf-8")
    figure = Figure(figsize=(6.0, 3.5), layout="constrained")
    axes = figure.subplots()
    middles_m = (DISTANCE_EDGES_M[:-1] + DISTANCE_EDGES_M[1:]) / 2.0
    axes.plot(middles_m, figures.judgement.recall, marker="o")
    axes.set(xlabel="distance in m", ylabel=f"recall at a score of {SCORE_MIN:g}", ylim=(0.0, 1.0))
    axes.grid(alpha=0.3)
    figure.savefig(path.with_suffix(".png"), dpi=120)


def tables(figures: Figures) -> str:
    """The figures as Markdown."""
    judged = figures.judgement
    lines = [
        "| | |",
        "|---|---|",
        (
            f"| mAP at an IoU of 0.5, objects of >= {COUNTS_PX} px and >= {COUNTS_FRACTION:.0%} visible "
            f"| {judged.mean_ap:.3f} |"
        ),
        (
            f"| their precision and recall at a score of {judged.score_min:g} "
            f"| {judged.precision:.2f}, {judged.recall_at_score:.2f} |"
        ),
        (
            f"| the right one first among {ALIKE} look-alikes within {ALIKE_RANGE_M:g} m, by look alone "
            f"| {figures.first_is_right:.2f} of {figures.trials} |"
        ),
        f"| the same, with depth known | {figures.first_is_right_with_depth:.2f} |",
        f"| median time of an image of 320 x 240 on one core | {figures.one_core_ms:.0f} ms |",
        "",
        f"| distance in m | recall at a score of {judged.score_min:g} | objects |",
        "|---|---|---|",
    ]
    for low, high, share, count in zip(
        DISTANCE_EDGES_M[:-1], DISTANCE_EDGES_M[1:], judged.recall, judged.recall_objects, strict=True
    ):
        lines.append(f"| {low:g} to {high:g} | {share:.2f} | {count} |")
    lines += ["", "| class | AP at an IoU of 0.5 | objects |", "|---|---|---|"]
    for label, ap, count in zip(figures.labels, judged.ap, judged.objects, strict=True):
        lines.append(f"| {label} | {ap:.2f} | {count} |")
    return "\n".join(lines) + "\n"


def _as_data(figures: Figures) -> dict[str, object]:
    judged = figures.judgement
    return {
        "pictures": figures.pictures,
        "mean_ap": judged.mean_ap,
        "average_precision": dict(zip(figures.labels, _numbers(judged.ap), strict=True)),
        "objects": dict(zip(figures.labels, judged.objects.tolist(), strict=True)),
        "score_min": judged.score_min,
        "precision": judged.precision,
        "recall": judged.recall_at_score,
        "distance_edges_m": DISTANCE_EDGES_M.tolist(),
        "recall_over_distance": _numbers(judged.recall),
        "objects_over_distance": judged.recall_objects.tolist(),
        "look_alike_trials": figures.trials,
        "first_is_right": figures.first_is_right,
        "first_is_right_with_depth": figures.first_is_right_with_depth,
        "one_core_ms": figures.one_core_ms,
    }


def _numbers(values: Float64) -> list[float | None]:
    """JSON has no NaN."""
    return [None if math.isnan(value) else value for value in values.tolist()]


def _found(detector: LearnedDetector, pictures: PictureSet) -> list[Boxes]:
    return [detector.detect(image_of(pictures, number)) for number in range(len(pictures))]


def _one_core_ms(weights: Weights, pictures: PictureSet) -> float:
    """The median time of an image, as the node would use it, on one core."""
    detector = LearnedDetector(weights)
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    taken_s = []
    for number in range(min(TIMED, len(pictures))):
        image = image_of(pictures, number)
        began_s = time.perf_counter()
        detector.detect(image)
        taken_s.append(time.perf_counter() - began_s)
    torch.set_num_threads(threads)
    return median(taken_s) * 1e3
