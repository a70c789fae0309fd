"""Searches in homes: the arms differ in what they should, what is learnt is handed down, and rows add up."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bags.metrics import SearchMetrics
from robustnav_msgs_py.detector_statistics import (
    ClassStatistics,
    DetectorStatistics,
    RecallByRange,
    read_detector_statistics,
)
from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes import cli
from robustnav_nodes.belief.learnt_statistics import read_observed, write_observed
from robustnav_nodes.belief.online_statistics import Observed
from robustnav_nodes.benchmarks import home_bench
from robustnav_nodes.benchmarks.graph_bench import GraphEpisode
from robustnav_nodes.benchmarks.home_bench import LEARNING, SUITES, Arm, HomeBench, HomeEpisode, home_rows
from robustnav_nodes.benchmarks.home_plots import draw_learning
from robustnav_nodes.benchmarks.home_search import HomeSearch

MUG = ClassStatistics(
    precision=0.8, recall=0.6, recall_by_range=RecallByRange(edges_m=(0.0, 2.0, 4.0), recall=(0.8, 0.4))
)
KNOWN = DetectorStatistics(by_class={"mug": MUG})
METRICS = SearchMetrics(
    target="mug",
    episode=1,
    phase="found",
    found=True,
    success=True,
    steps=8,
    path_length_m=4.0,
    shortest_path_m=2.0,
    spl=0.5,
    false_alarms=1,
    wall_duration_s=1.0,
    sim_duration_s=9.0,
)
WRONG_STOP = replace(METRICS, success=False, spl=0.0, false_alarms=0)
NOT_FOUND = replace(METRICS, found=False, success=False, spl=0.0, false_alarms=3)


def bench(folder: Path, suite: str, episodes: int = 3) -> HomeBench:
    return HomeBench(
        suite=suite,
        seed=700_000,
        episodes=episodes,
        max_steps=6,
        folder=folder,
        statistics=KNOWN,
        detection={"back_end": "truth"},
    )


class Played:
    """Stands for the searches: notes what was asked for, and learns one thing in each."""

    def __init__(self) -> None:
        self.searches: list[HomeSearch] = []
        self.known: list[float] = []

    def __call__(self, search: HomeSearch, bag: Path) -> GraphEpisode:
        bag.mkdir()
        self.searches.append(search)
        if search.learnt is not None:
            before = read_observed(search.learnt).get("mug", Observed())
            self.known.append(before.detected)
            write_observed(search.learnt, {"mug": replace(before, detected=before.detected + 1.0)})
        return GraphEpisode(seed=search.seed, metrics=METRICS, decision_ms=())


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Played:
    made = Played()
    monkeypatch.setattr(home_bench, "run_home_search", made)
    monkeypatch.setattr(
        home_bench, "measured", lambda seed, _: GraphEpisode(seed=seed, metrics=METRICS, decision_ms=())
    )
    return made


def test_the_arms_of_a_suite_search_the_same_homes(tmp_path: Path, played: Played) -> None:
    bench(tmp_path, "degradations", 2).play(lambda _: None)
    assert len(played.searches) == 2 * len(SUITES["degradations"])
    first, second = played.searches[:2]
    assert (first.seed, first.difficulty) == (second.seed, second.difficulty) == (700_000, "easy")
    assert [search.contestant.name for search in (first, second)] == ["pomp", "lookahead"]
    dark = next(search for search in played.searches if search.camera and search.camera.darkness > 0.0)
    assert dark.plan().parameters["sim_bridge"]["darkness"] == 0.8
    assert first.plan().parameters["planner"]["variant"] == "pomp"
    assert first.plan().parameters["belief"]["evidence"] == "f1"


def test_wrong_statistics_are_half_of_what_was_measured(tmp_path: Path, played: Played) -> None:
    bench(tmp_path, "statistics", 1).play(lambda _: None)
    right, wrong, learning = (read_detector_statistics(search.statistics) for search in played.searches)
    assert right.of("mug") == MUG
    assert (wrong.of("mug").precision, wrong.of("mug").recall) == (0.4, 0.3)
    by_range = wrong.of("mug").recall_by_range
    assert by_range is not None
    assert by_range.recall == (0.4, 0.2)
    assert learning == wrong
    assert [search.learnt is None for search in played.searches] == [True, True, False]


def test_what_a_search_teaches_is_known_to_the_next_also_after_a_stop(tmp_path: Path, played: Played) -> None:
    bench(tmp_path, "statistics", 2).play(lambda _: None)
    told = bench(tmp_path, "statistics", 4).play(lambda _: None)
    assert played.known == [0.0, 1.0, 2.0, 3.0]  # the first two are not searched again
    assert len(told) == 4 * len(SUITES["statistics"])
    recalls = [episode.believed.recall for episode in told if episode.arm.statistics == LEARNING]
    assert recalls == sorted(recalls)
    assert recalls[0] > 0.3


def episodes(metrics: dict[Arm, list[SearchMetrics]]) -> list[HomeEpisode]:
    return [
        HomeEpisode(
            arm=arm,
            number=number,
            graph=GraphEpisode(seed=number, metrics=own, decision_ms=()),
            believed=MUG,
        )
        for arm, of_arm in metrics.items()
        for number, own in enumerate(of_arm)
    ]


def test_rows_add_up_and_gains_are_over_the_first_of_the_camera() -> None:
    pomp, ours = Arm(planner="pomp"), Arm(planner="lookahead")
    rows = home_rows(
        episodes(
            {
                pomp: [METRICS, WRONG_STOP, NOT_FOUND, WRONG_STOP],
                ours: [METRICS, METRICS, NOT_FOUND, METRICS],
            }
        )
    )
    assert [(row.sr, row.wrong_stop, row.not_found) for row in rows] == [(0.25, 0.5, 0.25), (0.75, 0.0, 0.25)]
    assert [row.false_alarms for row in rows] == [1.0, 1.5]
    assert [row.sr_gain for row in rows] == [0.0, 0.5]
    assert rows[0].sr_gain_ci == (0.0, 0.0)
    assert rows[1].sr_ci[0] < 0.75 < rows[1].sr_ci[1]
    assert rows[1].steps == 8.0


def test_the_figure_of_learning_is_drawn(tmp_path: Path) -> None:
    draw_learning(
        episodes({arm: [METRICS, NOT_FOUND] for arm in SUITES["statistics"]}), KNOWN, tmp_path / "a.png"
    )
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_search_goes_through_the_real_nodes_and_the_command_reports_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(SUITES, "planners", (Arm(planner="lookahead"),))
    monkeypatch.setattr(home_bench, "DIFFICULTIES", ("easy",))
    arguments: list[Any] = ["bench", "homes", "--back-end", "truth", "--episodes", 2, "--max-steps", 3]
    arguments += ["--folder", tmp_path / "bags", "--json", tmp_path / "homes.json"]
    command = [str(argument) for argument in arguments]
    cli.command_line()(command, standalone_mode=False)
    report = json.loads((tmp_path / "homes.json").read_text(encoding="utf-8"))
    (row,) = report["rows"]
    assert row["episodes"] == 2
    assert np.isclose(row["sr"] + row["wrong_stop"] + row["not_found"], 1.0)
    assert {search["home"] for search in report["searches"]} == {700_000, 700_001}
    assert all(search["steps"] <= 3 + 8 for search in report["searches"])  # docking comes on top
    assert "lookahead" in capsys.readouterr().out


def test_an_unknown_suite_is_refused() -> None:
    with pytest.raises(BadParameterError, match="there are planners, degradations, statistics"):
        cli.command_line()(["bench", "homes", "--suite", "all"], standalone_mode=False)
