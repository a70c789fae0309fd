import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_nodes.planner.baselines import GreedyGain
from robustnav_nodes.planner.lookahead import Lookahead
from robustnav_nodes.search_space.pose_graph import Action

SEED = st.integers(0, 2**32 - 1)
WORTH = st.sampled_from(["ratio", "discount"])
RNG = np.random.default_rng(0)  # this planner draws nothing


def believed(space, seed: int):
    weight = np.random.default_rng(seed).random(len(space.candidates)) + 1e-6
    return weight / weight.sum()


def greedy_worth(plain_worth, space, parameters, situation) -> float:
    """What going from best viewpoint to best is worth from here on, worked out in plain words."""
    here, looked = situation.pose, np.nonzero(situation.visited)[0].tolist()
    steps = space.graph.steps_from(here)
    ahead = np.arange(parameters.lookahead_steps + 1)
    if parameters.worth == "discount":
        weight, worth = np.ones(len(space.candidates)), parameters.discount**ahead
    else:
        first = [
            steps[space.observability.seers_of(j)].min(initial=np.inf) for j in range(len(space.candidates))
        ]
        weight = np.where(np.isfinite(first), np.maximum(first, 1.0), 0.0)
        worth = 1.0 / np.maximum(situation.step + ahead, 1.0)
    mass = situation.sight.probability * weight
    return plain_worth(space, mass, looked, here, [], parameters.recall, worth)


@given(
    seed=SEED,
    start=st.integers(0, 99),
    worth=WORTH,
    recall=st.floats(0.1, 1.0),
    goals=st.sampled_from([1, 3, 20]),
)
@settings(deadline=None)
def test_the_plan_is_never_worth_less_than_the_greedy_rules(
    by_hand, parameters_with, plain_worth, situation, seed, start, worth, recall, goals
):
    """Valued the same way, by other code; with one viewpoint to think through it is the greedy rule's."""
    space = by_hand.maze(seed)
    parameters = parameters_with(worth=worth, recall=recall, goals=goals, lookahead_steps=12)
    policy = Lookahead(space, parameters, clock=lambda: 0.0)
    here = situation(space, start % len(space.graph), believed(space, seed))
    choice, greedy = policy.decide(here, RNG), greedy_worth(plain_worth, space, parameters, here)
    if choice is None:
        assert greedy == 0.0
        return
    best = np.nanmax(choice.values)
    assert best == choice.values[choice.action]
    assert best >= greedy * (1.0 - 1e-6)
    if goals == 1:
        assert best == pytest.approx(greedy, rel=1e-6)


@given(seed=SEED, worth=WORTH)
@settings(deadline=None, max_examples=50)
def test_same_history_same_decisions_and_only_legal_ones(by_hand, parameters_with, situation, seed, worth):
    space = by_hand.maze(seed)

    def course() -> list[int]:
        policy = Lookahead(space, parameters_with(worth=worth), clock=lambda: 0.0)
        poses = [0]
        while len(poses) < 30:
            here = situation(
                space, poses[-1], believed(space, seed), looked=poses, step=len(poses) - 1, start=0
            )
            choice = policy.decide(here, RNG)
            if choice is None:
                break
            poses.append(int(space.graph.successors[poses[-1], choice.action]))
            assert poses[-1] >= 0
        return poses

    assert course() == course()


def test_it_sees_farther_than_the_greedy_rule_by_hand(by_hand, parameters_with, situation):
    """0.2 one step ahead, 0.39 two steps and 0.41 three steps back: the one ahead has the most per step.

    0.9 ^ steps: ahead first 0.2 x 0.9 + 0.39 x 0.9^4 + 0.41 x 0.9^5, back first 0.39 x 0.9^2 + 0.41 x 0.9^3
    + 0.2 x 0.9^7, which is more.
    """
    space = by_hand.corridor([2], [1], [], [], [0])
    here = situation(space, 3, [0.2, 0.39, 0.41])
    parameters = parameters_with(worth="discount", discount=0.9, recall=1.0)
    choice = Lookahead(space, parameters).decide(here, RNG)
    ahead, back = 0.2 * 0.9 + 0.39 * 0.9**4 + 0.41 * 0.9**5, 0.39 * 0.9**2 + 0.41 * 0.9**3 + 0.2 * 0.9**7
    assert choice.action == Action.BACKWARD
    np.testing.assert_allclose(choice.values, [ahead, back, np.nan, np.nan])
    assert GreedyGain(space).decide(here, RNG).action == Action.FORWARD


@pytest.mark.parametrize("worth", ["ratio", "discount"])
def test_the_reason_says_how_much_belief_is_in_view_there(by_hand, parameters_with, situation, worth):
    """0.3 + 0.4, whatever a find is worth."""
    space = by_hand.corridor([], [], [], [0, 1], candidates=3)
    choice = Lookahead(space, parameters_with(worth=worth)).decide(situation(space, 0, [0.3, 0.4, 0.3]), RNG)
    assert choice.reason == "towards a view of 70.0% of the belief"


def test_what_is_far_anyway_may_be_found_late(by_hand, parameters_with, situation):
    """0.45 one step back, 0.55 four steps ahead: the shortest way over the way taken is 1 and 4/6 for going
    back first, 1/9 and 1 for going ahead first.
    """
    space = by_hand.corridor([0], [], [], [], [], [1])
    here = situation(space, 1, [0.45, 0.55])
    choice = Lookahead(space, parameters_with(worth="ratio", recall=1.0)).decide(here, RNG)
    np.testing.assert_allclose(choice.values[:2], [0.45 / 9 + 0.55, 0.45 + 4 / 6 * 0.55])
    assert choice.action == Action.BACKWARD


def test_it_goes_to_the_only_pose_that_is_left(by_hand, parameters_with, situation):
    space = by_hand.corridor([0], [0], [0], [0], [0])
    for left in range(5):
        policy = Lookahead(space, parameters_with())
        start = 0 if left else 4
        choice = policy.decide(situation(space, start, [1.0], looked={*range(5)} - {left}), RNG)
        assert choice.action == (Action.FORWARD if left else Action.BACKWARD)
        assert np.count_nonzero(choice.visits) == 1


def test_there_is_nothing_to_decide_where_everything_was_looked_from(by_hand, parameters_with, situation):
    space = by_hand.corridor([0], [0], [], [0])  # the third sees nothing and is worth no look
    here = situation(space, 0, [1.0], looked=[3, 1])
    assert Lookahead(space, parameters_with()).decide(here, RNG) is None


def test_one_pose_decides_nothing(by_hand, parameters_with, situation):
    space = by_hand.corridor([0])
    assert Lookahead(space, parameters_with()).decide(situation(space, 0, [1.0]), RNG) is None


def test_what_cannot_be_reached_or_seen_is_not_looked_for(by_hand, parameters_with, situation):
    """A pose that only others lead from, and a candidate that nobody sees."""
    space = by_hand.table([[1, -1, -1, -1], [-1, 0, -1, -1], [0, -1, -1, -1]], [[], [], [1]], candidates=3)
    for worth in ("ratio", "discount"):
        policy = Lookahead(space, parameters_with(worth=worth))
        assert policy.decide(situation(space, 0, [0.2, 0.5, 0.3]), RNG) is None


def test_a_target_in_view_that_was_not_detected_is_looked_for_from_elsewhere(
    by_hand, parameters_with, situation
):
    space = by_hand.corridor([0], [0])
    choice = Lookahead(space, parameters_with()).decide(situation(space, 0, [1.0]), RNG)
    assert choice.action == Action.FORWARD


def test_time_ends_a_decision_with_the_greedy_rules_first_choice(by_hand, parameters_with, situation):
    """Each look at the clock takes a second: it got to one viewpoint, that with the most per step."""
    space = by_hand.corridor([2], [1], [], [], [0])
    ticks = itertools.count()
    policy = Lookahead(
        space, parameters_with(time_budget_s=0.5, worth="discount"), clock=lambda: float(next(ticks))
    )
    choice = policy.decide(situation(space, 3, [0.2, 0.39, 0.41]), RNG)
    assert choice.simulations == choice.visits.sum() == 1
    assert choice.action == Action.FORWARD


def test_the_goal_of_the_last_decision_is_kept_among_those_thought_through(
    by_hand, parameters_with, situation
):
    """With room for one viewpoint, the greedy rule's, it takes two from the second decision on."""
    space = by_hand.corridor([2], [1], [], [], [0])
    policy = Lookahead(space, parameters_with(goals=1, worth="discount", recall=1.0))
    assert policy.decide(situation(space, 3, [0.2, 0.39, 0.41]), RNG).simulations == 1
    # A little less ahead than there was: the greedy rule now goes back, the last goal is tried too.
    choice = policy.decide(situation(space, 3, [0.1, 0.44, 0.46]), RNG)
    assert choice.visits.tolist() == [1, 1, 0, 0]


def test_in_a_home_it_looks_at_everything_without_delay(home, parameters_with, situation):
    """Where a look is certain to find, three rooms are looked through in few steps."""
    policy = Lookahead(home, parameters_with(recall=1.0), clock=lambda: 0.0)
    can_be_seen = home.observability.seen_from_somewhere()
    poses, seen = [0], home.observability.row(0)
    while not np.array_equal(seen, can_be_seen):
        belief = np.where(seen, 1e-9, 1.0)
        here = situation(home, poses[-1], belief / belief.sum(), looked=poses, step=len(poses) - 1, start=0)
        choice = policy.decide(here, RNG)
        poses.append(int(home.graph.successors[poses[-1], choice.action]))
        seen = seen | home.observability.row(poses[-1])
        assert len(poses) <= 100
