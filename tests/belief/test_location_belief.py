import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.values import BeliefCloud
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.belief.observation import detected_factor, missed_factor, place_densities
from robustnav_nodes.search_space.candidates import Candidates

FLOOR = 1e-6

VIEW = st.integers(0, 2**12 - 1)
MISS = st.tuples(VIEW, st.none())
DETECTION = st.tuples(VIEW, st.tuples(st.floats(-50.0, 50.0), st.floats(-50.0, 50.0)))


def bits(view: int) -> np.ndarray:
    return np.array([bool(view >> j & 1) for j in range(12)])


def is_sound(probability: np.ndarray) -> bool:
    return bool(
        np.isfinite(probability).all() and (probability > 0.0).all() and abs(probability.sum() - 1.0) < 1e-9
    )


@given(observations=st.lists(MISS | DETECTION, max_size=60), repeat=st.integers(1, 30))
@settings(max_examples=100, deadline=None)
def test_c4_a_belief_never_collapses(in_a_row, observations, repeat):
    """Whatever the detector says, however often, it sums to one and holds neither 0 nor NaN."""
    candidates = in_a_row(12)
    belief = LocationBelief.uniform(candidates)
    for view, detected in observations * repeat:
        if detected is None:
            factor = missed_factor(bits(view), 0.99)
        else:
            densities = place_densities(candidates, bits(view), np.array([detected]), 0.05)
            factor = detected_factor(bits(view), densities, 1e-6)
        belief = belief.updated(factor, FLOOR)
        assert is_sound(belief.probability)
        assert 0.0 <= belief.normalised_entropy() <= 1.0


@pytest.mark.parametrize(
    "factor", [np.zeros(3), np.full(3, np.nan), np.array([1.0, np.inf, 1.0]), np.array([-1.0, 2.0, 2.0])]
)
def test_c4_a_factor_without_sense_changes_nothing(in_a_row, factor):
    belief = LocationBelief.uniform(in_a_row(3))
    np.testing.assert_array_equal(belief.updated(factor, FLOOR).probability, belief.probability)


def test_c4_a_place_ruled_out_can_come_back(in_a_row):
    belief = LocationBelief.uniform(in_a_row(3))
    for _ in range(1000):
        belief = belief.updated(np.array([1e-9, 1.0, 1.0]), FLOOR)
    assert belief.probability[0] == pytest.approx(FLOOR / 3, rel=1e-3)
    for _ in range(10):
        belief = belief.updated(np.array([1.0, 0.1, 0.1]), FLOOR)
    assert belief.probability[0] > 0.9


def test_bayes_rule_by_hand(in_a_row):
    """Three candidates: a miss on the first with F1 = 0.75, then a detection on the second.

    After the miss 1/7, 3/7, 3/7 (eq. 3.1: 1/3 of 0.25, 0.75, 0.75). The detection weighs 0.1, 1, 0.1:
    1/70, 30/70, 3/70 -> 1/34, 30/34, 3/34.
    """
    belief = LocationBelief.uniform(in_a_row(3))
    belief = belief.updated(missed_factor(np.array([True, False, False]), 0.75), FLOOR)
    np.testing.assert_allclose(belief.probability, [1 / 7, 3 / 7, 3 / 7])
    view = np.array([False, True, False])
    densities = place_densities(in_a_row(3), view, np.array([[0.2, 0.0]]), sigma_m=0.5)
    factor = detected_factor(view, densities, floor=0.1)
    np.testing.assert_allclose(belief.updated(factor, FLOOR).probability, [1 / 34, 30 / 34, 3 / 34])


def test_c1_the_belief_starts_at_one_over_the_number_of_candidates(in_a_row):
    belief = LocationBelief.uniform(in_a_row(8))
    np.testing.assert_allclose(belief.probability, 1 / 8)
    assert belief.normalised_entropy() == pytest.approx(1.0)


def test_the_order_of_observations_does_not_matter(in_a_row):
    a, b = missed_factor(bits(7), 0.7), missed_factor(bits(56), 0.8)
    start = LocationBelief.uniform(in_a_row(12))
    np.testing.assert_allclose(
        start.updated(a, FLOOR).updated(b, FLOOR).probability,
        start.updated(b, FLOOR).updated(a, FLOOR).probability,
    )


def test_entropy_of_one_candidate_is_zero(in_a_row):
    assert LocationBelief.uniform(in_a_row(1)).normalised_entropy() == 0.0


def test_the_cloud_is_a_copy_with_the_stamp(in_a_row):
    belief = LocationBelief.uniform(in_a_row(5))
    cloud = belief.cloud(stamp_ns=42, frame_id="map")
    assert isinstance(cloud, BeliefCloud)
    assert (cloud.stamp_ns, cloud.frame_id) == (42, "map")
    cloud.probability[0] = 0.9
    np.testing.assert_allclose(belief.probability, 0.2)


WEIGHTS = st.lists(st.floats(1e-12, 1.0), min_size=1, max_size=12)
PLACES = st.lists(st.tuples(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0)), min_size=1, max_size=30)


def belief_on(candidates: Candidates, weights: list[float]) -> LocationBelief:
    probability = np.array(weights) / np.sum(weights)
    return LocationBelief(candidates=candidates, probability=probability)


def at(places: list[tuple[float, float]]) -> Candidates:
    x_m, y_m = np.array(places).T
    return Candidates(x_m=x_m, y_m=y_m, size_m=0.2)


@given(weights=WEIGHTS, places=PLACES)
@settings(max_examples=100, deadline=None)
def test_c4_a_belief_carried_anywhere_never_collapses(in_a_row, weights, places):
    carried = belief_on(in_a_row(len(weights)), weights).carried_to(at(places))
    assert len(carried.probability) == len(places)
    assert is_sound(carried.probability)


@given(weights=WEIGHTS, new=PLACES, seed=st.integers(0, 1000))
@settings(max_examples=100, deadline=None)
def test_what_is_known_of_places_to_each_other_outlives_a_growing_map(in_a_row, weights, new, seed):
    """The old candidates stand among new ones, in any order, each a little beside where it was."""
    rng = np.random.default_rng(seed)
    before = belief_on(in_a_row(len(weights)), weights)
    moved = [(0.2 * j + dx, dy) for j, (dx, dy) in enumerate(rng.uniform(-0.09, 0.09, (len(weights), 2)))]
    order = rng.permutation(len(moved) + len(new))
    carried = before.carried_to(at([(moved + new)[i] for i in order]))
    of_old = carried.probability[np.argsort(order)[: len(moved)]]
    np.testing.assert_allclose(of_old / of_old.sum(), before.probability)


def test_a_new_place_gets_the_share_that_every_place_began_with(in_a_row):
    """Three candidates at 1/2, 1/4, 1/4; two new ones weigh 1/3 each: the sum is 5/3."""
    carried = belief_on(in_a_row(3), [2.0, 1.0, 1.0]).carried_to(in_a_row(5))
    np.testing.assert_allclose(carried.probability, np.array([1 / 2, 1 / 4, 1 / 4, 1 / 3, 1 / 3]) * 3 / 5)


def test_a_place_keeps_what_the_patch_that_it_lies_on_had(in_a_row):
    """Patches of 0.2 m, the middle of the first at 0: 0.09 lies on it, 0.11 on the second, -0.11 on none."""
    before = belief_on(in_a_row(2), [3.0, 1.0])
    carried = before.carried_to(at([(0.09, 0.09), (0.11, -0.09), (-0.11, 0.0), (0.0, 0.11)]))
    weights = np.array([3 / 4, 1 / 4, 1 / 2, 1 / 2])
    np.testing.assert_allclose(carried.probability, weights / weights.sum())


@given(places=PLACES)
@settings(max_examples=50, deadline=None)
def test_where_nothing_is_known_a_grown_map_changes_nothing(in_a_row, places):
    carried = LocationBelief.uniform(in_a_row(7)).carried_to(at(places))
    np.testing.assert_allclose(carried.probability, 1 / len(places))


def test_a_map_of_another_place_begins_anew(in_a_row):
    carried = belief_on(in_a_row(3), [5.0, 1.0, 1.0]).carried_to(at([(9.0, 9.0), (9.2, 9.0)]))
    np.testing.assert_allclose(carried.probability, 1 / 2)
