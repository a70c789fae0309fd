import numpy as np
import pytest

from robustnav_nodes.planner.baselines import Greedy, GreedyGain, RandomWalk
from robustnav_nodes.planner.policy import Sight
from robustnav_nodes.search_space.pose_graph import Action

RNG = np.random.default_rng(0)  # for policies that draw nothing


def look_at(space, pose: int, rose=()) -> Sight:
    """A look from `pose`; the detector fires at the candidates of `rose`."""
    count = len(space.candidates)
    return Sight(
        pose=pose,
        probability=np.full(count, 1.0 / count),
        in_view=space.observability.row(pose),
        rose=np.isin(np.arange(count), rose),
        is_new=True,
    )


def test_a_random_walk_takes_all_legal_actions_alike(by_hand, situation):
    space = by_hand.table([[1, -1, 1, 1], [-1, 0, -1, -1]], [[], []], candidates=1)
    rng = np.random.default_rng(0)
    here = situation(space, 0, [1.0])
    count = np.bincount([RandomWalk().decide(here, rng).action for _ in range(9000)], minlength=4)
    assert count[Action.BACKWARD] == 0
    np.testing.assert_allclose(count[[0, 2, 3]], 3000, rtol=0.07)
    assert RandomWalk().decide(situation(space, 1, [1.0]), rng).action == Action.BACKWARD


def test_greedy_counts_what_is_unseen_whatever_is_believed(by_hand, situation):
    """Two places one step back, three two steps ahead: 2 against 1.5 a step."""
    space = by_hand.corridor([0, 1], [], [], [2, 3, 4])
    here = situation(space, 1, [0.01, 0.01, 0.9, 0.04, 0.04])
    assert Greedy(space).decide(here, RNG).action == Action.BACKWARD
    assert GreedyGain(space).decide(here, RNG).action == Action.FORWARD


def test_greedy_does_not_go_for_what_it_has_seen(by_hand, situation):
    space = by_hand.corridor([0, 1], [0], [], [2])
    policy = Greedy(space)
    policy.looked(look_at(space, 0))
    assert policy.decide(situation(space, 1, [0.4, 0.4, 0.2]), RNG).action == Action.FORWARD


@pytest.mark.parametrize(("rose", "action"), [([1], Action.BACKWARD), ([], Action.FORWARD)])
def test_greedy_looks_again_where_the_detector_fired(by_hand, situation, rose, action):
    """From elsewhere: the second pose sees it, too."""
    space = by_hand.corridor([0, 1], [1], [], [], [2])
    policy = Greedy(space)
    policy.looked(look_at(space, 0, rose))
    assert policy.decide(situation(space, 2, [0.4, 0.4, 0.2]), RNG).action == action


def test_greedy_does_not_go_again_to_where_it_has_been_in_this_tour(by_hand, situation):
    """The false alarm is seen from nowhere else: it is no reason to go back, until all else was seen."""
    space = by_hand.corridor([0, 1], [], [], [2])
    policy = Greedy(space)
    policy.looked(look_at(space, 0, rose=[1]))
    assert policy.decide(situation(space, 1, [0.4, 0.4, 0.2]), RNG).action == Action.FORWARD
    policy.looked(look_at(space, 3))
    assert policy.decide(situation(space, 3, [0.4, 0.4, 0.2]), RNG).action == Action.BACKWARD


def test_greedy_begins_again_when_everything_was_seen(by_hand, situation):
    space = by_hand.corridor([0, 1], [], [2])
    policy = Greedy(space)
    for pose in (0, 2):
        policy.looked(look_at(space, pose))
    assert policy.decide(situation(space, 1, [0.1, 0.1, 0.8]), RNG).action == Action.BACKWARD


def test_greedy_gain_goes_for_the_most_belief_a_step_by_hand(by_hand, situation):
    """0.3 one step back, 0.7 two or three steps ahead: 0.3 against 0.35 and 0.233."""
    for ahead, action in ((2, Action.FORWARD), (3, Action.BACKWARD)):
        space = by_hand.corridor([0], *[[]] * ahead, [1])
        assert GreedyGain(space).decide(situation(space, 1, [0.3, 0.7]), RNG).action == action


def test_greedy_gain_looks_from_each_pose_once(by_hand, situation):
    space = by_hand.corridor([0], [0], [0])
    policy = GreedyGain(space)
    assert policy.decide(situation(space, 1, [1.0], looked=[2]), RNG).action == Action.BACKWARD
    assert policy.decide(situation(space, 1, [1.0], looked=[0, 2]), RNG) is None


@pytest.mark.parametrize("maker", [Greedy, GreedyGain])
def test_a_closed_way_is_not_taken(by_hand, situation, maker):
    """The best is ahead; where the way there is closed, the second best is gone for, or nothing."""
    space = by_hand.corridor([0], [], [1, 2])
    here = situation(space, 1, [0.2, 0.4, 0.4])
    assert maker(space).decide(here, RNG).action == Action.FORWARD
    for closed, expected in (((1, 2), Action.BACKWARD), ((0, 1), Action.FORWARD)):
        half = situation(space, 1, [0.2, 0.4, 0.4], graph=space.graph.without_way(*closed))
        assert maker(space).decide(half, RNG).action == expected
    shut = space.graph.without_way(1, 2).without_way(0, 1)
    assert maker(space).decide(situation(space, 1, [0.2, 0.4, 0.4], graph=shut), RNG) is None
