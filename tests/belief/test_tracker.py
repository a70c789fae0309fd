import dataclasses

import numpy as np
import pytest

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.belief.tracker import BeliefTracker
from robustnav_nodes.belief.view_gate import Verdict
from robustnav_nodes.search_space.camera_view import build_camera_view

LIKELIHOOD = BeliefParameters(
    camera_forward_m=0.0,
    range_min_m=0.5,
    range_max_m=4.0,
    detection_sigma_m=0.5,
    detection_floor=0.1,
    recall_loss=0.5,
)
PARAMETERS = dataclasses.replace(LIKELIHOOD, evidence="f1")  # the thesis'
SILENT = np.zeros((0, 3))
ORIGIN = Pose2D(x_m=0.0, y_m=0.0)


def tracker_with(parameters: BeliefParameters) -> BeliefTracker:
    """A floor of 6 m x 2 m with four candidates along y = 1.1 m, at x = 1.1, 2.1, 3.1 and 5.1 m."""
    mask = np.zeros((10, 30), dtype=np.int8)
    mask[5, [5, 10, 15, 25]] = 100
    view = build_camera_view(
        OccupancyMap(cells=np.zeros((40, 120), dtype=np.int8), resolution_m=0.05, origin=ORIGIN),
        OccupancyMap(cells=mask, resolution_m=0.2, origin=ORIGIN),
        parameters,
    )
    statistics = ClassStatistics(precision=0.75, recall=0.75)
    return BeliefTracker(view=view, statistics=statistics, parameters=parameters)


@pytest.fixture
def tracker() -> BeliefTracker:
    return tracker_with(PARAMETERS)


WEST = Pose2D(x_m=0.3, y_m=1.1)  # looks east; sees the first three


def test_a_silent_view_by_hand(tracker):
    """F1 = 0.75: three in view weigh 0.25, one out of view 0.75."""
    assert tracker.observe(WEST, SILENT) is Verdict.COUNTED
    np.testing.assert_allclose(tracker.belief.probability, np.array([1, 1, 1, 3]) / 6)


def test_a_detection_by_hand(tracker):
    """At the second: 1 there, exp(-2) on the neighbours 1 m away, the floor 0.1 out of view."""
    tracker.observe(WEST, np.array([[2.1, 1.1, 0.7]]))
    weights = np.array([np.exp(-2.0), 1.0, np.exp(-2.0), 0.1])
    np.testing.assert_allclose(tracker.belief.probability, weights / weights.sum())


def likelihood_ratio_by_hand(view, reported):
    """Recall 0.75, of which half is lost at 4 m; three in view at 0.8, 1.8 and 2.8 m, the last at 4.8 m.

    reported: of one false alarm, the part at each of the three. False alarms: recall x share in view x 1/3.
    """
    recall = 0.75 * (1.0 - 0.5 * np.array([0.8, 1.8, 2.8]) / 4.0)
    false_alarms = 0.75 * view.share_in_view() / 3.0
    return np.append(1.0 - recall + recall * np.array(reported) * 3 / false_alarms, 1.0)


def test_a_silent_view_by_hand_as_a_likelihood_ratio():
    tracker = tracker_with(LIKELIHOOD)
    tracker.observe(WEST, SILENT)
    ratio = likelihood_ratio_by_hand(tracker._view, [0.0, 0.0, 0.0])
    np.testing.assert_allclose(tracker.belief.probability, ratio / ratio.sum())


def test_a_detection_by_hand_as_a_likelihood_ratio():
    """At the second, with exp(-2) of its density at the two beside it, 1 m away."""
    tracker = tracker_with(LIKELIHOOD)
    tracker.observe(WEST, np.array([[2.1, 1.1, 0.7]]))
    reported = np.array([np.exp(-2.0), 1.0, np.exp(-2.0)]) / (1.0 + 2.0 * np.exp(-2.0))
    ratio = likelihood_ratio_by_hand(tracker._view, reported)
    np.testing.assert_allclose(tracker.belief.probability, ratio / ratio.sum())


@pytest.mark.parametrize("beyond_m", [3.0, 5.0, 10.0, 100.0, 1e6])
@pytest.mark.parametrize("parameters", [PARAMETERS, LIKELIHOOD], ids=["f1", "likelihood"])
def test_a_detection_far_from_every_place_finds_nothing(parameters, beyond_m):
    """A depth that is wrong, a detection behind a wall: no place in view rises for it."""
    tracker = tracker_with(parameters)
    before = tracker.belief.probability
    tracker.observe(WEST, np.array([[3.1 + beyond_m, 1.1 + beyond_m, 0.0]]))
    assert np.all(tracker.belief.probability[:3] <= before[:3] * (1.0 + 1e-4))


def test_looking_twice_from_one_pose_tells_nothing_new(tracker):
    tracker.observe(WEST, SILENT)
    before = tracker.belief
    assert tracker.observe(WEST, SILENT) is Verdict.SEEN_BEFORE
    assert tracker.observe(WEST, np.array([[2.1, 1.1]])) is Verdict.SEEN_BEFORE
    assert tracker.belief is before


def test_a_view_while_driving_does_not_count(tracker):
    before = tracker.belief
    assert tracker.observe(WEST, SILENT, linear_m_s=0.3) is Verdict.MOVING
    assert tracker.belief is before


def test_a_view_of_nothing_changes_nothing(tracker):
    tracker.observe(Pose2D(x_m=0.3, y_m=1.1, yaw_rad=np.pi), SILENT)
    np.testing.assert_allclose(tracker.belief.probability, 0.25)


@pytest.mark.parametrize("places", [np.array([[np.nan, 0.0]]), np.array([[np.inf, 0.0, 0.0]]), np.zeros(3)])
def test_places_that_make_no_sense_are_refused_and_do_not_use_up_the_view(tracker, places):
    with pytest.raises(BadMessageError, match="detected place"):
        tracker.observe(WEST, places)
    assert tracker.observe(WEST, SILENT) is Verdict.COUNTED


def test_on_a_grown_map_it_goes_on_with_what_it_knows(tracker):
    """A fifth candidate at x = 5.5 m weighs 1/4 beside 1/6, 1/6, 1/6, 1/2; a view counts once."""
    mask = np.zeros((10, 40), dtype=np.int8)
    mask[5, [5, 10, 15, 25, 27]] = 100
    grown = build_camera_view(
        OccupancyMap(cells=np.zeros((40, 160), dtype=np.int8), resolution_m=0.05, origin=ORIGIN),
        OccupancyMap(cells=mask, resolution_m=0.2, origin=ORIGIN),
        PARAMETERS,
    )
    tracker.observe(WEST, SILENT)
    tracker.move_to(grown)
    weights = np.array([1 / 6, 1 / 6, 1 / 6, 1 / 2, 1 / 4])
    np.testing.assert_allclose(tracker.belief.probability, weights / weights.sum())
    assert tracker.observe(WEST, SILENT) is Verdict.SEEN_BEFORE
    assert tracker.observe(Pose2D(x_m=2.1, y_m=1.1), SILENT) is Verdict.COUNTED
    assert np.argmax(tracker.belief.probability) != 4  # now in view of the grown map, and not found there


def test_one_detection_does_not_end_a_search_that_has_only_begun(tracker):
    """With floor >= 1 / confidence no probability gets past confidence / k from a uniform belief."""
    rng = np.random.default_rng(1)
    masked = np.where(rng.random((10, 30)) < 0.3, 100, 0).astype(np.int8)
    view = build_camera_view(
        OccupancyMap(cells=np.zeros((40, 120), dtype=np.int8), resolution_m=0.05, origin=ORIGIN),
        OccupancyMap(cells=masked, resolution_m=0.2, origin=ORIGIN),
        PARAMETERS,
    )
    statistics = ClassStatistics()
    for x_m in (1.0, 2.0, 3.0):
        one = BeliefTracker(view=view, statistics=statistics, parameters=PARAMETERS)
        one.observe(WEST, np.array([[x_m, 1.0]]))
        assert one.belief.probability.max() < 10.0 / len(view.candidates)
