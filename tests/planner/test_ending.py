import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_nodes.planner.ending import (
    FirstDetection,
    LikelyLocation,
    LikelyView,
    ending_of,
    exit_threshold,
)
from robustnav_nodes.planner.parameters import VARIANTS
from robustnav_nodes.planner.policy import Sight
from robustnav_nodes.search_space.candidates import Candidates


def far_apart(count: int) -> Candidates:
    """Candidates that have nothing to do with each other."""
    return Candidates(x_m=3.0 * np.arange(count), y_m=np.zeros(count), size_m=0.2)


def sight(probability, in_view, rose=(), is_new=True) -> Sight:
    """A look: R, and the candidates in view and those that rose, by number."""
    numbers = np.arange(len(probability))
    return Sight(
        pose=0,
        probability=np.array(probability),
        in_view=np.isin(numbers, in_view),
        rose=np.isin(numbers, rose),
        is_new=is_new,
    )


def told(ending, *looks: Sight) -> int | None:
    """What `ending` says after the last of `looks`."""
    for look in looks:
        ending.looked(look)
    return ending.found(looks[-1])


def test_c1_tau_counts_candidates():
    assert exit_threshold(400, confidence=10.0, tau_max=0.5) == pytest.approx(10 / 400)


@given(candidates=st.integers(3, 5000), confidence=st.floats(1.1, 1e4))
def test_c5_tau_can_always_be_reached(candidates, confidence):
    """With k <= c the thesis' tau is 1 or more, and a search would never end."""
    assert 1.0 / candidates < exit_threshold(candidates, confidence, tau_max=0.5) <= 0.5


@given(candidates=st.integers(2, 50), tau_max=st.floats(0.01, 0.999))
def test_c5_knowing_nothing_never_ends_a_search(candidates, tau_max):
    """With two candidates the clamp at 0.5 would be reached before the first look."""
    assert 1.0 / candidates < exit_threshold(candidates, 10.0, tau_max) < 1.0


def test_a_single_candidate_need_only_be_in_view():
    tau = exit_threshold(1, 10.0, 0.5)
    assert told(LikelyLocation(1, tau), sight([1.0], [0])) == 0
    assert told(LikelyLocation(1, tau), sight([1.0], [])) is None
    assert told(LikelyView(far_apart(1), 0.9), sight([1.0], [0])) == 0
    assert told(LikelyView(far_apart(1), 0.9), sight([1.0], [])) is None


def test_the_first_detection_ends_it_at_the_likeliest_place_that_it_raised():
    ending = FirstDetection()
    assert told(ending, sight([0.6, 0.1, 0.2, 0.1], [0, 1, 2])) is None
    assert told(ending, sight([0.6, 0.1, 0.2, 0.1], [0, 1, 2], rose=[1, 2])) == 2


def test_a_detection_that_was_known_before_is_none():
    looks = sight([0.1, 0.9], [1], rose=[1], is_new=False)
    assert told(FirstDetection(), looks) is None


def test_a_likely_location_ends_it_by_hand():
    """0.3 in view beside 0.6 that is not."""
    look = sight([0.6, 0.1, 0.3], [1, 2])
    assert told(LikelyLocation(3, tau=0.3), look) == 2
    assert told(LikelyLocation(3, tau=0.31), look) is None
    assert LikelyLocation(3, tau=0.3).p_in_view(look) == 0.3


@pytest.mark.parametrize("ending", [FirstDetection(), LikelyLocation(3, 0.1), LikelyView(far_apart(3), 0.1)])
def test_a_view_of_nothing_finds_nothing(ending):
    look = sight([0.6, 0.1, 0.3], [])
    assert told(ending, look) is None
    assert ending.p_in_view(look) == 0.0


def test_views_to_commit_wants_the_same_place_to_rise_in_as_many_views():
    ending = LikelyLocation(3, tau=0.5, views=2)
    assert told(ending, sight([0.1, 0.8, 0.1], [1], rose=[1])) is None
    assert told(ending, sight([0.1, 0.8, 0.1], [1])) is None  # nothing fired: it is still one view
    assert told(ending, sight([0.8, 0.1, 0.1], [0, 1], rose=[0])) is None  # another place
    assert told(ending, sight([0.35, 0.6, 0.05], [0, 1], rose=[1])) == 1


def test_views_to_commit_does_not_settle_for_a_place_below_tau():
    """The likeliest has risen once, the one that has risen twice is not likely enough."""
    ending = LikelyLocation(2, tau=0.5, views=2)
    ending.looked(sight([0.4, 0.6], [0, 1], rose=[0]))
    assert told(ending, sight([0.4, 0.6], [0, 1], rose=[0, 1])) is None


def test_a_likely_view_ends_it_by_hand():
    """No place is likely, but together they are: 0.3 + 0.4 + 0.2 of 0.89 wanted."""
    probability = [0.3, 0.4, 0.1, 0.2]
    assert told(LikelyView(far_apart(4), 0.89), sight(probability, [0, 1, 3], rose=[3])) == 1
    assert told(LikelyView(far_apart(4), 0.91), sight(probability, [0, 1, 3], rose=[3])) is None
    assert told(LikelyView(far_apart(4), 0.89), sight(probability, [1, 2, 3], rose=[3])) is None
    assert LikelyView(far_apart(4), 0.89).p_in_view(sight(probability, [0, 3])) == pytest.approx(0.5)


def test_a_view_of_all_there_is_finds_nothing_where_nothing_was_detected():
    """R is about the candidates alone: together they hold all of it, also if the target is nowhere."""
    ending = LikelyView(far_apart(3), 0.9)
    assert told(ending, sight([0.3, 0.4, 0.3], [0, 1, 2])) is None
    assert told(ending, sight([0.1, 0.85, 0.05], [1, 2], rose=[1])) == 1  # now something was
    assert told(ending, sight([0.1, 0.85, 0.05], [0, 1])) == 1  # from elsewhere, where nothing is
    assert told(ending, sight([0.95, 0.03, 0.02], [0, 2])) is None  # but not at another place


@given(
    weights=st.lists(st.floats(1e-6, 1.0), min_size=1, max_size=8),
    views=st.lists(st.tuples(st.integers(0, 255), st.integers(0, 255)), min_size=1, max_size=5),
    kind=st.sampled_from(["detection", "location", "two views", "view"]),
)
def test_what_is_found_is_in_view_and_likely_enough(weights, views, kind):
    count = len(weights)
    ending = {
        "detection": FirstDetection(),
        "location": LikelyLocation(count, 0.2),
        "two views": LikelyLocation(count, 0.2, views=2),
        "view": LikelyView(far_apart(count), 0.4),
    }[kind]
    probability = np.array(weights) / np.sum(weights)
    for view, rose in views:
        in_view = np.array([bool(view >> j & 1) for j in range(count)])
        risen = in_view & np.array([bool(rose >> j & 1) for j in range(count)])
        look = Sight(pose=0, probability=probability, in_view=in_view, rose=risen, is_new=True)
        found = told(ending, look)
        if found is not None:
            assert in_view[found]
            assert ending.p_in_view(look) >= ending.threshold
        elif kind == "location":
            assert ending.p_in_view(look) < ending.threshold


@pytest.mark.parametrize("variant", VARIANTS)
def test_each_variant_ends_as_it_is_defined(parameters_with, variant):
    """POMP and BE at the first detection, PD and the baselines at tau = 10 / k, ours by what is in view."""
    kinds = {"pomp": FirstDetection, "pomp_be": FirstDetection}
    kinds |= dict.fromkeys(("pomp_pd", "pomp_be_pd", "random", "greedy"), LikelyLocation)
    ending = ending_of(parameters_with(variant=variant, p_found=0.8), far_apart(400))
    assert type(ending) is kinds.get(variant, LikelyView)
    assert ending.threshold == {FirstDetection: 0.0, LikelyLocation: 10 / 400, LikelyView: 0.8}[type(ending)]


@pytest.mark.parametrize("variant", ["pomp", "pomp_be_pd", "lookahead"])
def test_an_ending_that_is_asked_for_takes_the_place_of_the_variants_own(parameters_with, variant):
    kinds = {"detection": FirstDetection, "location": LikelyLocation, "view": LikelyView}
    for kind, expected in kinds.items():
        assert type(ending_of(parameters_with(variant=variant, ending=kind), far_apart(400))) is expected


def test_views_to_commit_is_taken_from_the_parameters(parameters_with):
    ending = ending_of(parameters_with(variant="pomp_be_pd", views_to_commit=2), far_apart(3))
    assert told(ending, sight([0.1, 0.8, 0.1], [1], rose=[1])) is None
    assert told(ending, sight([0.1, 0.8, 0.1], [1], rose=[1])) == 1


def test_the_middle_of_a_find_is_where_it_is_found():
    """Five locations 0.3 m apart hold 0.1, 0.25, 0.2, 0.24 and 0.16; another find lies 5 m away."""
    row = Candidates(x_m=np.array([0.0, 0.3, 0.6, 0.9, 1.2, 6.0]), y_m=np.zeros(6), size_m=0.2)
    probability = [0.1, 0.25, 0.2, 0.24, 0.16, 0.05]
    assert told(LikelyView(row, 0.9), sight(probability, range(6), rose=range(6))) == 2
