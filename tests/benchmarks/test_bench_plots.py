from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.belief_picture import (
    PANELS,
    STEPS,
    draw_belief,
    fooled_episode,
    likeliest_place,
    replayed,
    shown_looks,
)
from robustnav_nodes.benchmarks.contestants import NAMES, contestants
from robustnav_nodes.benchmarks.search_episode import EpisodeResult, Outcome
from robustnav_nodes.benchmarks.search_plan import PlayedEpisode, play, suite_jobs
from robustnav_nodes.benchmarks.search_plots import _STYLE, BINS, bins_of, draw_spl_by_length
from robustnav_nodes.benchmarks.search_suite import make_scene


@pytest.fixture(scope="module")
def jobs():
    return suite_jobs(
        "easy-noisy",
        seed=1,
        episodes=20,
        contestants=contestants(["lookahead"], dock=False, simulations=64),
    )


@pytest.fixture(scope="module")
def told(jobs):
    return fooled_episode(jobs, "lookahead", "noisy")


@given(arrays.arrays(np.int64, st.integers(1, 120), elements=st.integers(1, 90)))
def test_bins_hold_every_episode_once_in_order(shortest):
    bins = bins_of(shortest)
    assert 1 <= len(bins) <= BINS
    assert sorted(np.concatenate(bins)) == list(range(len(shortest)))
    assert all(len(chosen) for chosen in bins)
    for nearer, farther in pairwise(bins):
        assert shortest[nearer].max() < shortest[farther].min()


def test_every_planner_has_its_line():
    assert set(_STYLE) == set(NAMES)


@pytest.mark.parametrize("difficulties", [["easy"], ["easy", "hard"], ["a", "b", "c", "d", "e"]])
def test_spl_is_drawn_for_as_many_difficulties_as_there_are(tmp_path, difficulties):
    played = [
        PlayedEpisode(
            planner=planner,
            difficulty=difficulty,
            detector=detector,
            scene="a",
            number=number,
            result=EpisodeResult(
                outcome=Outcome.SUCCESS, steps=20, shortest=3 + number, is_wrong_stop=False, decision_ms=()
            ),
        )
        for difficulty in difficulties
        for detector in ("perfect", "noisy")
        for number in range(12)
        for planner in ("lookahead", "pomp")
    ]
    png = tmp_path / "a.png"
    draw_spl_by_length(played, png)
    assert png.read_bytes().startswith(b"\x89PNG")
    with pytest.raises(BadFileError, match="cannot write the picture"):
        draw_spl_by_length(played, tmp_path / "nowhere" / "a.png")


def test_the_shown_episode_is_one_of_the_plan_and_was_fooled(jobs, told):
    assert told.result.is_success
    assert told.result.steps in STEPS
    in_plan = [episode.result for job in jobs for episode in play(job)]
    assert told.result.steps in [result.steps for result in in_plan]
    assert told.alarms
    for alarm in told.alarms:
        assert not told.target.in_view[told.moments[alarm.look].pose]
    assert fooled_episode(jobs, "pomp", "noisy") is None
    assert fooled_episode(jobs, "lookahead", "perfect") is None


def test_a_replay_is_the_episode_as_it_was_played(jobs):
    job = jobs[0]
    again = [
        replayed(job.load(), job.contestants[0], "noisy", seed=job.seed, number=n).result for n in job.numbers
    ]
    assert [(one.outcome, one.steps) for one in again] == [
        (episode.result.outcome, episode.result.steps) for episode in play(job)
    ]


def test_the_shown_moments_begin_and_end_with_the_episode_and_hold_the_alarm(told):
    looks = shown_looks(told)
    assert len(looks) == PANELS
    assert looks == sorted(looks)
    assert (looks[0], looks[-1]) == (0, len(told.moments) - 1)
    assert told.alarms[0].look in looks


def test_the_target_is_where_it_was_put():
    scene = make_scene("easy", 3)
    for target in scene.targets[:5]:
        place = likeliest_place(target, scene.space.observability)
        np.testing.assert_array_equal(scene.space.observability.column(place), target.in_view)


def test_the_belief_is_drawn(told, tmp_path):
    draw_belief(told, "lookahead", tmp_path / "belief.png")
    assert (tmp_path / "belief.png").stat().st_size > 20_000
