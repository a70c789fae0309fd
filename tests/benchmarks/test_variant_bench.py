"""The experiments on what goes beyond the thesis, on scenes small enough to see through."""

import dataclasses
import json

import numpy as np
import pytest
import typer
from typer.testing import CliRunner

from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.benchmarks import variant_bench, variant_parts
from robustnav_nodes.benchmarks.rooms import rooms_of
from robustnav_nodes.benchmarks.search_episode import Outcome, run_episode
from robustnav_nodes.benchmarks.search_scene import SearchScene
from robustnav_nodes.benchmarks.search_suite import NOISY, PERFECT, make_scene, starts_of
from robustnav_nodes.benchmarks.tour_episode import run_at_once, run_one_after_another
from robustnav_nodes.benchmarks.variant_bench import variant_rows
from robustnav_nodes.benchmarks.variant_command import variants_command
from robustnav_nodes.benchmarks.variant_parts import DATA_SHEET, PARTS, Episode, learnt_statistics
from robustnav_nodes.planner.parameters import PlannerParameters

QUICK = PlannerParameters(variant="lookahead", dock=False, goals=4, lookahead_steps=30)


@pytest.fixture(scope="module")
def easy() -> SearchScene:
    return make_scene("easy", 0)


@pytest.fixture(scope="module")
def medium() -> SearchScene:
    return make_scene("medium", 1)


def quick_episode(scene: SearchScene, number: int) -> Episode:
    episode = Episode.drawn(scene, seed=1, number=number)
    contestant = dataclasses.replace(episode.contestant, planner=QUICK)
    return dataclasses.replace(episode, contestant=contestant)


def test_rooms_are_what_walls_part(easy, medium):
    """One room, and four with doors between them; neighbours on a table are in the same room."""
    assert rooms_of(easy.space.view).max() == 0
    room = rooms_of(medium.space.view)
    assert np.unique(room).tolist() == [0, 1, 2, 3]
    x_m, y_m = medium.space.candidates.x_m, medium.space.candidates.y_m
    beside = np.hypot(x_m[:, None] - x_m, y_m[:, None] - y_m) < 0.25
    together = room[:, None] == room
    assert (together & beside).sum() > 0.99 * beside.sum()
    for one in range(4):
        inside = room == one
        assert np.ptp(x_m[inside]) < 0.8 * np.ptp(x_m) or np.ptp(y_m[inside]) < 0.8 * np.ptp(y_m)


def test_the_place_of_a_target_is_what_every_view_of_it_shows(easy):
    for number in range(5):
        episode = quick_episode(easy, number)
        assert np.array_equal(easy.space.observability.column(episode.place), episode.target.in_view)


def test_a_prior_on_the_right_place_leads_straight_there(easy):
    for number in range(3):
        target = easy.targets[number]
        start = int(starts_of(easy, target)[0])
        record = target.detections[PERFECT]
        prior = np.full(len(easy.space.candidates), 0.1 / len(easy.space.candidates))
        prior[record.candidate[np.argmax(record.weight)]] += 0.9
        rng = np.random.default_rng(0)
        result = run_episode(easy, target, PERFECT, start, QUICK, BeliefParameters(), rng, prior=prior)
        assert result.outcome is Outcome.SUCCESS
        assert result.spl == 1.0


def test_a_prior_alone_is_no_find(easy):
    """All is believed to be at one place where nothing is: looking there ends nothing."""
    target = easy.targets[0]
    elsewhere = np.nonzero(
        ~np.isin(np.arange(len(easy.space.candidates)), target.detections[PERFECT].candidate)
    )
    prior = np.zeros(len(easy.space.candidates))
    prior[elsewhere[0][0]] = 1.0
    start = int(starts_of(easy, target)[0])
    rng = np.random.default_rng(0)
    result = run_episode(easy, target, PERFECT, start, QUICK, BeliefParameters(), rng, prior=prior)
    assert result.outcome is not Outcome.LOCALISATION_ERROR


def test_several_targets_are_found_faster_at_once(easy):
    steps = []
    for number in range(6):
        targets = [easy.targets[number], easy.targets[number + 6], easy.targets[number + 12]]
        start = int(starts_of(easy, targets[0])[number])
        for run in (run_at_once, run_one_after_another):
            result = run(
                easy, targets, PERFECT, start, QUICK, BeliefParameters(), np.random.default_rng(number)
            )
            assert result.found == (True, True, True)
            steps.append(result.steps)
    assert sum(steps[::2]) < 0.9 * sum(steps[1::2])


def test_learning_moves_from_the_data_sheet_towards_the_truth(easy):
    """Over several targets: the error of the recall that is believed in at the end."""
    errors = []
    for number in range(8):
        episode = quick_episode(easy, number)
        starts = starts_of(easy, episode.target)[:: len(easy.space.graph) // 8][:6]
        learnt = learnt_statistics(episode, starts.tolist())
        right = episode.target.detections[NOISY].statistics
        assert 0.0 < learnt[-1][1].recall < 1.0
        errors.append((abs(learnt[-1][1].recall - right.recall), abs(DATA_SHEET.recall - right.recall)))
    assert np.mean(errors, axis=0)[0] < 0.75 * np.mean(errors, axis=0)[1]


@pytest.mark.parametrize("part", PARTS)
def test_an_experiment_says_the_same_again(medium, part, monkeypatch):
    monkeypatch.setattr(variant_parts, "SEARCHES", 2)
    one, same = (PARTS[part](quick_episode(medium, 4)) for _ in range(2))
    assert list(one) == list(same)
    for variant, score in one.items():
        np.testing.assert_equal(score, same[variant])
        assert 0.0 <= score.sr <= 1.0


@pytest.fixture
def small(monkeypatch):
    """The bench on an easy scene, with two searches for the same target."""
    monkeypatch.setattr(variant_bench, "DIFFICULTY", "easy")
    monkeypatch.setattr(variant_parts, "SEARCHES", 2)


@pytest.mark.usefixtures("small")
def test_rows_hold_what_is_measured():
    done = []
    rows = variant_rows(episodes=2, seed=3, progress=lambda: done.append(1))
    assert len(done) == 2
    assert [row.part for row in rows if row.variant in ("wrong", "nothing known", "0% blocked")] == [
        "detector statistics",
        "prior",
        "blocked ways",
    ]
    for row in rows:
        assert row.episodes == 2
        assert row.sr.ci[0] <= row.sr.mean <= row.sr.ci[1]
        assert (row.spl is None) == (row.part == "several targets")
    assert {row.steps.gain for row in rows if row.variant in ("wrong", "one after another")} == {0.0}


@pytest.mark.usefixtures("small")
def test_the_command_writes_its_report(tmp_path):
    app = typer.Typer()
    app.command()(variants_command)
    path = tmp_path / "variants.json"
    result = CliRunner().invoke(app, ["--episodes", "2", "--seed", "3", "--json", str(path)])
    assert result.exit_code == 0, result.output
    assert "at once" in result.output
    report = json.loads(path.read_text())
    assert (report["bench"], report["episodes"], report["seed"]) == ("variants", 2, 3)
    assert len(report["rows"]) == 10
