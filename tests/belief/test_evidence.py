import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.detector_statistics import ClassStatistics, RecallByRange
from robustnav_nodes.belief.evidence import (
    F1Evidence,
    LikelihoodEvidence,
    evidence_of,
    false_alarms_a_look,
)
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.belief.parameters import BeliefParameters

IN_VIEW = np.array([True, True, True, False])
SILENT = np.zeros((0, 4))
BY_HAND = LikelihoodEvidence(recall=0.6, false_alarms=0.1)


def test_a_silent_look_by_hand():
    """Missed in 0.4 of the looks at where it is; out of view nothing was said."""
    np.testing.assert_allclose(BY_HAND.factor(IN_VIEW, SILENT), [0.4, 0.4, 0.4, 1.0])


def test_one_detection_by_hand():
    """Half of its density is at the first; a false alarm lies there in 1 of 3 x 0.1: 0.4 + 0.6 x 0.5 x 30."""
    factor = BY_HAND.factor(IN_VIEW, np.array([[1.0, 0.5, 0.5, 0.0]]))
    np.testing.assert_allclose(factor, [0.4 + 0.6 * 15.0, 0.4 + 0.6 * 7.5, 0.4 + 0.6 * 7.5, 1.0])


def test_two_detections_by_hand():
    """One of them may be the target: their ratios add up, they do not multiply."""
    factor = BY_HAND.factor(IN_VIEW, np.array([[1.0, 0.5, 0.5, 0.0], [0.0, 0.0, 1.0, 0.0]]))
    np.testing.assert_allclose(
        factor, 0.4 + 0.6 * np.array([15.0, 7.5, 37.5, 1.0]) * [1, 1, 1, 0] + [0, 0, 0, 0.6]
    )


def test_a_detection_counts_as_well_as_it_fits_the_best_place():
    """One at 1e-6 of its peak is as good as silence; at half its peak, it is worth half."""
    far = BY_HAND.factor(IN_VIEW, np.array([[0.0, 0.0, 1e-6, 0.0]]))
    np.testing.assert_allclose(far, [0.4, 0.4, 0.4, 1.0], atol=1e-4)
    half = BY_HAND.factor(IN_VIEW, np.array([[0.0, 0.0, 0.5, 0.0]]))
    np.testing.assert_allclose(half, [0.4, 0.4, 0.4 + 0.6 * 0.5 * 30.0, 1.0])


DENSITIES = st.lists(st.lists(st.floats(0.0, 1.0), min_size=4, max_size=4), max_size=5)


@given(
    view=st.lists(st.booleans(), min_size=4, max_size=4),
    rows=DENSITIES,
    recall=st.floats(0.01, 0.99),
    false_alarms=st.floats(1e-6, 1.0),
)
def test_outside_the_view_a_look_says_nothing_and_a_detection_never_counts_less_than_silence(
    view, rows, recall, false_alarms
):
    in_view = np.array(view)
    densities = np.array(rows).reshape(-1, 4) * in_view
    factor = LikelihoodEvidence(recall=recall, false_alarms=false_alarms).factor(in_view, densities)
    assert np.all(factor[~in_view] == 1.0)
    assert np.all(factor[in_view] >= 1.0 - recall - 1e-12)


def test_recall_falls_with_the_distance_by_hand():
    """0.8 near by, half of it lost at 4 m, and no more beyond."""
    evidence = LikelihoodEvidence(recall=0.8, false_alarms=0.1, recall_loss=0.5, range_max_m=4.0)
    distance_m = np.array([0.0, 2.0, 4.0, 8.0])
    factor = evidence.factor(np.ones(4, dtype=bool), SILENT, distance_m)
    np.testing.assert_allclose(1.0 - factor, [0.8, 0.6, 0.4, 0.4])


@given(distance_m=st.lists(st.floats(0.0, 20.0), min_size=2, max_size=8), loss=st.floats(0.0, 1.0))
def test_silence_about_what_is_farther_says_no_more(distance_m, loss):
    evidence = LikelihoodEvidence(recall=0.9, false_alarms=0.1, recall_loss=loss, range_max_m=5.0)
    ordered = np.sort(distance_m)
    count = len(ordered)
    factor = evidence.factor(np.ones(count, dtype=bool), np.zeros((0, count)), ordered)
    assert np.all(np.diff(factor) >= 0.0)
    assert np.all(factor >= 0.1 - 1e-12)


def test_false_alarms_by_hand():
    """Fires truly in 0.6 x 0.1 of the looks, and at nothing once for four of these: 0.015."""
    statistics = ClassStatistics(precision=0.8, recall=0.6)
    assert false_alarms_a_look(statistics, share_in_view=0.1, least=1e-3) == pytest.approx(0.015)


@pytest.mark.parametrize(("precision", "false_alarms"), [(1.0, 1e-3), (0.0, 1.0), (1e-6, 1.0)])
def test_false_alarms_stay_in_their_limits(precision, false_alarms):
    statistics = ClassStatistics(precision=precision, recall=0.6)
    assert false_alarms_a_look(statistics, share_in_view=0.1, least=1e-3) == false_alarms


@given(
    precision=st.floats(0.05, 0.999),
    recall=st.floats(0.01, 1.0),
    share=st.floats(0.001, 0.04),  # with more, a bad detector would fire more than once a look
)
def test_the_firings_that_are_implied_have_the_precision_of_the_statistics(precision, recall, share):
    statistics = ClassStatistics(precision=precision, recall=recall)
    false = false_alarms_a_look(statistics, share, least=0.0)
    true = recall * share
    assert true / (true + false) == pytest.approx(precision)


def test_the_parameters_choose_the_evidence():
    statistics = ClassStatistics(precision=0.8, recall=0.999)
    f1 = evidence_of(statistics, 0.1, BeliefParameters(evidence="f1", f1_max=0.85, detection_floor=0.03))
    assert f1 == F1Evidence(f1=0.85, detection_floor=0.03)
    ratio = evidence_of(statistics, 0.1, BeliefParameters(recall_max=0.95, recall_loss=0.2, range_max_m=3.0))
    assert ratio == LikelihoodEvidence(
        recall=0.95, false_alarms=pytest.approx(0.999 * 0.1 / 4), recall_loss=0.2, range_max_m=3.0
    )


def test_f1_evidence_by_hand():
    """C2, C3: a miss weighs 1 - F1 in view and F1 outside, a detection its density or the floor."""
    evidence = F1Evidence(f1=0.75, detection_floor=0.1)
    np.testing.assert_allclose(evidence.factor(IN_VIEW, SILENT), np.array([1, 1, 1, 3]) / 6)
    factor = evidence.factor(IN_VIEW, np.array([[1.0, 0.5, 0.0, 0.0], [0.0, 0.8, 0.0, 0.0]]))
    np.testing.assert_allclose(factor, np.array([1.0, 0.8, 0.1, 0.1]) / 2.0)


RECALL, FALSE_ALARMS, PAIRS, LOOKS, SEARCHES = 0.6, 0.3, 6, 5, 1500


def worst_calibration_error(in_a_row, evidence) -> float:
    """Of beliefs after simulated searches: by probability, how often the target was there, in sigmas off.

    Twelve places in pairs that the detector cannot tell apart; a view has some of the pairs; false alarms
    come as a Poisson stream, anywhere in view.
    """
    rng = np.random.default_rng(0)
    count = 2 * PAIRS
    believed, is_there = [], []
    for _ in range(SEARCHES):
        target = int(rng.integers(count))
        belief = LocationBelief.uniform(in_a_row(count))
        for _ in range(LOOKS):
            pairs = rng.random(PAIRS) < 0.5
            in_view = np.repeat(pairs, 2)
            if not pairs.any():
                continue
            fired = list(rng.choice(np.nonzero(pairs)[0], size=rng.poisson(FALSE_ALARMS)))
            if in_view[target] and rng.random() < RECALL:
                fired.append(target // 2)
            densities = np.zeros((len(fired), count))
            for row, pair in enumerate(fired):
                densities[row, 2 * pair : 2 * pair + 2] = 1.0
            belief = belief.updated(evidence.factor(in_view, densities), 1e-12)
        believed.append(belief.probability)
        is_there.append(np.arange(count) == target)
    probability, there = np.concatenate(believed), np.concatenate(is_there)
    worst = 0.0
    for low, high in zip([0.0, 0.02, 0.05, 0.1, 0.2, 0.35], [0.02, 0.05, 0.1, 0.2, 0.35, 1.0], strict=True):
        of_bin = (probability >= low) & (probability < high)
        off = there[of_bin].sum() - probability[of_bin].sum()
        sigma = np.sqrt((probability[of_bin] * (1.0 - probability[of_bin])).sum())
        worst = max(worst, abs(off) / sigma)
    return worst


def test_the_belief_is_a_calibrated_probability(in_a_row):
    """Where it says p, the target is in a part p of the cases; the pairs make two places vary as one."""
    evidence = LikelihoodEvidence(recall=RECALL, false_alarms=FALSE_ALARMS)
    assert worst_calibration_error(in_a_row, evidence) < 4.0 * np.sqrt(2.0)


@pytest.mark.parametrize(
    "evidence",
    [
        LikelihoodEvidence(recall=RECALL, false_alarms=0.1 * FALSE_ALARMS),
        LikelihoodEvidence(recall=0.95, false_alarms=FALSE_ALARMS),
        F1Evidence(f1=2 / 3, detection_floor=0.02),
    ],
    ids=["too few false alarms", "too much recall", "f1"],
)
def test_with_other_statistics_or_other_evidence_it_would_not_be(in_a_row, evidence):
    assert worst_calibration_error(in_a_row, evidence) > 10.0


def test_a_silent_look_counts_less_against_far_places_where_recall_by_range_is_known():
    """Recall 0.9 at 1 m, 0.5 at 2 m, 0 (taken as 0.05) at 4 m; by the mean alone 0.6 everywhere."""
    by_range = RecallByRange(edges_m=(0.0, 2.0, 2.5, 5.5), recall=(0.9, 0.4, 0.0))
    told = ClassStatistics(precision=0.8, recall=0.6, recall_by_range=by_range)
    distance_m = np.array([1.0, 2.0, 4.0, 1.0])
    factor = evidence_of(told, 0.1, BeliefParameters()).factor(IN_VIEW, SILENT, distance_m)
    np.testing.assert_allclose(factor, [0.1, 0.5, 0.95, 1.0])
    plain = evidence_of(ClassStatistics(precision=0.8, recall=0.6), 0.1, BeliefParameters())
    np.testing.assert_allclose(plain.factor(IN_VIEW, SILENT, distance_m), [0.4, 0.4, 0.4, 1.0])


def test_recall_by_range_leaves_the_rate_of_false_alarms_alone():
    by_range = RecallByRange(edges_m=(0.0, 2.0), recall=(0.1,))
    told = ClassStatistics(precision=0.8, recall=0.6, recall_by_range=by_range)
    plain = ClassStatistics(precision=0.8, recall=0.6)
    rates = [evidence_of(row, 0.1, BeliefParameters()).false_alarms for row in (told, plain)]
    assert rates[0] == rates[1]
