"""Searches through the whole ROS graph, in simulated homes, measured from their bags."""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from robustnav_msgs_py.errors import GraphError, RobustnavError
from robustnav_nodes.benchmarks.contestants import DEFAULT
from robustnav_nodes.benchmarks.search_bench import SearchRow, row_of
from robustnav_nodes.benchmarks.search_episode import Outcome

if TYPE_CHECKING:  # bags stands on this package, so that it may be missing here
    from bags.metrics import SearchMetrics

DIFFICULTY, DETECTOR = "graph", "simulated"


@dataclass(frozen=True, slots=True, kw_only=True)
class GraphEpisode:
    """One demo, as its bag tells it."""

    seed: int
    metrics: "SearchMetrics"
    decision_ms: tuple[float, ...]

    @property
    def outcome(self) -> Outcome:
        """A stop at the wrong place is a localisation error: a bag does not tell it from a docking error."""
        if self.metrics.success:
            return Outcome.SUCCESS
        return Outcome.LOCALISATION_ERROR if self.metrics.found else Outcome.OTHER_ERROR


def graph_row(
    count: int, *, seed: int, folder: Path, progress: Callable[[GraphEpisode], None] = lambda episode: None
) -> SearchRow:
    """Run `count` demos, seeds from `seed` on, one after the other, and sum them up.

    Bags, pictures and logs go to `folder`. SPL is of metres driven, not of steps. Raises GraphError for a
    demo that leaves no bag that can be measured.
    """
    episodes = []
    for number in range(seed, seed + count):
        episodes.append(run_demo(number, folder / f"demo_{number}"))
        progress(episodes[-1])
    return row_of(
        DEFAULT,
        DIFFICULTY,
        DETECTOR,
        outcomes=[episode.outcome for episode in episodes],
        spl=np.array([episode.metrics.spl or 0.0 for episode in episodes]),
        steps=[episode.metrics.steps or 0 for episode in episodes],
        wrong_stops=[episode.outcome is Outcome.LOCALISATION_ERROR for episode in episodes],
        decision_ms=[time for episode in episodes for time in episode.decision_ms],
    )


def run_demo(seed: int, bag: Path) -> GraphEpisode:
    """`robustnav demo` in a process of its own, and what its bag tells."""
    demo = [sys.executable, "-m", "robustnav_nodes", "demo", "--seed", str(seed), "--bag", str(bag)]
    done = subprocess.run(demo, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    try:
        return measured(seed, bag)
    except RobustnavError as error:
        last = done.stdout.strip().splitlines()[-1:] or ["nothing"]
        raise GraphError(
            f"the demo with seed {seed} cannot be measured ({error}); it exited with {done.returncode} and "
            f"said at last: {last[0]}"
        ) from error


def measured(seed: int, bag: Path) -> GraphEpisode:
    """The search in `bag`. Raises what `read_search` raises."""
    from bags.metrics import measure
    from bags.metrics_settings import settings_of
    from bags.reader import open_bag
    from bags.search_run import read_search

    with open_bag(bag) as opened:
        run = read_search(opened)
        metrics = measure(run, settings_of(opened.manifest, run.namespace))
    times = tuple(decision.value.elapsed_ms for decision in run.decisions)
    return GraphEpisode(seed=seed, metrics=metrics, decision_ms=times)
