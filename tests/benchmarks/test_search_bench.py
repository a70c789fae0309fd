import dataclasses
import importlib.util
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from bags.metrics import SearchMetrics
from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadFileError, BadParameterError, GraphError
from robustnav_nodes.benchmarks import graph_bench
from robustnav_nodes.benchmarks.contestants import ALL, DEFAULT, NAMES, contestants
from robustnav_nodes.benchmarks.export_pomp import TARGET_ID, export_pomp
from robustnav_nodes.benchmarks.graph_bench import GraphEpisode
from robustnav_nodes.benchmarks.scene_file import write_scene
from robustnav_nodes.benchmarks.search_bench import (
    REFERENCES,
    as_json,
    gains,
    row_of,
    search_rows,
    settings_of,
)
from robustnav_nodes.benchmarks.search_episode import EpisodeResult, Outcome
from robustnav_nodes.benchmarks.search_plan import (
    PlayedEpisode,
    drawn_episode,
    folder_jobs,
    play,
    suite_jobs,
)
from robustnav_nodes.benchmarks.search_suite import make_scene, starts_of
from robustnav_nodes.benchmarks.search_workers import play_here, play_on_ray
from robustnav_nodes.planner.parameters import VARIANTS
from robustnav_nodes.search_space.pose_graph import NOWHERE

QUICK = ("random", "greedy", "lookahead")


@pytest.fixture(scope="module")
def easy():
    return make_scene("easy", 1000)


def chosen(*names, dock=False):
    return contestants(names or QUICK, dock=dock, simulations=64)


def result(outcome, steps=10, shortest=5, decision_ms=(1.0, 3.0), is_wrong_stop=None):
    """is_wrong_stop: None: as the outcome is defined where nothing is docked to."""
    if is_wrong_stop is None:
        is_wrong_stop = outcome is Outcome.LOCALISATION_ERROR
    return EpisodeResult(
        outcome=outcome,
        steps=steps,
        shortest=shortest,
        is_wrong_stop=is_wrong_stop,
        decision_ms=decision_ms,
    )


def episode(planner, outcome, number=0, difficulty="easy", detector="noisy", **more):
    return PlayedEpisode(
        planner=planner,
        difficulty=difficulty,
        detector=detector,
        scene="a",
        number=number,
        result=result(outcome, **more),
    )


def without_times(played):
    return sorted(
        (
            one.difficulty,
            one.detector,
            one.planner,
            one.scene,
            one.number,
            dataclasses.replace(one.result, decision_ms=()),
        )
        for one in played
    )


class TestContestants:
    def test_all_planners_play_and_the_default_is_one_of_them(self):
        assert {contestant.planner.variant for contestant in ALL} == set(VARIANTS)
        assert DEFAULT in NAMES
        default = next(contestant for contestant in ALL if contestant.name == DEFAULT)
        assert default.settings()["planner"] == default.settings()["belief"] == {}

    def test_the_thesis_planners_believe_as_the_thesis_does_but_for_c2(self):
        for contestant in chosen("pomp", "pomp_be", "pomp_pd", "pomp_be_pd", "greedy"):
            assert contestant.settings()["belief"] == {"evidence": "f1", "detection_floor": 1e-3}
            assert contestant.planner.ending == "variant"

    def test_all_dock_at_the_nearest_pose(self):
        for contestant in chosen(*NAMES, dock=True):
            assert contestant.settings()["planner"]["docking_distance_m"] == 0.1
            assert contestant.planner.dock

    def test_lookahead_plans_with_the_recall_of_the_detector(self):
        (contestant,) = chosen("lookahead")
        assert contestant.planner_for(ClassStatistics(precision=0.8, recall=0.55)).recall == 0.55
        perfect = ClassStatistics(precision=1.0, recall=1.0)
        assert contestant.planner_for(perfect).recall == contestant.belief.recall_max

    @pytest.mark.parametrize(
        ("names", "says"), [(["astar"], "'astar'"), (["pomp"] * 2, "once"), ([], "once")]
    )
    def test_others_are_refused(self, names, says):
        with pytest.raises(BadParameterError, match=says):
            contestants(names, dock=False, simulations=64)


class TestPlan:
    def test_seeds_share_no_scene_and_episodes_are_spread(self):
        one, two = (suite_jobs("all", seed=s, episodes=25, contestants=chosen()) for s in (1, 2))
        assert [job.source for job in one] == [
            f"{difficulty}, {1000 + number}"
            for difficulty in ("hard", "medium", "easy")
            for number in range(7)
        ]
        assert not {job.source for job in one} & {job.source for job in two}
        assert {len(job.numbers) for job in one[:7]} == {3, 4}
        assert [number for job in one[:7] for number in job.numbers] == list(range(25))
        assert {job.detectors for job in one} == {("perfect", "noisy")}

    def test_never_more_scenes_than_a_seed_has(self):
        jobs = suite_jobs("easy-noisy", seed=1, episodes=12_000, contestants=chosen())
        assert len(jobs) == 1000
        assert sum(len(job.numbers) for job in jobs) == 12_000

    def test_an_unknown_suite_is_refused(self):
        with pytest.raises(BadParameterError, match=r"'easy'.*easy-perfect"):
            suite_jobs("easy", seed=1, episodes=1, contestants=chosen())

    def test_an_episode_depends_on_seed_scene_and_number_alone(self, easy):
        def drawn(seed, number, detector="noisy"):
            target, start = drawn_episode(easy, detector, seed=seed, number=number, dock=False)
            return target.label, start

        assert drawn(1, 0) == drawn(1, 0) == drawn(1, 0, "perfect")
        assert len({drawn(seed, number) for seed in (1, 2) for number in range(10)}) > 15

    def test_a_start_has_a_way_and_no_view_near(self, easy):
        for number in range(20):
            target, start = drawn_episode(easy, "noisy", seed=1, number=number, dock=True)
            assert start in starts_of(easy, target)
            assert np.isfinite(easy.space.graph.steps_from(start)[target.destination].min())

    def test_a_scene_without_starts_lets_begin_anywhere_with_a_way(self, easy):
        """Here only poses from which the target is in view anyway have one."""
        graph = dataclasses.replace(
            easy.space.graph, successors=np.full_like(easy.space.graph.successors, NOWHERE)
        )
        scene = dataclasses.replace(
            easy,
            starts=np.zeros(0, dtype=np.int32),
            space=dataclasses.replace(easy.space, graph=graph),
            targets=easy.targets[:1],
        )
        far = easy.targets[0].in_view
        with pytest.raises(BadFileError, match="no target"):
            drawn_episode(scene, "noisy", seed=1, number=0, dock=False)
        everywhere = dataclasses.replace(scene.targets[0], in_view=np.ones_like(far))
        _, start = drawn_episode(
            dataclasses.replace(scene, targets=(everywhere,)), "noisy", seed=1, number=0, dock=False
        )
        assert 0 <= start < len(graph)


class TestPlay:
    def test_every_planner_plays_the_same_episodes(self, easy):
        (job,) = suite_jobs("easy-perfect", seed=1, episodes=4, contestants=chosen())
        played = play(job)
        by_planner = {
            name: [(e.scene, e.number, e.result.shortest) for e in played if e.planner == name]
            for name in QUICK
        }
        assert by_planner["random"] == by_planner["greedy"] == by_planner["lookahead"]
        assert len(played) == 4 * len(QUICK)
        assert without_times(play(job)) == without_times(played)

    @pytest.mark.skipif(importlib.util.find_spec("ray") is not None, reason="Ray is installed")
    def test_without_ray_it_says_what_to_install(self):
        with pytest.raises(BadParameterError, match=r"pip install 'robustnav\[cluster\]'"):
            list(play_on_ray([], "auto"))

    def test_where_no_cluster_answers_it_says_so_at_once(self, monkeypatch):
        monkeypatch.setitem(sys.modules, "ray", SimpleNamespace())
        with pytest.raises(BadParameterError, match=r"no Ray cluster at '127\.0\.0\.1:1' .*ray start --head"):
            list(play_on_ray([], "127.0.0.1:1"))

    @pytest.mark.slow
    def test_ray_changes_nothing(self):
        pytest.importorskip("ray")
        jobs = suite_jobs("easy-noisy", seed=3, episodes=12, contestants=chosen())
        here = [played for of_scene in play_here(jobs, 1) for played in of_scene]
        on_ray = [played for of_scene in play_on_ray(jobs, "local") for played in of_scene]
        assert without_times(here) == without_times(on_ray)


class TestFolders:
    def test_scene_files_are_played_and_share_the_episodes(self, easy, tmp_path):
        for name in ("a", "b"):
            write_scene(dataclasses.replace(easy, name=name, difficulty="mine"), tmp_path / f"{name}.npz")
        jobs = folder_jobs(tmp_path, None, seed=1, episodes=5, contestants=chosen("greedy"))
        rows = search_rows([played for job in jobs for played in play(job)], ["greedy"])
        assert [(row.difficulty, row.detector, row.episodes) for row in rows] == [
            ("mine", "perfect", 5),
            ("mine", "noisy", 5),
        ]

    def test_a_folder_of_the_released_planner_is_a_scene(self, easy, tmp_path):
        folder = tmp_path / "home"
        export_pomp(easy, easy.targets[0].label, "noisy", folder)
        jobs = folder_jobs(folder, TARGET_ID, seed=1, episodes=3, contestants=chosen("lookahead", dock=True))
        assert [job.source for job in jobs] == [f"{folder}, {TARGET_ID}"]
        (perfect, noisy) = search_rows(play(jobs[0]), ["lookahead"])
        assert (perfect.detector, perfect.difficulty, perfect.episodes) == ("perfect", "home", 3)
        assert perfect.sr == 1.0
        assert noisy.detector == "noisy"

    def test_fewer_episodes_than_scenes(self, easy, tmp_path):
        for name in ("a", "b", "c"):
            write_scene(easy, tmp_path / f"{name}.npz")
        jobs = folder_jobs(tmp_path, None, seed=1, episodes=1, contestants=chosen())
        assert [len(job.numbers) for job in jobs] == [1]

    def test_a_folder_without_scenes_is_refused(self, tmp_path):
        with pytest.raises(BadParameterError, match=r"--target-id"):
            folder_jobs(tmp_path, None, seed=1, episodes=1, contestants=chosen())


class TestRows:
    def test_worked_by_hand(self):
        played = [
            episode("greedy", Outcome.SUCCESS, 0, steps=10, shortest=5),
            episode("greedy", Outcome.SUCCESS, 1, steps=4, shortest=4, decision_ms=(2.0,)),
            episode("greedy", Outcome.LOCALISATION_ERROR, 2, steps=1),
            episode("greedy", Outcome.OTHER_ERROR, 3, steps=200),
        ]
        (row,) = search_rows(played, ["greedy"])
        assert (row.sr, row.spl, row.apl) == (0.5, 0.375, 7.0)
        assert (row.wrong_stop, row.localisation_error, row.docking_error, row.other_error) == (
            0.25,
            0.25,
            0.0,
            0.25,
        )
        assert row.sr_ci[0] < 0.5 < row.sr_ci[1]
        assert (row.decision_ms_p50, row.decision_ms_p95) == (2.0, 3.0)
        assert row.sr + row.localisation_error + row.docking_error + row.other_error == 1.0

    def test_without_success_there_is_no_path_length(self):
        row = row_of(
            "a",
            "b",
            "c",
            outcomes=[Outcome.OTHER_ERROR],
            spl=np.zeros(1),
            steps=[200],
            wrong_stops=[False],
            decision_ms=[],
        )
        assert (row.apl, row.sr_ci, row.decision_ms_p95) == (None, (0.0, 0.0), 0.0)

    def test_a_wrong_stop_is_counted_apart_from_what_was_wrong_before_it(self):
        """Docked to a false alarm, with the target in view there; and found, then docked out of sight."""
        played = [
            episode("greedy", Outcome.LOCALISATION_ERROR, 0, is_wrong_stop=False),
            episode("greedy", Outcome.DOCKING_ERROR, 1, is_wrong_stop=True),
            episode("greedy", Outcome.DOCKING_ERROR, 2, is_wrong_stop=False),
            episode("greedy", Outcome.SUCCESS, 3),
        ]
        (row,) = search_rows(played, ["greedy"])
        assert (row.wrong_stop, row.localisation_error, row.docking_error) == (0.25, 0.25, 0.5)

    def test_cells_stand_in_the_order_of_the_suites(self):
        played = [
            episode("greedy", Outcome.SUCCESS, difficulty=difficulty, detector=detector)
            for difficulty in ("mine", "hard", "easy")
            for detector in ("noisy", "perfect", "mine")
        ]
        assert [(row.difficulty, row.detector) for row in search_rows(played, ["greedy"])] == [
            (difficulty, detector)
            for difficulty in ("easy", "hard", "mine")
            for detector in ("perfect", "noisy", "mine")
        ]

    def test_gain_is_over_the_same_episodes(self):
        """The default is twice as good as one and four times as good as another, whatever the episode."""
        played = []
        for number in range(20):
            steps = number + 5
            played += [
                episode(DEFAULT, Outcome.SUCCESS, number, steps=steps, shortest=5),
                episode("greedy_gain", Outcome.SUCCESS, number, steps=2 * steps, shortest=5),
                episode("greedy", Outcome.SUCCESS, number, steps=4 * steps, shortest=5),
                episode("pomp", Outcome.SUCCESS, number, steps=steps, shortest=5),  # no reference
            ]
        found = gains(played[::-1])
        assert [gain.over for gain in found] == ["greedy", "greedy_gain"]  # greedy_likelihood did not play
        for gain, ratio in zip(found, (4.0, 2.0), strict=True):
            assert gain.spl_ratio == pytest.approx(ratio)
            assert gain.spl_ratio_ci == pytest.approx((ratio, ratio))
            assert gain.sr_difference_ci == (0.0, 0.0)
        assert gains([one for one in played if one.planner == DEFAULT]) == []
        assert gains([one for one in played if one.planner != DEFAULT]) == []

    def test_the_references_are_the_rules_that_play(self):
        assert REFERENCES == ("greedy", "greedy_likelihood", "greedy_gain")
        assert set(REFERENCES) <= set(NAMES)

    def test_a_gain_over_nothing_is_unknown(self):
        (gain,) = gains([episode(DEFAULT, Outcome.SUCCESS), episode("greedy", Outcome.OTHER_ERROR)])
        assert (gain.spl_ratio, gain.spl_ratio_ci) == (None, (None, None))
        assert as_json([gain])[0]["sr_difference"] == 1.0

    def test_settings_tell_what_differs_from_the_defaults(self):
        players = chosen("lookahead_discount")
        settings = settings_of(suite_jobs("easy-noisy", seed=1, episodes=1, contestants=players), players)
        assert settings["scenes"] == [{"scene": "easy, 1000", "episodes": 1}]
        planner = settings["planners"]["lookahead_discount"]["planner"]
        assert (planner["worth"], planner["discount"], planner["simulations"]) == ("discount", 0.95, 64)


class TestGraph:
    """A demo's bag is measured elsewhere; here, what is made of the measures."""

    def metrics(self, *, found=True, success=True, spl=0.5):
        return SearchMetrics(
            target="mug",
            episode=1,
            phase="found" if found else "not_found",
            found=found,
            success=success,
            steps=20,
            path_length_m=4.0,
            shortest_path_m=2.0,
            spl=spl,
            false_alarms=0,
            wall_duration_s=30.0,
            sim_duration_s=120.0,
        )

    def test_demos_become_a_row(self, monkeypatch, tmp_path):
        of_seed = {
            5: self.metrics(),
            6: self.metrics(success=False, spl=0.0),
            7: self.metrics(found=False, success=False, spl=0.0),
            8: self.metrics(spl=None),  # nobody knows the shortest way: counts as none
        }
        bags = []

        def run_demo(seed, bag):
            bags.append(bag.name)
            return GraphEpisode(seed=seed, metrics=of_seed[seed], decision_ms=(float(seed),))

        monkeypatch.setattr(graph_bench, "run_demo", run_demo)
        row = graph_bench.graph_row(4, seed=5, folder=tmp_path)
        assert bags == ["demo_5", "demo_6", "demo_7", "demo_8"]
        assert (row.planner, row.difficulty, row.detector) == (DEFAULT, "graph", "simulated")
        assert (row.sr, row.wrong_stop, row.other_error, row.spl, row.apl) == (0.5, 0.25, 0.25, 0.125, 20.0)
        assert row.decision_ms_p50 == 6.5

    def test_a_demo_without_a_bag_is_told_with_its_last_line(self, monkeypatch, tmp_path):
        def run(command, **_more):
            assert command[-2:] == ["--bag", str(tmp_path / "demo")]
            return subprocess.CompletedProcess(command, 1, stdout="starting\nno room left\n")

        monkeypatch.setattr(graph_bench.subprocess, "run", run)
        with pytest.raises(GraphError, match="seed 3 .* exited with 1 .*no room left"):
            graph_bench.run_demo(3, tmp_path / "demo")
