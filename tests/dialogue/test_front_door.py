"""The front door decides what is searched for, answers from records, and never forgets its manners."""

import math
from dataclasses import replace

import pytest

from robustnav_msgs_py.parameters import build
from robustnav_msgs_py.records import Decision, SearchPhase, SearchState
from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.dialogue.explanations import describe_place, explain
from robustnav_nodes.dialogue.front_door import FrontDoor
from robustnav_nodes.dialogue.parameters import DialogueParameters

DECISION = Decision(
    episode=1, step=4, planner="pomp_be_pd", action="turn left", actions=("forward", "turn left"),
    values=(120.0, 250.4), visits=(300, 724), simulations=1024, elapsed_ms=9.0, p_in_view=0.01, tau=0.04,
    entropy=0.9, x_m=0.0, y_m=0.0, yaw_rad=0.0, goal_x_m=0.0, goal_y_m=0.0, goal_yaw_rad=0.5,
)  # fmt: skip
SEARCHING = SearchState(
    phase=SearchPhase.SEARCHING, target="mug", episode=1, step=4, p_best=0.02, best_x_m=1.0, best_y_m=2.0
)


@pytest.fixture
def door() -> FrontDoor:
    made = FrontDoor(build(DialogueParameters, {}))
    made.hear_names(("mug", "book"))
    return made


def test_find_sets_the_target_and_stop_clears_it(door: FrontDoor) -> None:
    reaction = door.hear("find the blue mug", None)
    assert (reaction.target, reaction.answer) == ("mug", "I am looking for the mug.")
    assert door.state.target == "mug"
    assert door.hear("stop", None).target == ""
    assert door.state.target == ""


def test_a_class_that_the_detector_does_not_know_changes_nothing(door: FrontDoor) -> None:
    door.hear("find the mug", None)
    reaction = door.hear("find the unicorn", None)
    assert reaction.target is None
    assert "'unicorn'" in reaction.answer
    assert "book, mug" in reaction.answer
    assert door.state.target == "mug"


def test_before_the_detector_has_started(door: FrontDoor) -> None:
    reaction = FrontDoor(build(DialogueParameters, {})).hear("find the mug", None)
    assert reaction.target is None
    assert "not started" in reaction.answer


def test_asking_again_does_not_begin_again(door: FrontDoor) -> None:
    door.hear("find the mug", None)
    door.hear_search(SEARCHING)
    reaction = door.hear("find the mug", None)
    assert reaction.target is None
    assert reaction.answer == "I am still looking for the mug."
    assert door.hear("find the book", None).target == "book"


def test_a_bare_name_is_enough(door: FrontDoor) -> None:
    assert door.hear("the mug", None).target == "mug"


@pytest.mark.parametrize("line", ["", "x" * 1_000_000, "\x00\x01", "找到杯子", "🦄"])
def test_a_line_that_cannot_be_read_is_answered_shortly(door: FrontDoor, line: str) -> None:
    reaction = door.hear(line, None)
    assert reaction.target is None
    assert 0 < len(reaction.answer) < 300
    assert len(door.state.last_heard) <= 120


def test_the_end_of_the_search_is_told_once(door: FrontDoor) -> None:
    door.hear("find the mug", None)
    found = SearchState(phase=SearchPhase.FOUND, target="mug", episode=1, step=9, path_length_m=3.0)
    assert door.hear_search(SEARCHING) is None
    news = door.hear_search(found)
    assert news is not None
    assert news.answer.startswith("I found the mug")
    assert news.target == ""  # latched, it would send a planner that starts later out again
    assert door.hear_search(found) is None


def test_a_search_for_something_else_is_not_reported(door: FrontDoor) -> None:
    door.hear("find the book", None)
    assert door.hear_search(SearchState(phase=SearchPhase.FOUND, target="mug", episode=1)) is None


def test_a_dialogue_that_was_started_again_takes_the_search_over(door: FrontDoor) -> None:
    taken = door.hear_search(SEARCHING)
    assert taken is not None
    assert (taken.answer, taken.target) == ("", "mug")
    found = door.hear_search(SearchState(phase=SearchPhase.FOUND, target="mug", episode=1))
    assert found is not None
    assert found.answer.startswith("I found")


def test_a_late_word_of_the_search_does_not_undo_stop(door: FrontDoor) -> None:
    door.hear("find the mug", None)
    door.hear("stop", None)
    assert door.hear_search(SEARCHING) is None  # it began before the planner heard of the stop
    assert door.hear_search(replace(SEARCHING, step=5)) is None
    assert door.state.target == ""


def test_a_search_that_a_service_began_is_taken_over(door: FrontDoor) -> None:
    door.hear("find the mug", None)
    door.hear_search(SEARCHING)
    door.hear_search(SearchState(phase=SearchPhase.FOUND, target="mug", episode=1))
    taken = door.hear_search(replace(SEARCHING, episode=2))
    assert taken is not None
    assert taken.target == "mug"


def test_a_search_that_a_service_stopped_is_told(door: FrontDoor) -> None:
    door.hear("find the mug", None)
    door.hear_search(SEARCHING)
    stopped = SearchState(
        phase=SearchPhase.STOPPED, target="mug", episode=1, message="stopped by a service call"
    )
    news = door.hear_search(stopped)
    assert news is not None
    assert (news.answer, news.target) == ("I stopped looking for the mug: stopped by a service call.", "")


def test_why_is_answered_from_the_decision(door: FrontDoor) -> None:
    door.hear("find the mug", None)
    door.hear_search(SEARCHING)
    door.hear_decision(DECISION)
    answer = door.hear("why?", None).answer
    assert "turn left" in answer
    assert "250" in answer
    assert "forward 120" in answer
    assert "1024" in answer


def test_why_in_every_phase_is_a_sentence() -> None:
    for phase in SearchPhase:
        state = SearchState(phase=phase, target="mug", episode=1, message="over")
        for decision in (None, DECISION):
            assert explain(state, decision).endswith(".")
    assert "not looking for anything" in explain(SearchState(), None)


@pytest.mark.parametrize(
    ("yaw", "word"), [(0.0, "east"), (math.pi / 2, "north"), (-math.pi, "west"), (-1.6, "south")]
)
def test_where_are_you(yaw: float, word: str) -> None:
    assert describe_place(Pose2D(x_m=1.0, y_m=2.0, yaw_rad=yaw)).endswith(f"facing {word}.")
    assert "odometry" in describe_place(None)


def found(door: FrontDoor) -> None:
    door.hear("find the mug", None)
    door.hear_search(SEARCHING)
    door.hear_search(replace(SEARCHING, phase=SearchPhase.FOUND))


@pytest.mark.parametrize(
    ("line", "is_right"),
    [("thank you", True), ("yes, that's it", True), ("no, that is not it", False), ("wrong one", False)],
)
def test_what_the_person_says_of_a_find_counts_once(door: FrontDoor, line: str, is_right: bool) -> None:
    found(door)
    reaction = door.hear(line, None)
    assert (reaction.found, reaction.is_right) == ("mug", is_right)
    assert reaction.answer
    assert reaction.target is None
    assert door.hear(line, None).is_right is None


def test_thanks_for_nothing_say_nothing_of_the_detector(door: FrontDoor) -> None:
    assert door.hear("thank you", None).is_right is None
    found(door)
    door.hear("find the book", None)
    assert door.hear("no", None).is_right is None
