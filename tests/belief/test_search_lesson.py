"""What a search teaches, by hand: five candidates 3 m apart, searches told state by state."""

from dataclasses import replace

import numpy as np
import pytest

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.records import SearchPhase, SearchState
from robustnav_nodes.belief.observation import place_densities
from robustnav_nodes.belief.online_statistics import CountedLook, Observed, OnlineStatistics
from robustnav_nodes.belief.search_lesson import SearchLesson

BEFORE = OnlineStatistics.starting_from(ClassStatistics(precision=0.5, recall=0.9))
SEARCHING = SearchState(phase=SearchPhase.SEARCHING, target="mug", episode=1)


def state(phase: SearchPhase, place: int = 0, episode: int = 1) -> SearchState:
    return replace(SEARCHING, phase=phase, best_x_m=place * 3.0 + 0.2, episode=episode)


@pytest.fixture
def candidates(in_a_row):
    return in_a_row(5, spacing_m=3.0)


@pytest.fixture
def look_at(candidates):
    def make(in_view, *fired: int) -> CountedLook:
        seen = np.isin(np.arange(5), list(in_view))
        places = np.array([(place * 3.0, 0.0) for place in fired]).reshape(-1, 2)
        return CountedLook(in_view=seen, densities=place_densities(candidates, seen, places, 0.5))

    return make


@pytest.fixture
def lesson(candidates) -> SearchLesson:
    made = SearchLesson("mug", BEFORE, candidates)
    assert made.hear(SEARCHING) is None
    return made


def seen(online: OnlineStatistics | None) -> Observed:
    assert online is not None
    return online.observed_since(BEFORE)


def test_a_find_with_the_target_in_view_at_the_dock_counts(lesson, look_at):
    """Missed once, then fired elsewhere, then detected, docked, detected once more."""
    for look in (look_at([1]), look_at([2], 2), look_at([1], 1)):
        lesson.look(look)
    assert lesson.hear(state(SearchPhase.DOCKING, 1)) is None
    lesson.look(look_at([1, 2], 1))
    after = lesson.hear(state(SearchPhase.FOUND, 1))
    assert seen(after) == Observed(detected=2, missed=1, true_firings=2, false_firings=1)


def test_a_find_that_the_dock_did_not_show_teaches_nothing_until_the_person_speaks(lesson, look_at):
    lesson.look(look_at([1], 1))
    lesson.hear(state(SearchPhase.DOCKING, 1))
    lesson.look(look_at([1]))
    assert lesson.hear(state(SearchPhase.FOUND, 1)) is None
    assert seen(lesson.hear_person(confirmed=True)) == Observed(detected=1, missed=1, true_firings=1)


def test_a_find_without_docking_does_not_confirm_itself(lesson, look_at):
    lesson.look(look_at([1], 1))
    assert lesson.hear(state(SearchPhase.FOUND, 1)) is None
    assert seen(lesson.hear_person(confirmed=False)) == Observed(false_firings=1)


def test_a_refuted_dock_counts_at_the_end(lesson, look_at):
    lesson.look(look_at([2], 2))
    lesson.hear(state(SearchPhase.DOCKING, 2))
    lesson.look(look_at([2]))
    assert lesson.hear(state(SearchPhase.SEARCHING)) is None
    assert seen(lesson.hear(state(SearchPhase.NOT_FOUND))) == Observed(false_firings=1)


def test_a_refuted_dock_is_not_counted_twice_where_the_target_is_found_in_the_end(lesson, look_at):
    lesson.look(look_at([2], 2))
    lesson.hear(state(SearchPhase.DOCKING, 2))
    lesson.look(look_at([2]))
    lesson.hear(state(SearchPhase.SEARCHING))
    lesson.hear(state(SearchPhase.DOCKING, 4))
    lesson.look(look_at([4], 4))
    after = lesson.hear(state(SearchPhase.FOUND, 4))
    assert seen(after) == Observed(detected=1, true_firings=1, false_firings=1)


def test_the_person_has_the_last_word(lesson, look_at):
    """The dock showed it, and yet it is not it: what was learnt is taken back."""
    lesson.look(look_at([1], 1))
    lesson.hear(state(SearchPhase.DOCKING, 1))
    lesson.look(look_at([1], 1))
    confirmed = lesson.hear(state(SearchPhase.FOUND, 1))
    assert seen(confirmed).true_firings == 2
    assert lesson.hear_person(confirmed=True) is None  # known already
    assert seen(lesson.hear_person(confirmed=False)) == Observed(false_firings=2)


def test_the_next_search_goes_on_from_what_was_learnt(lesson, look_at):
    for episode in (1, 2):
        lesson.hear(state(SearchPhase.SEARCHING, episode=episode))
        lesson.look(look_at([1], 1))
        lesson.hear(state(SearchPhase.DOCKING, 1, episode))
        after = lesson.hear(state(SearchPhase.FOUND, 1, episode))
    assert seen(after) == Observed(detected=2, true_firings=2)


def test_looks_before_the_planners_first_word_count_too(candidates, look_at):
    lesson = SearchLesson("mug", BEFORE, candidates)
    lesson.look(look_at([1], 1))
    lesson.hear(SEARCHING)
    lesson.hear(state(SearchPhase.DOCKING, 1))
    assert seen(lesson.hear(state(SearchPhase.FOUND, 1))) == Observed(detected=1, true_firings=1)


def test_other_searches_and_stale_words_teach_nothing(candidates, look_at):
    lesson = SearchLesson("mug", BEFORE, candidates)
    lesson.look(look_at([1], 1))
    assert lesson.hear(state(SearchPhase.FOUND, 1)) is None  # latched, from before
    assert lesson.hear_person(confirmed=True) is None
    assert lesson.hear(replace(SEARCHING, target="book")) is None


def test_a_map_that_changes_forgets_looks_by_the_old_candidates(lesson, look_at, in_a_row):
    lesson.look(look_at([1], 1))
    lesson.move_to(in_a_row(9))
    lesson.hear(state(SearchPhase.DOCKING, 1))
    assert lesson.hear(state(SearchPhase.FOUND, 1)) is None
    assert lesson.hear_person(confirmed=False) is None
