"""How well planners search: the thesis' metrics (METHODS 1) over episodes, with intervals."""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import groupby
from typing import Any

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.bootstrap import Interval, difference_interval, mean_intervals, ratio_interval
from robustnav_nodes.benchmarks.contestants import DEFAULT, Contestant
from robustnav_nodes.benchmarks.search_episode import Outcome
from robustnav_nodes.benchmarks.search_plan import PlayedEpisode, SceneJob
from robustnav_nodes.benchmarks.search_suite import DESTINATION_M, DETECTORS, DIFFICULTIES

# What the default is measured against: the greedy rule as the thesis would end its search, and with the
# default's own evidence and ending, which tells what the planning alone brings.
REFERENCES = ("greedy", "greedy_likelihood", "greedy_gain")


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchRow:
    """One planner in all episodes of one difficulty and detector.

    Shares of all episodes: sr, wrong_stop and the three errors; wrong_stop: a stop
    where the target is not in view. apl: mean steps of the successful episodes, None where there is none.
    The intervals hold 95 %.
    """

    planner: str
    difficulty: str
    detector: str
    episodes: int
    sr: float
    sr_ci: Interval
    apl: float | None
    spl: float
    spl_ci: Interval
    wrong_stop: float
    localisation_error: float
    docking_error: float
    other_error: float
    decision_ms_p50: float
    decision_ms_p95: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Gain:
    """What the default planner gains over another in the same episodes; intervals hold 95 %.

    spl_ratio: of the mean SPLs, None (also as a bound) where the other's is or may be 0.
    """

    over: str
    difficulty: str
    detector: str
    spl_ratio: float | None
    spl_ratio_ci: tuple[float | None, float | None]
    sr_difference: float
    sr_difference_ci: Interval


def search_rows(played: Sequence[PlayedEpisode], planners: Sequence[str]) -> list[SearchRow]:
    """A row for each difficulty, detector and planner, the planners in the given order."""
    return [
        row_of(
            planner,
            *cell,
            outcomes=[episode.result.outcome for episode in of_planner],
            spl=np.array([episode.result.spl for episode in of_planner]),
            steps=[episode.result.steps for episode in of_planner],
            wrong_stops=[episode.result.is_wrong_stop for episode in of_planner],
            decision_ms=[time for episode in of_planner for time in episode.result.decision_ms],
        )
        for cell, episodes in cells_of(played)
        for planner in planners
        for of_planner in [_of(planner, episodes)]
    ]


def row_of(
    planner: str,
    difficulty: str,
    detector: str,
    *,
    outcomes: Sequence[Outcome],
    spl: Float64,
    steps: Sequence[int],
    wrong_stops: Sequence[bool],
    decision_ms: Sequence[float],
) -> SearchRow:
    """Sum up episodes, at least one: outcome, SPL and steps of each, and the times of all decisions."""
    success = np.array([outcome is Outcome.SUCCESS for outcome in outcomes])
    share = {outcome: outcomes.count(outcome) / len(outcomes) for outcome in Outcome}
    sr_ci, spl_ci = mean_intervals(np.stack([success.astype(np.float64), spl], axis=1))
    p50, p95 = np.percentile(decision_ms or [0.0], [50, 95])
    return SearchRow(
        planner=planner,
        difficulty=difficulty,
        detector=detector,
        episodes=len(outcomes),
        sr=share[Outcome.SUCCESS],
        sr_ci=sr_ci,
        apl=float(np.array(steps)[success].mean()) if success.any() else None,
        spl=float(spl.mean()),
        spl_ci=spl_ci,
        wrong_stop=sum(wrong_stops) / len(wrong_stops),
        localisation_error=share[Outcome.LOCALISATION_ERROR],
        docking_error=share[Outcome.DOCKING_ERROR],
        other_error=share[Outcome.OTHER_ERROR],
        decision_ms_p50=float(p50),
        decision_ms_p95=float(p95),
    )


def gains(played: Sequence[PlayedEpisode]) -> list[Gain]:
    """For each difficulty, detector and reference; none where the default or the reference did not play."""
    return [
        _gain(over, cell, of_default, of_other)
        for cell, episodes in cells_of(played)
        for over in REFERENCES
        for of_default, of_other in [(_of(DEFAULT, episodes), _of(over, episodes))]
        if of_default and of_other
    ]


def _gain(
    over: str, cell: tuple[str, str], default: Sequence[PlayedEpisode], other: Sequence[PlayedEpisode]
) -> Gain:
    spl, other_spl = (np.array([episode.result.spl for episode in of]) for of in (default, other))
    sr, other_sr = (np.array([float(episode.result.is_success) for episode in of]) for of in (default, other))
    low, high = ratio_interval(spl, other_spl)
    return Gain(
        over=over,
        difficulty=cell[0],
        detector=cell[1],
        spl_ratio=float(spl.mean() / other_spl.mean()) if other_spl.any() else None,
        spl_ratio_ci=(_finite(low), _finite(high)),
        sr_difference=float(sr.mean() - other_sr.mean()),
        sr_difference_ci=difference_interval(sr, other_sr),
    )


def settings_of(jobs: Sequence[SceneJob], contestants: Sequence[Contestant]) -> dict[str, Any]:
    """All that decides the figures, for the report."""
    planner = contestants[0].planner
    return {
        "max_steps": planner.max_steps,
        "dock": planner.dock,
        "destination_m": DESTINATION_M,
        "success": "at a destination pose" if planner.dock else "stopped with the target in view",
        "simulations": planner.simulations,
        "scenes": [{"scene": job.source, "episodes": len(job.numbers)} for job in jobs],
        "planners": {contestant.name: contestant.settings() for contestant in contestants},
    }


def as_json(rows: Sequence[SearchRow | Gain]) -> list[dict[str, Any]]:
    """Rows as the report holds them."""
    return [asdict(row) for row in rows]


def cells_of(played: Sequence[PlayedEpisode]) -> list[tuple[tuple[str, str], list[PlayedEpisode]]]:
    """Episodes by (difficulty, detector), those of the suites in their order; in each in the plan's order.

    The order must not depend on which process was done first: what is resampled is the same each time.
    """

    def cell(episode: PlayedEpisode) -> tuple[int, str, int, str]:
        return (
            _place(episode.difficulty, tuple(DIFFICULTIES)),
            episode.difficulty,
            _place(episode.detector, DETECTORS),
            episode.detector,
        )

    ordered = sorted(played, key=lambda episode: (*cell(episode), episode.scene, episode.number))
    return [((key[1], key[3]), list(episodes)) for key, episodes in groupby(ordered, cell)]


def _place(name: str, known: Sequence[str]) -> int:
    return known.index(name) if name in known else len(known)


def _of(planner: str, episodes: Sequence[PlayedEpisode]) -> list[PlayedEpisode]:
    return [episode for episode in episodes if episode.planner == planner]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
