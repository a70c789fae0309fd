"""A search does not go to and fro while there is somewhere left to look from."""

from collections.abc import Callable

import numpy as np
import pytest

from robustnav_nodes.planner.parameters import VARIANTS
from robustnav_nodes.planner.search import Search
from robustnav_nodes.search_space.space import SearchSpace

LAST = 12  # steps
STARTS = (0, 300, 700)
Weights = np.ndarray
Word = Callable[[Weights, np.ndarray, int, bool], Weights]


def silent(weight, in_view, look, is_known):
    """A miss halves what is in view, the first time."""
    return weight if is_known else np.where(in_view, 0.5 * weight, weight)


def useless(weight, in_view, look, is_known):
    """It tells nothing, ever."""
    return weight


def firing_again(weight, in_view, look, is_known):
    """Silent at first; from a known pose it fires, always at the same place."""
    places = np.nonzero(in_view)[0]
    if not is_known or len(places) == 0:
        return silent(weight, in_view, look, is_known)
    return np.where(np.arange(len(weight)) == places[0], 1.02 * weight, weight)


def firing_anywhere(weight, in_view, look, is_known):
    """Silent at first; from a known pose it fires, here and there."""
    places = np.nonzero(in_view)[0]
    if not is_known or len(places) == 0:
        return silent(weight, in_view, look, is_known)
    return np.where(np.arange(len(weight)) == places[look % len(places)], 1.02 * weight, weight)


def firing_at_first(weight, in_view, look, is_known):
    """A false alarm from every new pose, as strong as the miss."""
    places = np.nonzero(in_view)[0]
    weight = silent(weight, in_view, look, is_known)
    if is_known or len(places) == 0:
        return weight
    return np.where(np.arange(len(weight)) == places[look % len(places)], 2.1 * weight, weight)


DETECTORS = [silent, useless, firing_again, firing_anywhere, firing_at_first]


def course_of(space: SearchSpace, parameters, word: Word, start: int) -> tuple[list[int], np.ndarray]:
    """The poses of a search that nothing ends, and the belief after it."""
    search = Search(space=space, parameters=parameters, rng=np.random.default_rng(start), clock=lambda: 0.0)
    weight, poses = np.ones(len(space.candidates)), [start]
    while True:
        pose = poses[-1]
        in_view = space.observability.row(pose)
        weight = word(weight, in_view, len(poses), pose in poses[:-1])
        probability = np.maximum(weight / weight.sum(), 1e-6 / len(weight))
        probability /= probability.sum()
        step = search.look(pose, in_view, probability)
        if not step.path:
            return poses, probability
        poses.append(step.path[1])


def has_left(space: SearchSpace, poses: list[int], probability: np.ndarray) -> bool:
    """Whether a pose in reach, not looked from, has more in view than the floor of the belief."""
    within = np.isfinite(space.graph.steps_from(poses[-1]))
    within[poses] = False
    return any(
        probability[space.observability.seen_by(int(pose))].sum() > 1e-3 for pose in np.nonzero(within)[0]
    )


@pytest.mark.parametrize("word", DETECTORS)
@pytest.mark.parametrize("variant", VARIANTS)
def test_no_search_ends_on_two_poses_while_there_is_more_to_look_at(home, parameters_with, variant, word):
    """Whatever the detector does; nothing that it says is enough to end the search."""
    parameters = parameters_with(
        variant=variant,
        ending="view",
        p_found=0.9999,
        max_steps=90,
        simulations=32,
        goals=3,
        lookahead_steps=20,
        time_budget_s=60.0,
    )
    for start in STARTS:
        poses, probability = course_of(home, parameters, word, start)
        assert len(poses) == 91
        assert has_left(home, poses, probability)
        assert len(set(poses[-LAST:])) > 2, poses[-LAST:]


@pytest.mark.parametrize("word", DETECTORS)
@pytest.mark.parametrize("variant", ["greedy", "greedy_gain", "lookahead"])
def test_a_rule_looks_from_many_poses(home, parameters_with, variant, word):
    """At least every other step is to a pose that it did not know."""
    parameters = parameters_with(
        variant=variant, ending="view", p_found=0.9999, max_steps=90, goals=3, lookahead_steps=20
    )
    for start in STARTS:
        poses, _ = course_of(home, parameters, word, start)
        assert len(set(poses)) > 45
