"""Searches with a detector that is not what was assumed: what is believed of it comes back to the truth."""

import numpy as np
import pytest

from robustnav_msgs_py.detector_statistics import ClassStatistics, DetectorStatistics
from robustnav_msgs_py.records import SearchPhase, SearchState
from robustnav_nodes.belief.learnt_statistics import LearntStatistics
from robustnav_nodes.belief.online_statistics import CountedLook
from robustnav_nodes.belief.search_lesson import SearchLesson
from robustnav_nodes.benchmarks.search_episode import BeliefMoment
from robustnav_nodes.benchmarks.search_scene import SearchScene
from robustnav_nodes.benchmarks.search_suite import NOISY, make_scene
from robustnav_nodes.benchmarks.variant_parts import Episode

LABEL = "thing"
SEARCHES = 16


@pytest.fixture(scope="module")
def scene() -> SearchScene:
    return make_scene("easy", 0)


def one_search(scene: SearchScene, number: int, learnt: LearntStatistics) -> None:
    """Search for a target of the scene as the graph would, with a person who says whether it is found."""
    episode = Episode.drawn(scene, seed=1, number=number)
    moments: list[BeliefMoment] = []
    result = episode.play(statistics=learnt.of(LABEL), moments=moments)
    space, record = scene.space, episode.target.detections[NOISY]
    lesson = SearchLesson(LABEL, learnt.online(LABEL), space.candidates)
    state = SearchState(phase=SearchPhase.SEARCHING, target=LABEL, episode=number + 1)
    lesson.hear(state)
    for pose in dict.fromkeys(moment.pose for moment in moments):
        densities = record.at(pose, len(space.candidates))
        lesson.look(CountedLook(in_view=space.observability.row(pose), densities=densities))
    found = result.is_success or result.is_wrong_stop
    last = moments[-1]
    place = int(np.argmax(np.where(space.observability.row(last.pose), last.probability, -1.0)))
    learnt_now = lesson.hear(
        SearchState(
            phase=SearchPhase.FOUND if found else SearchPhase.NOT_FOUND,
            target=LABEL,
            episode=number + 1,
            best_x_m=float(space.candidates.x_m[place]),
            best_y_m=float(space.candidates.y_m[place]),
        )
    )
    if found:
        learnt_now = lesson.hear_person(confirmed=result.is_success)
    if learnt_now is not None:
        learnt.learn(LABEL, learnt_now)


@pytest.mark.parametrize(
    "wrong", [ClassStatistics(precision=0.4, recall=0.3), ClassStatistics(precision=0.99, recall=0.95)]
)
def test_statistics_that_are_wrong_by_half_come_back(scene: SearchScene, wrong: ClassStatistics) -> None:
    """The scenes' detector has recall 0.6 and precision 0.8; searches see precision a little too high."""
    right = scene.targets[0].detections[NOISY].statistics
    learnt = LearntStatistics(DetectorStatistics(unknown_class=wrong), 5.0)
    for number in range(SEARCHES):
        one_search(scene, number, learnt)
    now = learnt.of(LABEL)
    for name, tolerance in (("recall", 0.12), ("precision", 0.15)):
        before, after, truth = (getattr(row, name) for row in (wrong, now, right))
        assert abs(after - truth) < tolerance
        assert abs(after - truth) < 0.6 * abs(before - truth)
