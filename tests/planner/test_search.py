"""The course of a search on pose indices, by hand; for all variants alike see test_variants."""

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.planner.search import Search


@pytest.fixture
def search_in(parameters_with):
    def make(space, **changes) -> Search:
        parameters = parameters_with(**({"variant": "lookahead", "simulations": 64} | changes))
        return Search(space=space, parameters=parameters, rng=np.random.default_rng(0), clock=lambda: 0.0)

    return make


def look(search, space, pose, probability):
    return search.look(pose, space.observability.row(pose), np.array(probability))


@pytest.fixture
def space(by_hand):
    """A corridor of six poses; two places, seen from its two ends."""
    return by_hand.corridor([0], [], [], [], [1], [1])


def test_c13_what_is_in_view_at_the_start_is_found_without_a_step(search_in, space):
    search = search_in(space, dock=False)
    step = look(search, space, 0, [0.95, 0.05])
    assert (step.phase, step.location, step.path, search.steps) == (SearchPhase.FOUND, 0, (), 0)


def test_c13_the_start_is_not_looked_from_again(search_in, space):
    """Everything is at the start, and was missed from there: no other pose sees it, the rest is ahead."""
    search = search_in(space)
    step = look(search, space, 0, [0.89, 0.11])
    assert step.phase is SearchPhase.SEARCHING
    assert step.path == (0, 1)


@pytest.mark.parametrize("variant", ["greedy_gain", "lookahead"])
def test_a_detector_that_says_nothing_sends_nobody_back_and_forth(search_in, by_hand, variant):
    """With F1 at one half silence changes no belief; each pose is looked from once all the same."""
    space = by_hand.corridor([0], [0], [0, 1], [1], [1], candidates=3)
    search = search_in(space, variant=variant, p_found=0.99)
    poses, step = [0], look(search, space, 0, [0.3, 0.3, 0.4])
    while step.path:
        poses.append(step.path[1])
        step = look(search, space, poses[-1], [0.3, 0.3, 0.4])
        assert len(poses) < 20
    assert sorted(set(poses)) == [0, 1, 2, 3, 4]
    assert step.phase is SearchPhase.NOT_FOUND
    assert step.message == "not found, though looked for from everywhere"


def test_without_docking_it_ends_where_the_target_is_in_view(search_in, home):
    """Though far away: with docking there would be a way to go."""
    target, count = 0, len(home.candidates)
    start = farthest_seer(home, target)
    sure = np.where(np.arange(count) == target, 0.99, 0.01 / (count - 1))
    search = search_in(home, dock=False)
    step = look(search, home, start, sure)
    assert (step.phase, step.location, step.path, search.steps) == (SearchPhase.FOUND, target, (), 0)
    assert look(search_in(home, dock=True), home, start, sure).phase is SearchPhase.DOCKING


def test_docking_takes_the_shortest_way_and_only_its_first_step_begins_it(search_in, home):
    """The target is seen from far away: the path goes on to the destination, each step along it."""
    search, target = search_in(home, confirm_at_dock=False), 0
    sure = np.where(np.arange(len(home.candidates)) == target, 0.99, 0.01 / (len(home.candidates) - 1))
    start = farthest_seer(home, target)
    steps = [look(search, home, start, sure)]
    while steps[-1].path:
        steps.append(look(search, home, steps[-1].path[1], sure))
    first, last = steps[0], steps[-1]
    assert len(first.path) > 3
    assert [step.path for step in steps[:-1]] == [first.path[at:] for at in range(len(first.path) - 1)]
    assert [step.begins_docking for step in steps] == [True] + [False] * (len(steps) - 1)
    assert {step.phase for step in steps[:-1]} == {SearchPhase.DOCKING}
    assert (last.phase, last.location, last.sight.pose) == (SearchPhase.FOUND, target, first.path[-1])


def farthest_seer(space, target: int) -> int:
    """The pose that has `target` in view from the farthest."""
    seers = space.observability.seers_of(target)
    away = np.hypot(
        space.graph.x_m[seers] - space.candidates.x_m[target],
        space.graph.y_m[seers] - space.candidates.y_m[target],
    )
    return int(seers[np.argmax(away)])


def test_not_found_within_the_steps_says_so(search_in, space):
    search = search_in(space, max_steps=3)
    pose, phases = 1, []
    for _ in range(4):
        step = look(search, space, pose, [0.5, 0.5])
        phases.append(step.phase)
        pose = step.path[1] if step.path else pose
    assert phases == [SearchPhase.SEARCHING] * 3 + [SearchPhase.NOT_FOUND]
    assert (step.path, step.message, search.steps) == ((), "not found within 3 steps", 3)


def test_found_with_no_steps_left_to_go_there_is_not_found(search_in, home):
    """Seen with the last step, from far away: it says that it was not reached, and takes no step more."""
    search, target = search_in(home, max_steps=1), 0
    far, count = farthest_seer(home, target), len(home.candidates)
    sure = np.where(np.arange(count) == target, 0.99, 0.01 / (count - 1))
    assert look(search, home, far, np.full(count, 1.0 / count)).phase is SearchPhase.SEARCHING
    step = look(search, home, far, sure)
    assert (step.phase, step.message) == (SearchPhase.NOT_FOUND, "not reached within 1 steps")
    assert (step.path, search.steps) == ((), 1)


def test_a_closed_way_is_never_taken_again(search_in, space):
    """The way ahead is closed: it turns to what is behind, and never tries the closed way in this search."""
    search = search_in(space)
    assert look(search, space, 3, [0.4, 0.6]).path == (3, 4)
    search.close_way()
    pose, step = 3, look(search, space, 3, [0.4, 0.6])
    taken = []
    while step.path:
        taken.append(step.path[:2])
        pose = step.path[1]
        step = look(search, space, pose, [0.4, 0.6])
    assert taken == [(3, 2), (2, 1), (1, 0)]
    assert step.message == "not found, though looked for from everywhere"


def test_with_every_way_closed_it_says_so(search_in, space):
    search = search_in(space)
    for _ in range(2):
        assert look(search, space, 2, [0.5, 0.5]).phase is SearchPhase.SEARCHING
        search.close_way()
    step = look(search, space, 2, [0.5, 0.5])
    assert (step.phase, step.message) == (SearchPhase.NOT_FOUND, "every way from here is closed")


def test_closing_a_way_before_the_first_step_closes_nothing(search_in, space):
    search = search_in(space)
    search.close_way()
    assert look(search, space, 3, [0.4, 0.6]).path == (3, 4)


def test_rising_means_rising_in_view_since_the_last_look(search_in, space):
    search = search_in(space)
    assert look(search, space, 0, [0.6, 0.4]).sight.rose.tolist() == [True, False]
    assert look(search, space, 1, [0.7, 0.3]).sight.rose.tolist() == [False, False]
    assert look(search, space, 5, [0.69, 0.31]).sight.rose.tolist() == [False, True]
    again = look(search, space, 5, [0.69, 0.31])
    assert (again.sight.rose.tolist(), again.sight.is_new) == ([False, False], False)


AFAR = [[3, 4], [2, 3, 4], [], [3], [4]]  # 3 and 4 are seen together from afar, each alone from its dock
BOTH = [0.01, 0.01, 0.02, 0.50, 0.46]


def dock_to(search, space, at_dock, on_the_way=BOTH):
    """Found from afar with `BOTH`, then to the dock: the first step, and that after the look there."""
    first = look(search, space, 0, BOTH)
    assert (first.phase, first.location, first.path) == (SearchPhase.DOCKING, 3, (0, 1, 2, 3))
    for pose in (1, 2):
        step = look(search, space, pose, on_the_way)
        assert (step.phase, step.path[-1]) == (SearchPhase.DOCKING, 3)
    return look(search, space, 3, at_dock)


@pytest.mark.parametrize("variant", ["lookahead", "pomp_be_pd", "pomp"])
def test_a_dock_from_which_less_is_in_view_does_not_take_a_find_back(search_in, by_hand, variant):
    """0.96 in view from afar, 0.50 at the dock, and nothing new."""
    space = by_hand.corridor(*AFAR)
    step = dock_to(search_in(space, variant=variant), space, BOTH)
    assert (step.phase, step.location, step.path) == (SearchPhase.FOUND, 3, ())


@pytest.mark.parametrize("variant", ["lookahead", "pomp_be_pd"])
def test_what_is_seen_on_the_way_is_judged_at_the_dock(search_in, by_hand, variant):
    """It goes on though the belief falls; there it is judged."""
    space = by_hand.corridor(*AFAR)
    step = dock_to(search_in(space, variant=variant), space, [0.2] * 5, on_the_way=[0.2] * 5)
    assert step.phase is SearchPhase.SEARCHING


@pytest.mark.parametrize("variant", ["lookahead", "pomp_be_pd"])
def test_a_silent_look_at_the_dock_takes_a_find_back(search_in, by_hand, variant):
    """And with nothing new it never docks there again."""
    space = by_hand.corridor(*AFAR, [0], [1])
    parameters = {"p_found": 0.96, "tau_max": 0.46, "max_steps": 40}
    search, lower = search_in(space, variant=variant, **parameters), [0.04, 0.02, 0.04, 0.45, 0.45]
    step = dock_to(search, space, lower)
    assert step.phase is SearchPhase.SEARCHING
    assert step.message.startswith("looked again, not there")
    phases = set()
    while step.path:
        step = look(search, space, step.path[1], lower)
        phases.add(step.phase)
    assert phases == {SearchPhase.SEARCHING, SearchPhase.NOT_FOUND}


def test_what_was_rejected_is_not_rejected_again_without_news(search_in, by_hand):
    """From 1 more is in view, enough for a find: at its dock, where it has looked, nothing changes."""
    space = by_hand.corridor(*AFAR)
    search, lower = search_in(space), [0.01, 0.01, 0.08, 0.45, 0.45]
    assert dock_to(search, space, lower).phase is SearchPhase.SEARCHING
    step = look(search, space, 1, lower)
    assert (step.phase, step.location, step.begins_docking) == (SearchPhase.DOCKING, 3, True)
    while step.path:
        step = look(search, space, step.path[1], lower)
    assert (step.phase, step.location) == (SearchPhase.FOUND, 3)


def test_at_the_dock_it_may_prove_to_be_beside_it(search_in, by_hand):
    """The silent look leaves the other place of those that were in view: it docks on to that one."""
    space = by_hand.corridor(*AFAR)
    search, beside = search_in(space, variant="pomp_be_pd"), [0.01, 0.01, 0.02, 0.10, 0.86]
    step = dock_to(search, space, beside)
    assert (step.phase, step.location, step.path) == (SearchPhase.DOCKING, 4, (3, 4))
    assert step.begins_docking
    assert look(search, space, 4, beside).phase is SearchPhase.FOUND


def test_a_first_detection_is_not_taken_back(search_in, by_hand):
    """It ends the search, as the thesis has it; what is not seen at the dock changes nothing."""
    space = by_hand.corridor(*AFAR)
    step = dock_to(search_in(space, variant="pomp"), space, [0.3, 0.3, 0.3, 0.05, 0.05])
    assert (step.phase, step.location) == (SearchPhase.FOUND, 3)


def test_with_the_way_back_closed_what_is_ahead_is_looked_at_also_on_a_new_map(search_in, by_hand):
    """Where the search began cannot be reached any more: that makes nothing ahead worthless."""
    space = by_hand.corridor([0], [], [], [1], [2])
    search = search_in(space)
    assert look(search, space, 1, [0.1, 0.5, 0.4]).path == (1, 2)
    assert look(search, space, 2, [0.8, 0.1, 0.1]).path == (2, 1)
    search.close_way()
    search.move_to(space)
    step = look(search, space, 2, [0.8, 0.1, 0.1])
    assert (step.phase, step.path) == (SearchPhase.SEARCHING, (2, 3))


WALLED = ("##############", "#o...#...#...#", "#....#...#oo.#", "#....#...#...#", "##############")


def test_a_target_in_a_room_without_a_door_is_not_looked_for_through_the_wall(search_in, space_of):
    """All free floor is in the graph, what is behind the wall cannot be reached: it says so, and at once."""
    space = space_of(*WALLED)
    start = space.graph.nearest(Pose2D(x_m=2.25, y_m=0.75))
    assert not space.observability.row(start).any()
    step = look(search_in(space), space, start, np.full(3, 1.0 / 3.0))
    assert step.phase is SearchPhase.NOT_FOUND
    assert step.message == "not found, though looked for from everywhere"


def test_a_robot_that_is_shown_inside_a_wall_starts_at_the_nearest_pose(search_in, space_of):
    space = space_of(*WALLED)
    pose = space.graph.nearest(Pose2D(x_m=1.60, y_m=0.75, yaw_rad=np.pi))
    assert (space.graph.x_m[pose], space.graph.y_m[pose]) == pytest.approx((1.35, 0.75))
    step = look(search_in(space), space, pose, np.full(3, 1.0 / 3.0))
    assert step.path[1] in space.graph.successors[pose]


@pytest.mark.parametrize(
    ("rows", "words"),
    [
        (("####", "#..#", "####"), "no cell above 50"),
        (("oooo", "oooo"), "free"),
        (("########", "#...##o#", "########"), "none of the 1 candidate"),
    ],
    ids=["no candidates", "no free floor", "nothing in view of anything"],
)
def test_a_place_that_cannot_be_searched_is_refused_with_a_sentence(space_of, rows, words):
    with pytest.raises(BadMapError, match=words):
        space_of(*rows)


def test_greedy_goes_on_where_only_the_view_from_here_is_left_to_it(search_in, by_hand):
    """A false alarm keeps the first place worth a look; back at the only pose that sees it, it goes on."""
    space = by_hand.corridor([0], [1], [2], candidates=30)
    search = search_in(space, variant="greedy", max_steps=12, tau_max=0.9)
    alarm = np.append([0.1], np.full(29, 0.9 / 29))
    poses, step = [0], look(search, space, 0, alarm)
    assert step.sight.rose[0]
    probability = alarm
    while step.path:
        poses.append(step.path[1])
        if poses[-1] not in poses[:-1]:  # a silent look; a second one from there changes nothing
            probability = np.where(space.observability.row(poses[-1]), 0.5 * probability, probability)
            probability = probability / probability.sum()
        step = look(search, space, poses[-1], probability)
    assert (step.message, search.steps) == ("not found within 12 steps", 12)
