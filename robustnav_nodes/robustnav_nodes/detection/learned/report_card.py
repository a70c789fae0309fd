"""Judges weights on homes that were never trained on, and writes the figures down: JSON, picture, table."""

import json
import math
import os
import time
from collections.abc import Callable
from pathlib import Path
from statistics import median

import numpy as np
import torch

from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.learned.detector import SCORE_MIN, LearnedDetector
from robustnav_nodes.detection.learned.judging import (
    ALIKE,
    ALIKE_RANGE_M,
    DISTANCE_EDGES_M,
    Judgement,
    image_of,
    judge,
    look_alike_trials,
)
from robustnav_nodes.detection.learned.rendering import VIEW_RAD, WIDTH, Kind, RenderPlan, render_pictures
from robustnav_nodes.detection.learned.training import TEST_SEED
from robustnav_nodes.detection.learned.training_pictures import PictureSet
from robustnav_nodes.detection.learned.weights import Weights

# So low that the whole curve of precision over recall is seen.
LOWEST_SCORE = 0.02
TIMED = 50
# Look-alikes are drawn with other seeds than the homes of the test.
LOOK_ALIKE_SEED = TEST_SEED + 100_000


def judge_weights(
    weights: Weights, work: Path, homes: int, per_home: int, say: Callable[[str], None]
) -> dict[str, object]:
    """All figures, as they are written to JSON; pictures are rendered into `work` once."""
    cores = len(os.sched_getaffinity(0))
    detector = LearnedDetector(weights, score_min=LOWEST_SCORE)
    plan = RenderPlan(kind=Kind.TEST, first_seed=TEST_SEED, homes=homes, per_home=per_home)
    pictures = render_pictures(plan, work / "test", cores)
    say(f"{len(pictures)} pictures of {homes} homes from seed {TEST_SEED} on")
    judgement = judge(_found(detector, pictures), pictures, SCORE_MIN)
    plan = RenderPlan(kind=Kind.LOOK_ALIKES, first_seed=LOOK_ALIKE_SEED, homes=homes, per_home=2 * per_home)
    alike = render_pictures(plan, work / "look_alikes", cores)
    focal_px = WIDTH / 2.0 / math.tan(VIEW_RAD / 2.0)
    by_look, by_both, trials = look_alike_trials(
        detector, _found(detector, alike), alike, focal_px, np.random.default_rng(TEST_SEED)
    )
    return {
        "mean_ap": judgement.mean_ap,
        "average_precision": _by_class(weights, judgement),
        "score_min": judgement.score_min,
        "precision": judgement.precision,
        "recall": judgement.recall_at_score,
        "recall_over_distance_m": [
            {"from": low, "to": high, "recall": share, "objects": int(count)}
            for low, high, share, count in zip(
                DISTANCE_EDGES_M[:-1].tolist(),
                DISTANCE_EDGES_M[1:].tolist(),
                judgement.recall.tolist(),
                judgement.recall_objects.tolist(),
                strict=True,
            )
        ],
        "look_alikes": {
            "of": ALIKE,
            "range_m": ALIKE_RANGE_M,
            "trials": trials,
            "first_is_right": by_look,
            "first_is_right_with_height": by_both,
        },
        "ms_per_image_on_one_core": _one_core_ms(weights, pictures),
    }


def save_figures(path: Path, figures: dict[str, object]) -> None:
    """Write PATH.json, and PATH.png: recall over distance."""
    from matplotlib.figure import Figure

    path.with_suffix(".json").write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")
    bins = figures["recall_over_distance_m"]
    if not isinstance(bins, list):
        raise AssertionError("judge_weights makes it a list")
    figure = Figure(figsize=(6.0, 3.5), layout="constrained")
    axes = figure.subplots()
    axes.plot([(row["from"] + row["to"]) / 2.0 for row in bins], [row["recall"] for row in bins], marker="o")
    axes.set(xlabel="distance in m", ylabel=f"recall at a score of {figures['score_min']}", ylim=(0.0, 1.0))
    axes.grid(alpha=0.3)
    figure.savefig(path.with_suffix(".png"), dpi=120)


def _found(detector: LearnedDetector, pictures: PictureSet) -> list[Boxes]:
    return [detector.detect(image_of(pictures, number)) for number in range(len(pictures))]


def _by_class(weights: Weights, judgement: Judgement) -> dict[str, dict[str, float | int | None]]:
    return {
        label: {"ap": None if math.isnan(ap) else ap, "objects": int(objects)}
        for label, ap, objects in zip(
            weights.labels, judgement.ap.tolist(), judgement.objects.tolist(), strict=True
        )
    }


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
