"""How well models find wrong instructions: AUC, ATD, reliability, time, each beside its baselines."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import DIRECTION, pair_of
from robustnav_nodes.instruction.episodes import ErrorEpisode
from robustnav_nodes.instruction.metrics import (
    Int64,
    Interval,
    atd,
    auc,
    auc_of_draws,
    drawn_groups,
    expected_calibration_error,
    interval_of,
    mean_of_draws,
    reliability,
    temperature,
    token_distance,
    with_temperature,
)
from robustnav_nodes.instruction.trajectory import Trajectory
from robustnav_nodes.instruction.verdict import ErrorModel

MEAN = "mean"  # the row of all types of errors: the mean of their figures


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Judged:
    """What one model said of the episodes of one type of error.

    `scores` and `labels` float64 [n]; `homes` and `pairs` name each episode's home and, for one wrong
    direction, its pair of opposites; `distances` float64 [n], NaN where the episode is clean.
    """

    model: str
    protocol: str
    error_type: str
    scores: Float64
    labels: Float64
    distances: Float64
    homes: tuple[str, ...]
    pairs: tuple[str, ...]
    seconds: float  # that all verdicts took


@dataclass(frozen=True, slots=True, kw_only=True)
class InstructionRow:
    """A row of the table: one model, one protocol, one type of error (or the mean of all)."""

    model: str
    protocol: str
    error_type: str
    episodes: int
    auc: float | None
    auc_ci: Interval | None
    atd: float | None
    atd_ci: Interval | None
    calibration_error: float | None
    seconds_per_1000: float  # episodes


def judge_episodes(
    name: str,
    model: ErrorModel,
    protocol: str,
    error_type: str,
    episodes: Sequence[ErrorEpisode],
    advance: Callable[[], None] = lambda: None,
) -> Judged:
    """Ask a model about each episode. A wrong instruction's pair comes after its clean twin or before it."""
    scores, distances = [], []
    seconds = 0.0
    for episode in episodes:
        began = time.perf_counter()
        verdict = model.judge(episode.trajectory, episode.tokens)
        seconds += time.perf_counter() - began
        scores.append(verdict.error_score)
        true = [span.start for span in episode.wrong]
        distances.append(
            token_distance(true, verdict.places(len(true), len(episode.tokens))) if true else np.nan
        )
        advance()
    return Judged(
        model=name,
        protocol=protocol,
        error_type=error_type,
        scores=np.array(scores, dtype=np.float64),
        labels=np.array([episode.label for episode in episodes], dtype=np.float64),
        distances=np.array(distances, dtype=np.float64),
        homes=tuple(episode.group for episode in episodes),
        pairs=_pairs_of(episodes),
        seconds=seconds,
    )


def row_of(judged: Judged) -> InstructionRow:
    """The figures, with 95 % intervals over homes."""
    known = len(judged.scores) > 0
    aucs, atds = _figures_of_draws([judged])
    return InstructionRow(
        model=judged.model,
        protocol=judged.protocol,
        error_type=judged.error_type,
        episodes=len(judged.scores),
        auc=auc(judged.scores, judged.labels),
        auc_ci=interval_of(aucs),
        atd=atd(judged.distances[~np.isnan(judged.distances)].tolist()),
        atd_ci=interval_of(atds),
        calibration_error=expected_calibration_error(judged.scores, judged.labels) if known else None,
        seconds_per_1000=1000.0 * judged.seconds / max(1, len(judged.scores)),
    )


def mean_row(rows: Sequence[InstructionRow], judged: Sequence[Judged]) -> InstructionRow:
    """The mean over types of errors, as the thesis' tables have it; one model and one protocol.

    For its intervals homes are drawn once for all types: their episodes speak of the same walks.
    """
    aucs, atds = _figures_of_draws(judged)
    episodes = sum(row.episodes for row in rows)
    return InstructionRow(
        model=rows[0].model,
        protocol=rows[0].protocol,
        error_type=MEAN,
        episodes=episodes,
        auc=_mean([row.auc for row in rows]),
        auc_ci=interval_of(aucs),
        atd=_mean([row.atd for row in rows]),
        atd_ci=interval_of(atds),
        calibration_error=_mean([row.calibration_error for row in rows]),
        seconds_per_1000=1000.0 * sum(one.seconds for one in judged) / max(1, episodes),
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PairRow:
    """How well one pair of opposites is told apart, among episodes with a wrong direction."""

    model: str
    protocol: str
    pair: str
    episodes: int
    auc: float | None


def pair_rows(judged: Judged) -> list[PairRow]:
    """By pair of opposites; the clean twins of its episodes stand against them."""
    names = np.array(judged.pairs)
    return [
        PairRow(
            model=judged.model,
            protocol=judged.protocol,
            pair=pair,
            episodes=int((names == pair).sum()),
            auc=auc(judged.scores[names == pair], judged.labels[names == pair]),
        )
        for pair in sorted(set(judged.pairs) - {""})
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class Calibration:
    """Whether a score of 0.7 is wrong 7 times in 10: as it is, and after temperature scaling.

    The temperature is found on every second home and tried on the others, where both errors are measured.
    `curve` holds (mean score, share of wrong ones, count) as it is.
    """

    model: str
    protocol: str
    temperature: float
    error: float
    error_scaled: float
    curve: tuple[tuple[float, float, int], ...]


def calibration_of(judged: Sequence[Judged]) -> Calibration:
    """Over all types of errors of one model and one protocol."""
    scores = np.concatenate([one.scores for one in judged])
    labels = np.concatenate([one.labels for one in judged])
    homes = [home for one in judged for home in one.homes]
    known = sorted(set(homes))
    held = set(known[::2]) if len(known) > 1 else set()
    apart = np.array([home in held for home in homes], dtype=np.bool_)
    t = temperature(scores[apart], labels[apart])
    scaled = with_temperature(scores[~apart], t)
    return Calibration(
        model=judged[0].model,
        protocol=judged[0].protocol,
        temperature=t,
        error=expected_calibration_error(scores[~apart], labels[~apart]),
        error_scaled=expected_calibration_error(scaled, labels[~apart]),
        curve=tuple(reliability(scores, labels)),
    )


def chosen_pairs(episodes: Sequence[ErrorEpisode], at_most: int | None, seed: int) -> list[ErrorEpisode]:
    """`at_most` episodes in clean and perturbed pairs, drawn by the seed; all where there are fewer."""
    if at_most is None or len(episodes) <= at_most:
        return list(episodes)
    by_key: dict[str, list[ErrorEpisode]] = {}
    for episode in episodes:
        by_key.setdefault(episode.key.rsplit("_", 1)[0], []).append(episode)
    keys = sorted(by_key)
    found: list[ErrorEpisode] = []
    for k in np.random.default_rng(seed).permutation(len(keys)):
        if len(found) + len(by_key[keys[k]]) > at_most:
            break
        found += by_key[keys[k]]
    return found


def _pairs_of(episodes: Sequence[ErrorEpisode]) -> tuple[str, ...]:
    by_key: dict[str, str] = {}
    for episode in episodes:
        if len(episode.wrong) == 1 and episode.wrong[0].kind == DIRECTION:
            by_key[episode.key.rsplit("_", 1)[0]] = pair_of(episode.wrong[0].wrong)
    return tuple(by_key.get(episode.key.rsplit("_", 1)[0], "") for episode in episodes)


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def _figures_of_draws(judged: Sequence[Judged]) -> tuple[Float64, Float64]:
    """AUC and ATD, float64 [draws] each, of homes drawn again: means over types; NaN where none has any."""
    homes = sorted({home for one in judged for home in one.homes})
    if len(homes) < 2:
        return np.full(1, np.nan), np.full(1, np.nan)
    number = {home: k for k, home in enumerate(homes)}
    draws = drawn_groups(len(homes))
    aucs, atds = [], []
    for one in judged:
        group: Int64 = np.array([number[home] for home in one.homes], dtype=np.int64)
        aucs.append(auc_of_draws(one.scores, one.labels, group, draws))
        atds.append(mean_of_draws(one.distances, group, draws))
    return _mean_of_known(np.stack(aucs)), _mean_of_known(np.stack(atds))


def _mean_of_known(figures: Float64) -> Float64:
    """float64 [types, draws] to [draws]."""
    known = ~np.isnan(figures)
    found = np.full(figures.shape[1], np.nan)
    np.divide(
        np.where(known, figures, 0.0).sum(axis=0), known.sum(axis=0), out=found, where=known.any(axis=0)
    )
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class StepTime:
    """What a robot waits for: from one more viewpoint of a walk to the score and the doubted words."""

    model: str
    protocol: str
    steps: int
    median_ms: float
    p95_ms: float


def online_step_time(
    name: str, model: ErrorModel, protocol: str, episodes: Sequence[ErrorEpisode]
) -> StepTime | None:
    """Walk each episode viewpoint by viewpoint, judging at each; None where there is no viewpoint."""
    times = []
    for episode in episodes:
        viewpoints = episode.trajectory.viewpoints
        for count in range(1, len(viewpoints) + 1):
            began = time.perf_counter()
            model.judge(Trajectory(viewpoints=viewpoints[:count]), episode.tokens)
            times.append((time.perf_counter() - began) * 1e3)
    if not times:
        return None
    median, p95 = np.percentile(times, (50.0, 95.0))
    return StepTime(
        model=name, protocol=protocol, steps=len(times), median_ms=float(median), p95_ms=float(p95)
    )


# The thesis' table 4.2 (R2RIE-CE, another simulator, its own visual features): AUC and ATD by type of error.
THESIS: Mapping[str, Mapping[str, tuple[float, float]]] = {
    "thesis: random": {MEAN: (0.50, 11.26)},
    "thesis: CLIP grounding": {MEAN: (0.59, 9.22)},
    "thesis: IEDL": {
        "direction": (0.58, 8.13),
        "room": (0.80, 7.73),
        "object": (0.74, 9.21),
        "room_object": (0.91, 7.34),
        "all": (0.94, 6.14),
        MEAN: (0.79, 7.71),
    },
}
