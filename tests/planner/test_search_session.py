import itertools
import math
import threading

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import BeliefCloud, Pose2D
from robustnav_nodes.planner.ending import ending_of
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.search_session import SearchSession

CORRIDOR = ("##############", "#............#", "#o..........o#", "#............#", "##############")
START = Pose2D(x_m=1.95, y_m=0.75, yaw_rad=math.pi / 2)


@pytest.fixture
def space(space_of):
    """Two candidates, one at each end; from the middle, looking north, neither is in view."""
    return space_of(*CORRIDOR)


@pytest.fixture
def session_with(space, parameters_with):
    def make(seed: int = 0, variant: str = "pomp_be_pd", **changes: object) -> SearchSession:
        return SearchSession(
            target="mug",
            space=space,
            parameters=parameters_with(variant=variant, simulations=256, **changes),
            rng=np.random.default_rng(seed),
            clock=lambda: 0.0,
            episode=3,
        )

    return make


@pytest.fixture
def cloud_of(space):
    stamps = itertools.count(1)

    def make(*probability: float, stamp_ns: int | None = None) -> BeliefCloud:
        return BeliefCloud(
            position_m=space.candidates.position_m,
            probability=np.array(probability),
            stamp_ns=next(stamps) if stamp_ns is None else stamp_ns,
        )

    return make


def looking_at(space, candidate: int, distance_m: float) -> Pose2D:
    """A pose of the graph that faces `candidate` along x, about that far away."""
    x_m = space.candidates.x_m[candidate]
    east = x_m > 2.0
    return Pose2D(
        x_m=x_m - distance_m if east else x_m + distance_m,
        y_m=space.candidates.y_m[candidate],
        yaw_rad=0.0 if east else math.pi,
    )


def test_first_step_is_a_decision_with_every_action(session_with, cloud_of, space):
    session = session_with()
    step = session.observe(START, cloud_of(0.5, 0.5))
    decision = step.decision
    assert step.state.phase is SearchPhase.SEARCHING
    assert (step.state.step, step.state.max_steps, step.state.episode, step.state.target) == (
        1,
        200,
        3,
        "mug",
    )
    assert decision is not None
    assert decision.planner == "pomp_be_pd"
    assert decision.actions == ("forward", "backward", "turn left", "turn right")
    assert len(decision.values) == len(decision.visits) == 4
    assert sum(decision.visits) == decision.simulations == 256
    assert decision.values[decision.actions.index(decision.action)] == max(decision.values)
    assert step.goal == Pose2D(x_m=decision.goal_x_m, y_m=decision.goal_y_m, yaw_rad=decision.goal_yaw_rad)
    assert step.path[-1] == step.goal
    assert (decision.tau, decision.entropy) == (0.75, 1.0)


def test_the_lookaheads_decision_says_how_many_viewpoints_were_thought_through(session_with, cloud_of, space):
    """Each first action with the best plan that begins with it; one that none begins with has no value."""
    decision = session_with(variant="lookahead").observe(START, cloud_of(0.3, 0.7)).decision
    assert decision.planner == "lookahead"
    assert sum(decision.visits) == decision.simulations > 1
    assert decision.values[decision.actions.index(decision.action)] == np.nanmax(decision.values)
    tried = [visits > 0 for visits in decision.visits]
    assert [math.isfinite(value) for value in decision.values] == tried
    assert (decision.tau, decision.p_in_view) == (ending_of_ours(space).threshold, 0.0)
    assert "towards a view of" in decision.reason


def ending_of_ours(space):
    return ending_of(PlannerParameters(), space.candidates)


def test_ours_docks_where_the_target_is_in_view_and_was_detected(session_with, cloud_of, space):
    session = session_with(variant="lookahead")
    step = session.observe(looking_at(space, 1, 1.8), cloud_of(0.02, 0.98))
    assert step.state.phase is SearchPhase.DOCKING
    assert "in view; " in step.state.message


def test_same_seed_same_search(session_with, cloud_of, space):
    def walk(seed: int) -> list[Pose2D]:
        session, robot, goals = session_with(seed), START, []
        for _ in range(15):
            step = session.observe(robot, cloud_of(0.5, 0.5))
            robot = step.goal
            goals.append(robot)
        return goals

    assert walk(1) == walk(1)


def test_c13_the_start_pose_is_observed_too(session_with, cloud_of, space):
    """The target is in view where the search begins: it docks at once, and no step is spent on looking."""
    session = session_with()
    step = session.observe(looking_at(space, 1, 1.8), cloud_of(0.02, 0.98))
    assert step.state.phase is SearchPhase.DOCKING
    assert step.decision is not None
    assert step.decision.action == "dock"
    assert step.decision.p_in_view == pytest.approx(0.98)


def test_c13_the_start_view_rules_candidates_out(session_with, cloud_of, space):
    session = session_with()
    session.observe(looking_at(space, 1, 1.8), cloud_of(0.7, 0.3))
    assert session._search._policy._particles.not_ruled_out.tolist() == [True, False]


def test_a_likely_location_out_of_view_does_not_end_the_search(session_with, cloud_of, space):
    step = session_with().observe(looking_at(space, 0, 1.8), cloud_of(0.02, 0.98))
    assert step.state.phase is SearchPhase.SEARCHING


def drive_to_the_end(session, step, clouds, limit=60):
    steps = [step]
    while step.goal is not None and len(steps) < limit:
        step = session.observe(step.goal, clouds())
        steps.append(step)
    return steps


def test_docking_goes_to_the_destination_and_reports_where(session_with, cloud_of, space):
    session = session_with()
    first = session.observe(looking_at(space, 1, 1.8), cloud_of(0.02, 0.98))
    steps = drive_to_the_end(session, first, lambda: cloud_of(0.01, 0.99))
    assert [step.state.phase for step in steps[:-1]] == [SearchPhase.DOCKING] * (len(steps) - 1)
    assert [step.decision is not None for step in steps] == [True] + [False] * (len(steps) - 1)
    last = steps[-1]
    assert last.state.phase is SearchPhase.FOUND
    assert last.goal is None
    assert last.state.step == len(steps) - 1 == len(first.path) - 1
    assert (last.state.best_x_m, last.state.best_y_m) == (space.candidates.x_m[1], space.candidates.y_m[1])
    assert last.state.path_length_m == pytest.approx(0.9)
    end = first.path[-1]
    assert space.candidates.x_m[1] - end.x_m == pytest.approx(0.9)
    assert end.yaw_rad == 0.0


def test_at_the_dock_it_looks_again_and_goes_on_where_the_target_is_not(session_with, cloud_of, space):
    session = session_with()
    first = session.observe(looking_at(space, 1, 1.8), cloud_of(0.02, 0.98))
    last = drive_to_the_end(session, first, lambda: cloud_of(0.02, 0.98), limit=len(first.path) - 1)[-1]
    again = session.observe(last.goal, cloud_of(0.6, 0.4))
    assert again.state.phase is SearchPhase.SEARCHING
    assert again.goal is not None
    assert "looked again, not there" in again.decision.reason


def test_without_confirmation_the_dock_is_the_end(session_with, cloud_of, space):
    session = session_with(confirm_at_dock=False)
    first = session.observe(looking_at(space, 1, 1.8), cloud_of(0.02, 0.98))
    steps = drive_to_the_end(session, first, lambda: cloud_of(0.6, 0.4))
    assert steps[-1].state.phase is SearchPhase.FOUND


@pytest.mark.parametrize("variant", ["pomp", "pomp_be"])
def test_plain_variants_dock_at_the_first_detection(session_with, cloud_of, space, variant):
    robot = looking_at(space, 1, 1.8)
    assert (
        session_with(variant=variant).observe(robot, cloud_of(0.7, 0.3)).state.phase is SearchPhase.SEARCHING
    )
    assert (
        session_with(variant=variant).observe(robot, cloud_of(0.49, 0.51)).state.phase is SearchPhase.DOCKING
    )


@pytest.mark.parametrize("variant", ["pomp_pd", "pomp_be_pd"])
def test_probabilistic_variants_do_not(session_with, cloud_of, space, variant):
    session = session_with(variant=variant, tau_max=0.9)
    step = session.observe(looking_at(space, 1, 1.8), cloud_of(0.4, 0.6))
    assert step.state.phase is SearchPhase.SEARCHING


def test_a_view_that_told_nothing_new_rules_nothing_out(session_with, cloud_of, space):
    """The belief did not change, for the robot had been there before: what it has in view stays in pp."""
    session = session_with(tau_max=0.9)
    for _ in range(2):
        session.observe(looking_at(space, 1, 1.8), cloud_of(0.4, 0.6))
    assert session._search._policy._particles.not_ruled_out.tolist() == [True, True]


def test_c6_a_silent_look_from_a_new_pose_rules_out_what_is_in_view(session_with, cloud_of, space):
    """Also where the detector is so useless that its silence changes no belief."""
    session = session_with(tau_max=0.9)
    session.observe(looking_at(space, 1, 1.8), cloud_of(0.4, 0.6))
    session.observe(looking_at(space, 1, 1.5), cloud_of(0.4, 0.6))
    assert session._search._policy._particles.not_ruled_out.tolist() == [True, False]


def test_the_search_gives_up_after_its_steps(session_with, cloud_of):
    session = session_with(max_steps=4)
    step = session.observe(START, cloud_of(0.5, 0.5))
    steps = drive_to_the_end(session, step, lambda: cloud_of(0.5, 0.5))
    assert steps[-1].state.phase is SearchPhase.NOT_FOUND
    assert steps[-1].state.step == 4
    assert "not found within 4 steps" in steps[-1].state.message
    assert session.ended


def test_a_blocked_way_is_not_taken_again(session_with, cloud_of, space):
    session = session_with()
    robot = looking_at(space, 1, 1.8)
    first = session.observe(robot, cloud_of(0.02, 0.98))
    around = session.blocked(robot, cloud_of(0.02, 0.98))
    assert around.state.phase is SearchPhase.DOCKING
    assert around.goal != first.goal
    assert around.path[-1] == first.path[-1]
    ways = list(itertools.pairwise((pose.x_m, pose.y_m) for pose in around.path))
    assert ((first.path[0].x_m, first.path[0].y_m), (first.path[1].x_m, first.path[1].y_m)) not in ways


def test_closed_in_on_every_side_ends_the_search(session_with, cloud_of):
    session = session_with()
    cloud = cloud_of(0.5, 0.5)
    step = session.observe(START, cloud)
    for _ in range(12):
        if session.ended:
            break
        step = session.blocked(START, cloud)
    assert step.state.phase is SearchPhase.NOT_FOUND
    assert "closed" in step.state.message


def test_stop_ends_the_search(session_with, cloud_of):
    session = session_with()
    session.observe(START, cloud_of(0.5, 0.5))
    assert session.stop().phase is SearchPhase.STOPPED
    after = session.observe(START, cloud_of(0.5, 0.5))
    assert after.goal is None
    assert after.state.phase is SearchPhase.STOPPED
    assert session.blocked(START, cloud_of(0.5, 0.5)).goal is None


def test_stop_while_a_decision_is_made_wins(session_with, cloud_of, space, parameters_with):
    """The clock is read in the middle of a decision: somebody stops the search just then."""
    session = SearchSession(
        target="mug",
        space=space,
        parameters=parameters_with(simulations=256),
        rng=np.random.default_rng(0),
        clock=lambda: float(session.stop("enough").step),
    )
    step = session.observe(START, cloud_of(0.5, 0.5))
    assert step.goal is None
    assert (step.state.phase, step.state.message) == (SearchPhase.STOPPED, "enough")


@pytest.mark.parametrize("maps", [1, 3])
def test_a_map_that_comes_while_a_decision_is_made_is_not_lost(
    space, space_of, cloud_of, parameters_with, maps
):
    """From another thread, each time that the clock is read in the decision; the last one counts."""
    grown = space_of(*(row[:-1] + "...#" if set(row) != {"#"} else row + "###" for row in CORRIDOR))
    other = space_of("######", "#o.oo#", "#....#", "######")
    assert len(grown.graph) > len(space.graph)
    assert len(grown.candidates) == 2
    assert len(other.candidates) == 3
    coming = []

    def clock() -> float:
        while coming:
            caller = threading.Thread(target=session.move_to, args=(coming.pop(0),))
            caller.start()
            caller.join()
        return 0.0

    session = SearchSession(
        target="mug",
        space=space,
        parameters=parameters_with(simulations=64),
        rng=np.random.default_rng(0),
        clock=clock,
    )
    first = session.observe(START, cloud_of(0.5, 0.5))
    coming += [other] * (maps - 1) + [grown]
    second = session.observe(
        first.goal, cloud_of(0.5, 0.5)
    )  # decided in the old map, while the new one comes
    assert not coming
    cloud = BeliefCloud(position_m=grown.candidates.position_m, probability=np.array([0.5, 0.5]), stamp_ns=9)
    third = session.observe(second.goal, cloud)
    assert (third.state.phase, third.state.step) == (SearchPhase.SEARCHING, 3)
    assert session._search.graph is grown.graph
    assert session.observe(third.goal, cloud).state.step == 4  # and it is taken once


def test_a_map_that_comes_while_observations_are_taken_in_is_taken_at_the_next(
    session_with, space_of, cloud_of, space
):
    """Another thread says it over and over, this one observes: whichever comes last is where it goes on."""
    session, maps = session_with(variant="greedy"), [space_of(*CORRIDOR) for _ in range(2)]

    def say() -> None:
        for number in range(200):
            session.move_to(maps[number % 2])

    caller = threading.Thread(target=say)
    caller.start()
    robot = START
    for _ in range(40):
        robot = session.observe(robot, cloud_of(0.5, 0.5)).goal
    caller.join()
    session.observe(robot, cloud_of(0.5, 0.5))
    assert session._search.graph is maps[1].graph


def test_a_way_that_is_closed_stays_closed_in_a_map_that_comes_then(session_with, cloud_of, space, space_of):
    """The map comes with the step that proves to be blocked: the way is closed in it, too."""
    session = session_with(variant="lookahead")
    first = session.observe(START, cloud_of(0.3, 0.7))
    session.move_to(space_of(*CORRIDOR))
    robot, step = START, session.blocked(START, cloud_of(0.3, 0.7))
    while step.goal is not None:
        assert {robot, step.goal} != {START, first.goal}
        robot = step.goal
        step = session.observe(robot, cloud_of(0.3, 0.7))


def test_path_length_is_what_the_robot_drove(session_with, cloud_of):
    session = session_with()
    for x_m in (1.95, 2.25, 1.95):
        step = session.observe(Pose2D(x_m=x_m, y_m=0.75, yaw_rad=math.pi / 2), cloud_of(0.5, 0.5))
    assert step.state.path_length_m == pytest.approx(0.6)


def test_a_belief_about_another_place_is_refused(session_with):
    three = BeliefCloud(position_m=np.zeros((3, 3), np.float32), probability=np.full(3, 1 / 3), stamp_ns=1)
    with pytest.raises(BadMessageError, match=r"about 3 candidate locations, the planner's map has 2"):
        session_with().observe(START, three)
    elsewhere = BeliefCloud(
        position_m=np.zeros((2, 3), np.float32), probability=np.full(2, 0.5), stamp_ns=1, frame_id="odom"
    )
    with pytest.raises(BadMessageError, match=r"in frame 'odom', the planner's map in 'map'"):
        session_with().observe(START, elsewhere)
    moved = BeliefCloud(position_m=np.full((2, 3), 9, np.float32), probability=np.full(2, 0.5), stamp_ns=1)
    with pytest.raises(BadMessageError, match=r"lie up to .* m from the planner's"):
        session_with().observe(START, moved)
