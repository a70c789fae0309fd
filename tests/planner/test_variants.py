"""What holds for every planner: it repeats itself, keeps to open ways, and ends honestly."""

import itertools

import numpy as np
import pytest

from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.belief.evidence import F1Evidence, LikelihoodEvidence
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.belief.observation import place_densities
from robustnav_nodes.planner.parameters import VARIANTS
from robustnav_nodes.planner.search import Search
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action

every_variant = pytest.mark.parametrize("variant", VARIANTS)
RECALL, FALSE_ALARMS = 0.6, 0.05


def evidence_for(variant: str):
    """The thesis' planners go with the thesis' evidence."""
    if variant.startswith("pomp_b") or variant in ("pomp", "pomp_pd"):
        return F1Evidence(f1=0.69, detection_floor=0.02)
    return LikelihoodEvidence(recall=RECALL, false_alarms=FALSE_ALARMS)


@pytest.fixture
def quick(parameters_with):
    """Parameters of a variant with little to think about."""

    def make(variant: str, **changes):
        little = {"simulations": 32, "goals": 3, "lookahead_steps": 25}
        return parameters_with(variant=variant, **(little | changes))

    return make


class Robot:
    """A search in `space` with a detector that sees `target`, if it is anywhere, and is sometimes wrong.

    What it says from a pose it says again. Each way on is found closed with `p_closed`.
    """

    def __init__(self, space, parameters, *, target=None, false_alarms=FALSE_ALARMS, p_closed=0.0, seed=0):
        self.space, self.target, self.false_alarms = space, target, false_alarms
        self.p_closed, self.chance = p_closed, np.random.default_rng([seed, 2])
        self.seed, self.evidence = seed, evidence_for(parameters.variant)
        rng = np.random.default_rng([seed, 1])
        self.search = Search(space=space, parameters=parameters, rng=rng, clock=lambda: 0.0)
        self.belief = LocationBelief.uniform(space.candidates)
        self.poses, self.closed, self.looked = [], [], set()

    def detections(self, pose, in_view):
        rng = np.random.default_rng([self.seed, 3, pose])
        candidates, found = self.space.candidates, []
        if self.target is not None and in_view[self.target] and rng.random() < RECALL:
            found.append((candidates.x_m[self.target], candidates.y_m[self.target]))
        if in_view.any() and rng.random() < self.false_alarms:
            elsewhere = rng.choice(np.nonzero(in_view)[0])
            found.append((candidates.x_m[elsewhere], candidates.y_m[elsewhere]))
        return place_densities(candidates, in_view, np.array(found).reshape(-1, 2), 0.5)

    def look(self, pose):
        in_view = self.space.observability.row(pose)
        if pose not in self.looked:
            self.looked.add(pose)
            factor = self.evidence.factor(in_view, self.detections(pose, in_view))
            self.belief = self.belief.updated(factor, 1e-6)
        return self.search.look(pose, in_view, self.belief.probability)

    def run(self, start):
        """To the end; gives the last step."""
        self.poses = [start]
        step = self.look(start)
        while step.path:
            if self.chance.random() < self.p_closed:
                self.search.close_way()
                self.closed.append(step.path[:2])
            else:
                self.poses.append(step.path[1])
            step = self.look(self.poses[-1])
        return step


@every_variant
def test_same_seed_same_search(home, quick, variant):
    runs = []
    for _ in range(2):
        robot = Robot(home, quick(variant, simulations=64, max_steps=40), target=3, seed=4)
        end = robot.run(start=700)
        runs.append((end.phase, end.location, robot.poses, robot.belief.probability.tolist()))
    assert runs[0] == runs[1]
    assert len(runs[0][2]) > 3


def test_another_seed_may_decide_otherwise(home, quick):
    """So that the test above says something about a planner that draws."""
    courses = []
    for seed in (1, 2):
        robot = Robot(home, quick("pomp_be_pd", simulations=64, max_steps=20), seed=seed)
        robot.evidence = evidence_for("random")
        robot.false_alarms = 0.0
        robot.run(start=700)
        courses.append(robot.poses)
    assert courses[0] != courses[1]


@every_variant
@pytest.mark.parametrize("seed", [0, 1])
def test_only_open_ways_are_taken_also_where_some_turn_out_closed(home, quick, variant, seed):
    parameters = quick(variant, max_steps=60)
    robot = Robot(home, parameters, target=seed * 7, p_closed=0.2, seed=seed)
    end = robot.run(start=300)
    assert end.phase in (SearchPhase.FOUND, SearchPhase.NOT_FOUND)
    graph = home.graph
    for a, b in itertools.pairwise(robot.poses):
        assert a == b or b in graph.successors[a]
    assert len(robot.closed) > 0
    assert len(robot.closed) == len({*robot.closed})  # none is tried again
    for a, b in robot.closed:
        assert b in graph.successors[a]
    assert robot.search.steps == len(robot.poses) - 1 + len(robot.closed) <= 60


@every_variant
def test_a_target_that_is_nowhere_is_not_found(home, quick, variant):
    """And it says so, in time; the detector, too, is silent."""
    for start in (0, 500):
        robot = Robot(home, quick(variant), false_alarms=0.0)
        end = robot.run(start)
        assert end.phase is SearchPhase.NOT_FOUND
        assert "not found" in end.message
        assert robot.search.steps == len(robot.poses) - 1 <= 200


@every_variant
def test_a_target_behind_walls_is_not_found(space_of, quick, variant):
    """The robot's room has a table with nothing on it; the target is in another, without a door."""
    space = space_of(
        "##################",
        "#o......#........#",
        "#oo.....#......oo#",
        "#.......#......oo#",
        "#.......#........#",
        "#.....oo#........#",
        "##################",
    )
    start = space.graph.nearest(Pose2D(x_m=1.2, y_m=1.0))
    behind = int(np.argmax(space.candidates.x_m))
    assert np.isinf(space.graph.steps_from(start)[space.observability.seers_of(behind)]).all()
    parameters = quick(variant, max_steps=50)
    robot = Robot(space, parameters, target=behind, false_alarms=0.0)
    end = robot.run(start)
    assert end.phase is SearchPhase.NOT_FOUND
    assert "not found" in end.message
    assert robot.search.steps <= 50


@every_variant
def test_one_pose_with_no_way_out_ends_at_once(by_hand, quick, variant):
    space = by_hand.corridor([], candidates=3)
    end = Robot(space, quick(variant)).run(0)
    assert (end.phase, end.message) == (SearchPhase.NOT_FOUND, "every way from here is closed")


@every_variant
def test_a_place_with_two_poses_is_searched(by_hand, quick, variant):
    """There and back again, as often as the variant likes, and to an end."""
    space = by_hand.corridor([0], [1], candidates=30)
    robot = Robot(space, quick(variant, max_steps=6), false_alarms=0.0)
    end = robot.run(0)
    assert end.phase is SearchPhase.NOT_FOUND
    assert set(robot.poses) == {0, 1}


@pytest.mark.parametrize("variant", [variant for variant in VARIANTS if variant not in ("pomp", "pomp_be")])
def test_a_single_place_need_only_be_in_view(by_hand, quick, variant):
    """Where there is one candidate the target is there; those that wait for a detection learn of none."""
    space = by_hand.corridor([], [], [0])
    robot = Robot(space, quick(variant), target=0)
    end = robot.run(0)
    assert (end.phase, end.location) == (SearchPhase.FOUND, 0)


@every_variant
def test_it_decides_where_only_one_action_is_legal(by_hand, quick, variant):
    """A ring of one-way turns: always on, to where the target is."""
    turns = [[NOWHERE, NOWHERE, (pose + 1) % 6, NOWHERE] for pose in range(6)]
    space = by_hand.table(turns, [[], [0, 1], [2, 3], [4, 5], [6, 7], [8, 9, 10, 11]])
    robot = Robot(space, quick(variant, max_steps=30, dock=False), target=9)
    step = robot.look(0)
    assert step.choice.action == Action.TURN_LEFT
    assert step.path == (0, 1)
