"""A search goes on when the map grows under it."""

import numpy as np
import pytest

from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import BeliefCloud, Pose2D
from robustnav_nodes.belief.evidence import F1Evidence, LikelihoodEvidence
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.planner.search import Search
from robustnav_nodes.planner.search_session import SearchSession

CELL_M = 0.3
HALF = ("##########", "#o.......#", "#o.......#", "##########")
WHOLE = ("####################", "#o................o#", "#o.................#", "####################")
HALF_ENDS_M = CELL_M * len(HALF[0])
START = Pose2D(x_m=1.5, y_m=0.75, yaw_rad=np.pi)


def cloud_on(space, *probability: float) -> BeliefCloud:
    return BeliefCloud(position_m=space.candidates.position_m, probability=np.array(probability), stamp_ns=1)


@pytest.mark.parametrize("variant", ["lookahead", "greedy", "pomp_be_pd"])
def test_steps_and_where_the_robot_has_been_are_kept(space_of, parameters_with, variant):
    half, whole = space_of(*HALF), space_of(*WHOLE)
    assert (len(half.candidates), len(whole.candidates)) == (2, 3)
    assert len(whole.graph) > len(half.graph)
    session = SearchSession(
        target="mug",
        space=half,
        parameters=parameters_with(variant=variant, simulations=64),
        rng=np.random.default_rng(0),
    )
    robot = START
    for _ in range(3):
        step = session.observe(robot, cloud_on(half, 0.5, 0.5))
        assert step.goal is not None
        robot = step.goal
    session.move_to(whole)
    step = session.observe(robot, cloud_on(whole, 0.15, 0.15, 0.7))
    assert step.state.phase is SearchPhase.SEARCHING
    assert step.state.step == 4
    assert step.state.path_length_m > 0.0
    while step.goal is not None and step.goal.x_m < HALF_ENDS_M:
        robot = step.goal
        step = session.observe(robot, cloud_on(whole, 0.15, 0.15, 0.7))
    assert step.goal is not None, "it never went to the part that is new"


F1 = F1Evidence(f1=0.69, detection_floor=0.02)
LIKELIHOOD = LikelihoodEvidence(recall=0.6, false_alarms=0.05)


@pytest.mark.parametrize(
    ("variant", "evidence"),
    [
        ("pomp", F1),
        ("pomp_be", F1),
        ("pomp_guided", LIKELIHOOD),
        ("greedy_gain", F1),
        ("lookahead", LIKELIHOOD),
    ],
)
@pytest.mark.parametrize("maps", [(HALF, WHOLE), (WHOLE, HALF), (HALF, WHOLE, HALF, WHOLE)])
def test_a_detector_that_is_silent_finds_nothing_in_a_map_that_changes(
    space_of, parameters_with, variant, evidence, maps
):
    """The belief about a place rises where others go: that is no detection."""
    spaces = [space_of(*rows) for rows in maps]
    parameters = parameters_with(variant=variant, simulations=64, max_steps=40, goals=5, p_found=0.9)
    search = Search(space=spaces[0], parameters=parameters, rng=np.random.default_rng(0), clock=lambda: 0.0)
    belief, looked = LocationBelief.uniform(spaces[0].candidates), set()
    graph = spaces[0].graph
    pose, steps = graph.nearest(START), 0
    for number, space in enumerate(spaces):
        if number > 0:
            search.move_to(space)
            belief, looked = belief.carried_to(space.candidates), set()
            pose, graph = space.graph.nearest(graph.pose(pose)), space.graph
        for _ in range(6 if number < len(spaces) - 1 else 40):
            in_view = space.observability.row(pose)
            if pose not in looked:
                looked.add(pose)
                nothing = np.zeros((0, len(in_view)))
                belief = belief.updated(evidence.factor(in_view, nothing), 1e-6)
            step = search.look(pose, in_view, belief.probability)
            assert step.phase in (SearchPhase.SEARCHING, SearchPhase.NOT_FOUND)
            assert not step.sight.rose.any()
            if not step.path:
                break
            pose, steps = step.path[1], steps + 1
            assert search.steps == steps
    assert step.phase is SearchPhase.NOT_FOUND


@pytest.mark.parametrize("variant", ["random", "greedy", "greedy_gain", "pomp_be_pd", "lookahead"])
def test_ways_that_proved_closed_stay_closed_as_the_map_grows(space_of, parameters_with, variant):
    """By where they are: the poses have other numbers in the new map."""
    half, whole = space_of(*HALF), space_of(*WHOLE)
    parameters = parameters_with(variant=variant, simulations=64, max_steps=60, ending="view", p_found=0.9999)
    search = Search(space=half, parameters=parameters, rng=np.random.default_rng(0), clock=lambda: 0.0)
    robot, closed = START, set()
    for space in (half, whole, whole):
        if space is whole:
            search.move_to(whole)
        count = len(space.candidates)
        for turn in range(12):
            pose = space.graph.nearest(robot)
            step = search.look(pose, space.observability.row(pose), np.full(count, 1.0 / count))
            if not step.path:
                break
            goal = space.graph.pose(step.path[1])
            assert frozenset((robot, goal)) not in closed
            is_drive = (robot.x_m, robot.y_m) != (goal.x_m, goal.y_m)
            if turn % 4 == 1 and is_drive and len(closed) < 4:
                search.close_way()
                closed.add(frozenset((robot, goal)))
            else:
                robot = goal
    assert closed


def test_the_look_after_a_map_was_taken_says_where_the_belief_stands(space_of, parameters_with):
    """What had risen must rise once more: with the next look nothing has, with the one after it may."""
    half, whole = space_of(*HALF), space_of(*WHOLE)
    search = Search(
        space=half, parameters=parameters_with(dock=False), rng=np.random.default_rng(0), clock=lambda: 0.0
    )
    pose, west = half.graph.nearest(START), np.ones(2, dtype=bool)
    assert search.look(pose, west, np.array([0.6, 0.4])).sight.rose.tolist() == [True, False]
    search.move_to(whole)
    pose, all_of_it = whole.graph.nearest(START), np.ones(3, dtype=bool)
    step = search.look(pose, all_of_it, np.array([0.9, 0.05, 0.05]))
    assert (step.phase, step.sight.rose.any(), step.sight.is_new) == (SearchPhase.SEARCHING, False, True)
    assert search.look(pose, all_of_it, np.array([0.92, 0.04, 0.04])).phase is SearchPhase.FOUND


def test_the_first_look_in_a_map_counts_also_from_a_pose_of_the_same_number(space_of, parameters_with):
    """The policy is a new one, which was told of no look."""
    half = space_of(*HALF)
    search = Search(space=half, parameters=parameters_with(), rng=np.random.default_rng(0), clock=lambda: 0.0)
    pose, belief = half.graph.nearest(START), np.array([0.6, 0.4])
    news = [search.look(pose, half.observability.row(pose), belief).sight.is_new for _ in range(2)]
    search.move_to(half)
    news += [search.look(pose, half.observability.row(pose), belief).sight.is_new for _ in range(2)]
    assert news == [True, False, True, False]
