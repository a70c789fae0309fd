import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from robustnav_nodes.belief.observation import detected_factor, missed_factor, place_densities, usable_f1


def factor_at(candidates, in_view, detected_m, sigma_m, floor):
    """The factor of detections at places, as the tracker makes it."""
    return detected_factor(in_view, place_densities(candidates, in_view, detected_m, sigma_m), floor)


@given(
    in_view=hnp.arrays(bool, st.integers(1, 40)),
    f1=st.floats(0.5, 0.99),
    x_m=st.floats(-1e3, 1e3),
    sigma_m=st.floats(0.05, 5.0),
    floor=st.floats(1e-6, 1.0),
)
def test_factors_are_positive_and_sum_to_one(in_a_row, in_view, f1, x_m, sigma_m, floor):
    candidates = in_a_row(len(in_view))
    detected = np.array([[x_m, 0.0]])
    for factor in (
        missed_factor(in_view, f1),
        factor_at(candidates, in_view, detected, sigma_m, floor),
    ):
        assert factor.shape == in_view.shape
        assert np.all(factor > 0.0)
        assert factor.sum() == pytest.approx(1.0)


def test_c2_a_detection_leaves_places_outside_the_view_possible(in_a_row):
    """By hand: sigma 0.2 m, candidates 0, 1 and 2 sigma from the detection, the last out of view."""
    in_view = np.array([True, True, False])
    factor = factor_at(in_a_row(3), in_view, np.array([[0.0, 0.0]]), sigma_m=0.2, floor=0.1)
    np.testing.assert_allclose(factor / factor[0], [1.0, np.exp(-0.5), 0.1])
    assert factor[2] > 0.0


def test_c2_the_floor_also_holds_inside_the_view(in_a_row):
    factor = factor_at(in_a_row(50), np.ones(50, dtype=bool), np.array([[0.0, 0.0]]), 0.2, 0.1)
    np.testing.assert_allclose(factor[-1] / factor[0], 0.1)


def test_c3_a_silent_detector_makes_what_it_looked_at_less_likely():
    """The thesis' text has F1 inside and 1 - F1 outside, which would make it more likely."""
    factor = missed_factor(np.array([True, False, False]), f1=0.7)
    np.testing.assert_allclose(factor, np.array([0.3, 0.7, 0.7]) / 1.7)


def test_c4_no_f1_rules_a_place_out_or_makes_silence_a_find():
    assert usable_f1(1.0, 0.5, 0.99) == 0.99
    assert usable_f1(0.2, 0.5, 0.99) == 0.5
    assert usable_f1(0.7, 0.5, 0.99) == 0.7
    factor = missed_factor(np.array([True, False]), usable_f1(0.0, 0.5, 0.99))
    np.testing.assert_allclose(factor, [0.5, 0.5])


def test_each_of_several_detections_counts_in_full(in_a_row):
    detected = np.array([[0.0, 0.0], [1.8, 0.0]])
    factor = factor_at(in_a_row(10), np.ones(10, dtype=bool), detected, sigma_m=0.3, floor=0.01)
    assert factor[0] == pytest.approx(factor[9])
    np.testing.assert_allclose(factor, factor[::-1])
    assert factor[0] > 3.0 * factor[4]


def test_the_view_edge_cuts_a_detection(in_a_row):
    in_view = np.array([True, False])
    factor = factor_at(in_a_row(2), in_view, np.array([[0.2, 0.0]]), sigma_m=0.2, floor=0.1)
    assert factor[1] < factor[0]


def test_densities_by_hand(in_a_row):
    """Two detections: at the first candidate, and 0.2 m = 1 sigma beside the second; the third is hidden."""
    in_view = np.array([True, True, False])
    detected = np.array([[0.0, 0.0], [0.2, -0.2]])
    densities = place_densities(in_a_row(3), in_view, detected, sigma_m=0.2)
    by_hand = [[1.0, np.exp(-0.5), 0.0], [np.exp(-1.0), np.exp(-0.5), 0.0]]
    np.testing.assert_allclose(densities, by_hand)


def test_a_silent_detector_has_no_densities(in_a_row):
    assert place_densities(in_a_row(3), np.ones(3, dtype=bool), np.zeros((0, 2)), 0.2).shape == (0, 3)
