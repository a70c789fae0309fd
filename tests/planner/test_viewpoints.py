"""What poses would show, against slow and plain versions of the same, and by hand."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_nodes.planner.viewpoints import (
    NONE,
    best_viewpoint,
    empty_reach,
    first_sight_distance,
    look_from,
    outlook_on,
    place_of,
    walk_everywhere,
    way_to,
    worth_of_way,
)

SEED = st.integers(0, 2**32 - 1)
RECALL = st.floats(0.05, 1.0)
DISCOUNT = 0.5 ** np.arange(20)


def view_of(space, seed: int):
    """Place, outlook, scratch: a mass, some of it 0, and some poses that were looked from."""
    rng = np.random.default_rng(seed)
    mass = rng.random(len(space.candidates)) * (rng.random(len(space.candidates)) < 0.8)
    looked = rng.random(len(space.graph)) < 0.3
    place = place_of(space.graph, space.observability)
    return place, outlook_on(place, mass, looked), empty_reach(len(space.graph))


def new_outlook(space, mass):
    place = place_of(space.graph, space.observability)
    outlook = outlook_on(place, np.array(mass), np.zeros(len(space.graph), dtype=bool))
    return place, outlook, empty_reach(len(space.graph))


def gain_of(space, outlook, pose: int) -> float:
    if outlook.looked[pose]:
        return 0.0
    return float(sum(outlook.mass[j] for j in space.observability.seen_by(pose)))


def test_gains_by_hand(by_hand):
    """Three poses; the last has been looked from."""
    space = by_hand.corridor([0, 1], [], [1, 2])
    place = place_of(space.graph, space.observability)
    outlook = outlook_on(place, np.array([0.5, 0.3, 0.2]), np.array([False, False, True]))
    np.testing.assert_allclose(outlook.gain, [0.8, 0.0, 0.0])


def test_a_look_by_hand(by_hand):
    """Of 0.5 + 0.3 the part 0.6 is detected; the other pose that sees the second loses 0.18."""
    space = by_hand.corridor([0, 1], [], [1, 2])
    place, outlook, _ = new_outlook(space, [0.5, 0.3, 0.2])
    assert look_from(place, outlook, 0, 0.6) == pytest.approx(0.48)
    np.testing.assert_allclose(outlook.mass, [0.2, 0.12, 0.2])
    np.testing.assert_allclose(outlook.gain, [0.0, 0.0, 0.32])


def test_a_pose_gives_once(by_hand):
    place, outlook, _ = new_outlook(by_hand.corridor([0], [0]), [1.0])
    assert look_from(place, outlook, 0, 0.6) == pytest.approx(0.6)
    assert look_from(place, outlook, 0, 0.6) == 0.0
    assert look_from(place, outlook, 1, 0.6) == pytest.approx(0.24)
    assert outlook.mass[0] == pytest.approx(0.16)


@given(seed=SEED, recall=RECALL, looks=st.lists(st.integers(0, 99), max_size=12))
@settings(deadline=None)
def test_looks_lose_no_mass_and_keep_the_gains_right(by_hand, seed, recall, looks):
    """What was detected and what is left is what there was; each gain is what a fresh sum would give."""
    space = by_hand.maze(seed)
    place, outlook, _ = view_of(space, seed)
    whole, detected = outlook.mass.sum(), 0.0
    for look in looks:
        pose = look % len(space.graph)
        expected = recall * gain_of(space, outlook, pose)
        found = look_from(place, outlook, pose, recall)
        assert found == pytest.approx(expected, abs=1e-12)
        detected += found
        assert detected + outlook.mass.sum() == pytest.approx(whole)
        assert outlook.mass.min() >= 0.0
        for other in np.nonzero(~outlook.looked)[0]:
            assert outlook.gain[other] == pytest.approx(gain_of(space, outlook, other), abs=1e-12)
        assert np.all(outlook.gain[outlook.looked] <= 1e-12)


@given(seed=SEED, start=st.integers(0, 99), looks=st.lists(st.integers(0, 99), max_size=4))
@settings(deadline=None)
def test_the_best_viewpoint_is_the_best_of_all(by_hand, seed, start, looks):
    """Most gain per step, against all poses tried one by one; among equals any may be taken."""
    space = by_hand.maze(seed)
    place, outlook, reach = view_of(space, seed)
    for look in looks:  # leaves the rounding of gains behind
        look_from(place, outlook, look % len(space.graph), 1.0)
    start %= len(space.graph)
    steps = space.graph.steps_from(start)
    ratio = {
        pose: gain_of(space, outlook, pose) / steps[pose]
        for pose in range(len(space.graph))
        if 0 < steps[pose] < np.inf and not outlook.looked[pose]
    }
    best = best_viewpoint(place, outlook, reach, start, max(0.0, float(outlook.gain.max())))
    most = max(ratio.values(), default=0.0)
    if best == NONE:
        assert most <= 1e-9
    else:
        assert ratio[best] == pytest.approx(most)
        assert len(way_to(reach, best)) == steps[best]


@given(seed=SEED, start=st.integers(0, 99))
@settings(deadline=None)
def test_a_walk_reaches_what_can_be_reached_by_the_fewest_steps(by_hand, seed, start):
    space = by_hand.maze(seed)
    place, _, reach = view_of(space, seed)
    start %= len(space.graph)
    for _ in range(2):  # the scratch is used again and again
        steps = space.graph.steps_from(start)
        reached = walk_everywhere(place, reach, start)
        assert set(reach.queue[:reached].tolist()) == set(np.nonzero(np.isfinite(steps))[0].tolist())
        for goal in reach.queue[:reached]:
            way = [start, *way_to(reach, goal).tolist()]
            assert way[-1] == goal
            assert len(way) - 1 == reach.distance[goal] == steps[goal]
            assert all(b in space.graph.successors[a] for a, b in itertools.pairwise(way))
        start = (start + 1) % len(space.graph)


@given(seed=SEED, start=st.integers(0, 99))
@settings(deadline=None)
def test_the_first_sight_is_the_nearest_pose_that_sees_it(by_hand, seed, start):
    space = by_hand.maze(seed)
    place, _, reach = view_of(space, seed)
    start %= len(space.graph)
    found = first_sight_distance(place, reach, walk_everywhere(place, reach, start))
    steps = space.graph.steps_from(start)
    expected = [
        steps[space.observability.seers_of(j)].min(initial=np.inf) for j in range(len(space.candidates))
    ]
    np.testing.assert_array_equal(found, expected)


def test_the_worth_of_a_way_in_a_corridor_by_hand(by_hand):
    """Recall 1, worth 0.5 ^ steps: 0.3 is seen after two steps, 0.6 after four, 0.1 after five."""
    space = by_hand.corridor([], [], [0], [], [1], [2])
    place, outlook, reach = new_outlook(space, [0.3, 0.6, 0.1])
    way = np.array([1, 2], dtype=np.int32)
    worth = worth_of_way(place, outlook, reach, way, 1.0, DISCOUNT, 1.0)
    assert worth == pytest.approx(0.3 / 4 + 0.6 / 16 + 0.1 / 32)


def test_the_worth_of_a_way_there_and_back_by_hand(by_hand):
    """From the middle: one step to 0.2, then back through the start to 0.8, two steps from there."""
    space = by_hand.corridor([0], [], [], [1])
    place, outlook, reach = new_outlook(space, [0.2, 0.8])
    worth = worth_of_way(place, outlook, reach, np.array([0], dtype=np.int32), 1.0, DISCOUNT, 1.0)
    assert worth == pytest.approx(0.2 / 2 + 0.8 / 16)


def test_the_worth_of_two_looks_at_one_place_by_hand(by_hand):
    """Recall 0.5: half of it after one step, half of the rest after two, and no more poses see it."""
    place, outlook, reach = new_outlook(by_hand.corridor([], [0], [0], []), [1.0])
    worth = worth_of_way(place, outlook, reach, np.array([1], dtype=np.int32), 0.5, DISCOUNT, 1.0)
    assert worth == pytest.approx(0.5 / 2 + 0.25 / 4)


def test_a_way_through_a_pose_that_was_looked_from_gives_nothing_there(by_hand):
    space = by_hand.corridor([], [0], [1])
    place = place_of(space.graph, space.observability)
    outlook = outlook_on(place, np.array([0.5, 0.5]), np.array([True, True, False]))
    way = np.array([1, 2], dtype=np.int32)
    assert worth_of_way(place, outlook, empty_reach(3), way, 1.0, DISCOUNT, 1.0) == pytest.approx(0.5 / 4)


@pytest.mark.parametrize(
    ("steps", "expected"), [(1, 0.0), (2, 0.3 / 4), (3, 0.3 / 4), (4, 0.3 / 4 + 0.7 / 16)]
)
def test_nothing_counts_beyond_the_last_step(by_hand, steps, expected):
    place, outlook, reach = new_outlook(by_hand.corridor([], [], [0], [], [1]), [0.3, 0.7])
    way = np.array([1, 2], dtype=np.int32)
    worth = worth_of_way(place, outlook, reach, way, 1.0, DISCOUNT[: steps + 1], 1.0)
    assert worth == pytest.approx(expected)


@given(seed=SEED, recall=RECALL, steps=st.integers(1, 15))
@settings(deadline=None)
def test_the_worth_of_a_way_is_that_of_the_plain_version(by_hand, plain_worth, seed, recall, steps):
    space = by_hand.maze(seed)
    place, outlook, reach = view_of(space, seed)
    worth = np.sort(np.random.default_rng(seed).random(steps + 1))[::-1].copy()
    mass, looked = outlook.mass.copy(), np.nonzero(outlook.looked)[0].tolist()
    reached = walk_everywhere(place, reach, 0)
    way = way_to(reach, int(reach.queue[reached - 1]))
    if len(way) == 0:
        return
    expected = plain_worth(space, mass, looked, 0, way.tolist(), recall, worth)
    found = worth_of_way(place, outlook, reach, way, recall, worth, max(0.0, float(outlook.gain.max())))
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-9)
