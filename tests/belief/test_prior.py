"""What is known before the first look: rooms, what people say, and that nothing is ever ruled out."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.belief.prior import RegionFact, region_prior, told
from robustnav_nodes.belief.tracker import BeliefTracker
from robustnav_nodes.search_space.camera_view import build_camera_view

REGION = np.array([0, 0, 0, 1, 2, 2])  # of six candidates
weights = st.lists(st.floats(0.0, 1e6), min_size=6, max_size=6).filter(lambda row: sum(row) > 0.0)
facts = st.builds(RegionFact, region=st.integers(0, 2), is_there=st.booleans(), trust=st.floats(0.01, 0.99))


def p_of(weight, region: int) -> float:
    return float(weight[region == REGION].sum())


def evenly() -> np.ndarray:
    return region_prior(REGION, np.array([1.0, 1.0, 1.0]))


@given(weight=weights, strength=st.floats(0.0, 0.999))
def test_a_weighted_belief_sums_to_one_and_holds_no_zero(in_a_row, weight, strength):
    belief = LocationBelief.weighted(in_a_row(6), np.array(weight), strength)
    assert belief.probability.sum() == pytest.approx(1.0)
    assert belief.probability.min() >= (1.0 - strength) / 6 * (1.0 - 1e-9)
    order = np.argsort(weight, kind="stable")
    assert (np.diff(belief.probability[order]) >= -1e-12).all()


def test_weights_by_hand(in_a_row):
    half = LocationBelief.weighted(in_a_row(4), np.array([3.0, 1.0, 0.0, 0.0]), 0.5)
    np.testing.assert_allclose(half.probability, [0.5, 0.25, 0.125, 0.125])
    none = LocationBelief.weighted(in_a_row(4), np.array([3.0, 1.0, 0.0, 0.0]), 0.0)
    np.testing.assert_array_equal(none.probability, LocationBelief.uniform(in_a_row(4)).probability)


@pytest.mark.parametrize(
    ("weight", "strength"),
    [
        ([1.0, 1.0, 1.0], 0.5),
        ([1.0, -0.1], 0.5),
        ([1.0, np.nan], 0.5),
        ([0.0, 0.0], 0.5),
        ([1.0, 1.0], 1.5),
        ([1.0, 0.0], 1.0),
    ],
    ids=["too many", "negative", "nan", "all 0", "too strong", "a 0 for ever"],
)
def test_bad_weights_are_refused(in_a_row, weight, strength):
    with pytest.raises(BadParameterError):
        LocationBelief.weighted(in_a_row(2), np.array(weight), strength)


def test_an_affinity_is_the_probability_of_the_region_whatever_its_size():
    weight = region_prior(REGION, np.array([1.0, 6.0, 3.0]))
    assert [p_of(weight, region) for region in range(3)] == pytest.approx([0.1, 0.6, 0.3])
    assert weight[0] == weight[1] == weight[2]


def test_a_region_without_candidates_takes_nothing():
    weight = region_prior(np.array([0, 0, 2]), np.array([1.0, 5.0, 1.0]))
    np.testing.assert_allclose(weight, [0.25, 0.25, 0.5])


@pytest.mark.parametrize("affinity", [[1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 0.0, 0.0], [1.0, np.inf, 1.0]])
def test_bad_affinities_are_refused(affinity):
    with pytest.raises(BadParameterError):
        region_prior(REGION, np.array(affinity))


def test_trust_is_the_probability_that_what_is_said_is_so():
    """Where all three regions are alike beforehand."""
    there = told(evenly(), REGION, RegionFact(region=2, trust=0.8))
    assert [p_of(there, region) for region in range(3)] == pytest.approx([0.1, 0.1, 0.8])
    elsewhere = told(evenly(), REGION, RegionFact(region=2, is_there=False, trust=0.8))
    assert [p_of(elsewhere, region) for region in range(3)] == pytest.approx([4 / 9, 4 / 9, 1 / 9])


def test_what_is_no_better_than_chance_says_nothing():
    np.testing.assert_allclose(told(evenly(), REGION, RegionFact(region=0, trust=1 / 3)), evenly())
    no = RegionFact(region=0, is_there=False, trust=0.5)
    np.testing.assert_allclose(told(evenly(), REGION, no), evenly())


@given(given=st.lists(facts, min_size=1, max_size=4))
def test_the_order_of_facts_does_not_matter(given):
    results = []
    for order in itertools.islice(itertools.permutations(given), 6):
        weight = evenly()
        for fact in order:
            weight = told(weight, REGION, fact)
        assert weight.sum() == pytest.approx(1.0)
        results.append(weight)
    np.testing.assert_allclose(results, np.tile(results[0], (len(results), 1)))


def test_facts_that_cannot_all_be_so_are_refused():
    surely = told(evenly(), REGION, RegionFact(region=0, trust=1.0))
    with pytest.raises(BadParameterError, match="no place"):
        told(surely, REGION, RegionFact(region=1, trust=1.0))


@pytest.mark.parametrize("trust", [-0.1, 1.1, float("nan")])
def test_trust_is_a_probability(trust):
    with pytest.raises(BadParameterError, match="trust"):
        RegionFact(region=0, trust=trust)


def test_a_tracker_begins_at_its_prior_and_what_it_rules_out_can_come_back():
    """Four candidates, the prior knows only the last; the detector fires at the first, look after look."""
    parameters = BeliefParameters(camera_forward_m=0.0, range_min_m=0.5, range_max_m=4.0)
    mask = np.zeros((10, 30), dtype=np.int8)
    mask[5, [5, 10, 15, 25]] = 100
    origin = Pose2D(x_m=0.0, y_m=0.0)
    floor = OccupancyMap(cells=np.zeros((40, 120), dtype=np.int8), resolution_m=0.05, origin=origin)
    view = build_camera_view(floor, OccupancyMap(cells=mask, resolution_m=0.2, origin=origin), parameters)
    tracker = BeliefTracker(
        view=view,
        statistics=ClassStatistics(precision=0.9, recall=0.8),
        parameters=parameters,
        prior=np.array([0.0, 0.0, 0.0, 1.0]),
    )
    assert tracker.belief.probability[3] > 0.999
    assert tracker.belief.probability.min() > 0.0
    for x_m, y_m in itertools.product((0.1, 0.3), (0.7, 0.9, 1.1, 1.3, 1.5)):
        tracker.observe(Pose2D(x_m=x_m, y_m=y_m), np.array([[1.1, 1.1]]))
    assert tracker.belief.probability[0] > 0.9
