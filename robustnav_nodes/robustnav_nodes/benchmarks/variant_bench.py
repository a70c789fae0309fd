"""What the variants beyond the thesis are worth, in figures with intervals."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.bootstrap import Interval, difference_interval, mean_intervals
from robustnav_nodes.benchmarks.search_plan import EPISODES_IN_SCENE, SCENES_OF_SEED
from robustnav_nodes.benchmarks.search_suite import make_scene
from robustnav_nodes.benchmarks.variant_parts import PARTS, Episode, Score

DIFFICULTY = "medium"


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """A mean over episodes, and what it gains over the part's first variant in the same episodes.

    The intervals hold 95 %.
    """

    mean: float
    ci: Interval
    gain: float
    gain_ci: Interval


@dataclass(frozen=True, slots=True, kw_only=True)
class VariantRow:
    """One variant of a part. sr, spl, steps: over all episodes, also where the search failed; spl: None where
    no way is the shortest.
    """

    part: str
    variant: str
    episodes: int
    sr: Figure
    spl: Figure | None
    steps: Figure


def variant_rows(
    *, episodes: int, seed: int, progress: Callable[[], None] = lambda: None
) -> list[VariantRow]:
    """A row for each variant of each part; `progress` is called after every episode."""
    scores: dict[str, dict[str, list[Score]]] = {part: {} for part in PARTS}
    for number in range(episodes):
        if number % EPISODES_IN_SCENE == 0:
            of_seed = number // EPISODES_IN_SCENE % SCENES_OF_SEED
            scene = make_scene(DIFFICULTY, seed * SCENES_OF_SEED + of_seed)
        episode = Episode.drawn(scene, seed, number)
        for part, play in PARTS.items():
            for variant, score in play(episode).items():
                scores[part].setdefault(variant, []).append(score)
        progress()
    return [
        _row(part, variant, np.array(of_variant), np.array(next(iter(by_variant.values()))))
        for part, by_variant in scores.items()
        for variant, of_variant in by_variant.items()
    ]


def _row(part: str, variant: str, scores: Float64, first: Float64) -> VariantRow:
    """scores, first: float64 [episodes, 3], this variant's and the first one's."""
    sr, spl, steps = (_figure(values, others) for values, others in zip(scores.T, first.T, strict=True))
    return VariantRow(
        part=part,
        variant=variant,
        episodes=len(scores),
        sr=sr,
        spl=None if math.isnan(spl.mean) else spl,
        steps=steps,
    )


def _figure(values: Float64, others: Float64) -> Figure:
    return Figure(
        mean=float(values.mean()),
        ci=mean_intervals(values[:, np.newaxis])[0],
        gain=float(values.mean() - others.mean()),
        gain_ci=difference_interval(values, others),
    )
