"""Searches in simulated homes with a detector that looks at pixels: which, and what came of them."""

import json
import shutil
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from robustnav_msgs_py.detector_statistics import ClassStatistics, DetectorStatistics
from robustnav_msgs_py.values import Float64
from robustnav_nodes.belief.learnt_statistics import LearntStatistics, read_observed
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.benchmarks.bootstrap import Interval, difference_interval, mean_intervals
from robustnav_nodes.benchmarks.contestants import ALL, DEFAULT
from robustnav_nodes.benchmarks.graph_bench import GraphEpisode, measured
from robustnav_nodes.benchmarks.home_search import HomeSearch, run_home_search
from robustnav_nodes.benchmarks.search_episode import Outcome

PLANNERS = ("pomp", "pomp_be_pd", DEFAULT)
DEGRADED_PLANNERS = ("pomp", DEFAULT)
CAMERAS = ("none", "blur", "dark", "noise", "half resolution")
DIFFICULTIES = ("easy", "medium")
# What is learnt is learnt by class: these are in every home.
LEARNT_LABELS = ("mug", "book")
WRONG_BY = 0.5
RIGHT, WRONG, LEARNING = "right", "wrong by half", "wrong by half, learning"


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm:
    """What is compared: a planner, a camera's degradation, and how good the detector is taken to be."""

    planner: str
    camera: str = "none"
    statistics: str = RIGHT

    @property
    def name(self) -> str:
        """As a file's name."""
        return "_".join(f"{self.planner} {self.camera} {self.statistics}".replace(",", "").split())


SUITES: dict[str, tuple[Arm, ...]] = {
    "planners": tuple(Arm(planner=planner) for planner in PLANNERS),
    "degradations": tuple(
        Arm(planner=planner, camera=camera) for camera in CAMERAS for planner in DEGRADED_PLANNERS
    ),
    "statistics": tuple(Arm(planner=DEFAULT, statistics=name) for name in (RIGHT, WRONG, LEARNING)),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeEpisode:
    """One search of an arm; believed: what was held of the detector on the target's class after it."""

    arm: Arm
    number: int
    graph: GraphEpisode
    believed: ClassStatistics


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeRow:
    """One arm over its searches; intervals hold 95 %.

    wrong_stop: part of the searches that ended in a find where the target is not in view and near;
    false_alarms: mean number of poses in a search at which the target was detected where it is not, without
    the search ending there; steps: mean, of searches that succeeded. sr_gain: over the first arm of the same
    camera in the same searches.
    """

    planner: str
    camera: str
    statistics: str
    episodes: int
    sr: float
    sr_ci: Interval
    spl: float
    spl_ci: Interval
    wrong_stop: float
    wrong_stop_ci: Interval
    not_found: float
    false_alarms: float
    false_alarms_ci: Interval
    steps: float | None
    sr_gain: float
    sr_gain_ci: Interval


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeBench:
    """A suite in `episodes` homes, seeds from `seed` on; everything is kept in `folder`.

    What is in the folder already is not searched again: a bench that was stopped goes on. statistics: how
    good the detector really is, as far as it was measured. detection: parameters of the detection node.
    """

    suite: str
    seed: int
    episodes: int
    max_steps: int
    folder: Path
    statistics: DetectorStatistics
    detection: dict[str, Any]

    def play(self, progress: Callable[[HomeEpisode], None]) -> list[HomeEpisode]:
        """All searches of all arms; arms take turns, so that a bench that is stopped has as many of each.

        Raises what `run_home_search` raises.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        files = {}
        for name, factor in ((RIGHT, 1.0), (WRONG, WRONG_BY)):
            files[name] = self.folder / f"{name.replace(' ', '_')}.json"
            files[name].write_text(json.dumps(_content(self.statistics, factor)), encoding="utf-8")
        played = []
        for number in range(self.episodes):
            for arm in SUITES[self.suite]:
                played.append(self._played(arm, number, files[RIGHT if arm.statistics == RIGHT else WRONG]))
                progress(played[-1])
        return played

    def _played(self, arm: Arm, number: int, statistics: Path) -> HomeEpisode:
        from sim_bridge.sensors.degradations import DEGRADATIONS

        bag = self.folder / f"{arm.name}_{number}"
        learnt = self._learnt(arm, number)
        search = HomeSearch(
            seed=self.seed + number,
            difficulty=DIFFICULTIES[number % len(DIFFICULTIES)],
            contestant=next(contestant for contestant in ALL if contestant.name == arm.planner),
            statistics=statistics,
            max_steps=self.max_steps,
            target=LEARNT_LABELS[number // len(DIFFICULTIES) % len(LEARNT_LABELS)]
            if self.suite == "statistics"
            else "",
            learnt=learnt,
            camera=DEGRADATIONS[arm.camera],
            detection=self.detection,
        )
        done = bag.with_name(f"{bag.name}.done")
        if done.exists():
            graph = measured(search.seed, bag)
        else:
            shutil.rmtree(bag, ignore_errors=True)
            if learnt is not None:
                self._hand_down(arm, number, learnt)
            graph = run_home_search(search, bag)
            done.touch()
        assumed = self.statistics if arm.statistics == RIGHT else _scaled(self.statistics, WRONG_BY)
        observed = None if learnt is None else read_observed(learnt)
        believed = LearntStatistics(assumed, BeliefParameters().learn_pseudo_count, observed)
        return HomeEpisode(arm=arm, number=number, graph=graph, believed=believed.of(graph.metrics.target))

    def _learnt(self, arm: Arm, number: int) -> Path | None:
        return self.folder / f"learnt_{number}.json" if arm.statistics == LEARNING else None

    def _hand_down(self, arm: Arm, number: int, learnt: Path) -> None:
        """Each search begins with what those before it have taught, also where it is repeated."""
        learnt.unlink(missing_ok=True)
        before = self._learnt(arm, number - 1)
        if number > 0 and before is not None and before.exists():
            shutil.copy(before, learnt)


def home_rows(played: Sequence[HomeEpisode]) -> list[HomeRow]:
    """A row for each arm, in their order."""
    arms = list(dict.fromkeys(episode.arm for episode in played))
    figures = {arm: _figures([episode for episode in played if episode.arm == arm]) for arm in arms}
    rows = []
    for arm in arms:
        of_arm = figures[arm]
        first = figures[next(other for other in arms if other.camera == arm.camera)]
        means, intervals = of_arm.mean(axis=0), mean_intervals(of_arm)
        steps = [
            float(episode.graph.metrics.steps or 0)
            for episode in played
            if episode.arm == arm and episode.graph.outcome is Outcome.SUCCESS
        ]
        rows.append(
            HomeRow(
                **asdict(arm),
                episodes=len(of_arm),
                sr=float(means[0]),
                sr_ci=intervals[0],
                spl=float(means[1]),
                spl_ci=intervals[1],
                wrong_stop=float(means[2]),
                wrong_stop_ci=intervals[2],
                not_found=max(0.0, float(1.0 - means[0] - means[2])),
                false_alarms=float(means[3]),
                false_alarms_ci=intervals[3],
                steps=float(np.mean(steps)) if steps else None,
                sr_gain=float(means[0] - first[:, 0].mean()),
                sr_gain_ci=difference_interval(of_arm[:, 0], first[:, 0]),
            )
        )
    return rows


def _figures(episodes: Sequence[HomeEpisode]) -> Float64:
    """Success, SPL, wrong stop and false alarms of each: float64 [episodes, 4]."""
    return np.array(
        [
            (
                float(episode.graph.outcome is Outcome.SUCCESS),
                episode.graph.metrics.spl or 0.0,
                float(episode.graph.outcome is Outcome.LOCALISATION_ERROR),
                float(episode.graph.metrics.false_alarms or 0),
            )
            for episode in episodes
        ]
    )


def _scaled(statistics: DetectorStatistics, factor: float) -> DetectorStatistics:
    """Precision and recall of every class times `factor`."""

    def scaled(one: ClassStatistics) -> ClassStatistics:
        by_range = one.recall_by_range
        return replace(
            one,
            precision=factor * one.precision,
            recall=factor * one.recall,
            recall_by_range=None if by_range is None else by_range.scaled(factor),
        )

    return DetectorStatistics(
        by_class={label: scaled(one) for label, one in statistics.by_class.items()},
        unknown_class=scaled(statistics.unknown_class),
    )


def _content(statistics: DetectorStatistics, factor: float) -> dict[str, Any]:
    """As the nodes read it from a file."""
    changed = _scaled(statistics, factor)
    rows = {label: _row(one) for label, one in changed.by_class.items()}
    return {"unknown_class": _row(changed.unknown_class), "classes": rows}


def _row(one: ClassStatistics) -> dict[str, Any]:
    return {name: value for name, value in asdict(one).items() if value is not None}
