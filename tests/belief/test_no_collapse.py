"""C4: whatever a detector says, the belief stays a belief, and the truth can come back."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_nodes.belief.evidence import Evidence, F1Evidence, LikelihoodEvidence
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.belief.observation import place_densities
from robustnav_nodes.search_space.candidates import Candidates

FLOOR = 1e-6
SIGMA_M = 0.5
SPACING_M = 1.0  # so that a detection at one place weighs exp(-2) at the next
EVIDENCE = [
    pytest.param(F1Evidence(f1=0.99, detection_floor=0.02), id="f1"),
    pytest.param(LikelihoodEvidence(recall=0.98, false_alarms=1e-3), id="likelihood"),
    pytest.param(LikelihoodEvidence(recall=0.05, false_alarms=1.0), id="likelihood of a bad detector"),
]
SIZES = [1, 2, 3, 50, 1000, 100_000]


def floor_of(count: int) -> Candidates:
    """`count` candidates on a square grid."""
    side = math.ceil(math.sqrt(count))
    index = np.arange(count)
    x_m, y_m = (index % side) * SPACING_M, (index // side) * SPACING_M
    return Candidates(x_m=x_m.astype(float), y_m=y_m.astype(float), size_m=0.2)


def look(belief: LocationBelief, evidence: Evidence, in_view, detected_m) -> LocationBelief:
    """One look; a place that is not finite gives a row that is not, as no tracker would let through."""
    places = np.asarray(detected_m, dtype=float).reshape(-1, 2)
    return belief.updated(
        evidence.factor(in_view, place_densities(belief.candidates, in_view, places, SIGMA_M)), FLOOR
    )


def check(belief: LocationBelief) -> None:
    probability = belief.probability
    assert np.isfinite(probability).all()
    assert probability.min() > 0.0
    assert probability.sum() == pytest.approx(1.0, abs=1e-9)
    assert 0.0 <= belief.normalised_entropy() <= 1.0


def views_of(rng: np.random.Generator, count: int):
    """For ever: a run of candidates in view, of any length, sometimes all or none."""
    while True:
        first, last = np.sort(rng.integers(0, count + 1, size=2))
        yield (np.arange(count) >= first) & (np.arange(count) < last)


def at(candidates: Candidates, number: int) -> list[list[float]]:
    return [[float(candidates.x_m[number]), float(candidates.y_m[number])]]


ADVERSARIES = {
    "always at one place": lambda turn, rng, floor: at(floor, 0),
    "never": lambda turn, rng, floor: [],
    "every other look": lambda turn, rng, floor: at(floor, 0) if turn % 2 else [],
    "beside the map": lambda turn, rng, floor: [[-4.0, -4.0]],
    "far outside the map": lambda turn, rng, floor: [[-1e6, 1e6]],
    "not a number": lambda turn, rng, floor: [[math.nan, 0.0]],
    "infinitely far": lambda turn, rng, floor: [[math.inf, 0.0]],
    "anywhere": lambda turn, rng, floor: at(floor, int(rng.integers(len(floor)))),
    "many at once": lambda turn, rng, floor: rng.uniform(0.0, len(floor) ** 0.5, (int(rng.integers(20)), 2)),
}


def after(adversary: str, evidence: Evidence, count: int, looks: int, seed: int = 0) -> LocationBelief:
    """The belief after this many looks with this adversary, checked after each."""
    rng = np.random.default_rng(seed)
    belief = LocationBelief.uniform(floor_of(count))
    views = views_of(rng, count)
    for turn in range(looks):
        # Half of them at everything, where a detector can do the most harm.
        in_view = next(views) if turn % 2 else np.ones(count, dtype=bool)
        belief = look(belief, evidence, in_view, ADVERSARIES[adversary](turn, rng, belief.candidates))
        check(belief)
    return belief


def come_back(belief: LocationBelief, evidence: Evidence, target: int) -> LocationBelief:
    """As many true detections as outweigh the worst belief by the ratio of the target to the next place."""
    candidates, everything = belief.candidates, np.ones(len(belief.candidates), dtype=bool)
    places = np.array(at(candidates, target))
    factor = evidence.factor(everything, place_densities(candidates, everything, places, SIGMA_M))
    others = np.delete(factor, target)
    needed = math.log(len(candidates) / FLOOR) / math.log(factor[target] / others.max()) if len(others) else 1
    for _ in range(math.ceil(needed) + 2):
        belief = look(belief, evidence, everything, places)
        check(belief)
    return belief


@pytest.mark.parametrize("evidence", EVIDENCE)
@pytest.mark.parametrize("adversary", ADVERSARIES)
@pytest.mark.parametrize("count", SIZES)
def test_c4_no_detector_collapses_the_belief_and_the_truth_comes_back(evidence, adversary, count):
    belief = after(adversary, evidence, count, looks=60 if count <= 1000 else 8)
    target = count - 1
    assert np.argmax(come_back(belief, evidence, target).probability) == target


@given(
    count=st.sampled_from(SIZES[:-1]),
    f1=st.floats(0.5, 0.999999),
    detection_floor=st.floats(1e-6, 1.0),
    recall=st.floats(0.001, 0.9999),
    false_alarms=st.floats(1e-9, 1.0),
    turns=st.lists(st.sampled_from(sorted(ADVERSARIES)), min_size=1, max_size=30),
    seed=st.integers(0, 1000),
)
@settings(max_examples=60, deadline=None)
def test_c4_no_mixture_of_them_with_any_parameters_does(
    count, f1, detection_floor, recall, false_alarms, turns, seed
):
    candidates = floor_of(count)
    for evidence in (
        F1Evidence(f1=f1, detection_floor=detection_floor),
        LikelihoodEvidence(recall=recall, false_alarms=false_alarms),
    ):
        rng = np.random.default_rng(seed)
        belief, views = LocationBelief.uniform(candidates), views_of(rng, count)
        for turn, adversary in enumerate(turns):
            belief = look(belief, evidence, next(views), ADVERSARIES[adversary](turn, rng, candidates))
            check(belief)


@pytest.mark.parametrize("evidence", EVIDENCE)
@pytest.mark.parametrize("places", [[[math.nan, 0.0]], [[math.nan, math.nan], [0.0, 0.0]]])
def test_a_detection_at_no_number_changes_nothing(evidence, places):
    belief = LocationBelief.uniform(floor_of(9))
    after_it = look(belief, evidence, np.ones(9, dtype=bool), places)
    np.testing.assert_array_equal(after_it.probability, belief.probability)


@pytest.mark.parametrize("evidence", EVIDENCE)
def test_c4_a_place_that_was_missed_a_thousand_times_can_come_back(evidence):
    belief = LocationBelief.uniform(floor_of(25))
    only_it = np.arange(25) == 7
    for _ in range(1000):
        belief = look(belief, evidence, only_it, [])
    check(belief)
    assert np.argmin(belief.probability) == 7
    assert np.argmax(come_back(belief, evidence, 7).probability) == 7
