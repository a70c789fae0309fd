"""Episodes in scenes made by hand: a row of poses, and a detector whose every word is written down."""

import dataclasses
import multiprocessing
import multiprocessing.resource_tracker
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.benchmarks.contestants import NEAREST_M, contestants
from robustnav_nodes.benchmarks.recorded_belief import RecordedBelief
from robustnav_nodes.benchmarks.search_episode import BeliefMoment, EpisodeResult, Outcome, run_episode
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene, SearchTarget
from robustnav_nodes.benchmarks.search_suite import NOISY, PERFECT, make_scene, starts_of
from robustnav_nodes.planner.parameters import VARIANTS, PlannerParameters
from robustnav_nodes.planner.search import Search
from robustnav_nodes.search_space.candidates import Candidates
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE, PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

STATISTICS = ClassStatistics(precision=0.9, recall=0.9)


def row_scene(
    sees: list[list[int]],
    target: int,
    fires: dict[int, int],
    *,
    destination: list[int] | None = None,
    candidates: int = 8,
) -> SearchScene:
    """Poses 1 m apart look north at candidates 1 m apart; `fires`: pose to candidate that is detected."""
    poses = len(sees)
    seen = np.array([candidate for row in sees for candidate in row], dtype=np.int32)
    starts = np.concatenate([[0], np.cumsum([len(row) for row in sees])])
    successors = np.full((poses, 4), NOWHERE, dtype=np.int32)
    successors[:-1, 0], successors[1:, 1] = np.arange(1, poses), np.arange(poses - 1)
    space = SearchSpace(
        graph=PoseGraph(
            x_m=np.arange(poses, dtype=np.float64),
            y_m=np.zeros(poses),
            yaw_rad=np.full(poses, 0.5 * np.pi),
            successors=successors,
            headings=4,
        ),
        candidates=Candidates(
            x_m=np.arange(candidates, dtype=np.float64), y_m=np.ones(candidates), size_m=0.2
        ),
        observability=Observability.of_rows(starts, seen, candidates),
    )
    at = sorted(fires)
    record = DetectionRecord(
        statistics=STATISTICS,
        pose=np.array(at, dtype=np.int32),
        start=np.arange(len(at) + 1),
        candidate=np.array([fires[pose] for pose in at], dtype=np.int32),
        weight=np.ones(len(at)),
    )
    ends = None if destination is None else np.isin(np.arange(poses), destination)
    thing = SearchTarget(
        label="mug",
        in_view=space.observability.column(target),
        destination=ends,
        detections={PERFECT: record},
    )
    return SearchScene(
        name="row",
        difficulty="by hand",
        space=space,
        targets=(thing,),
        starts=np.arange(poses, dtype=np.int32),
    )


def run(
    scene: SearchScene, start: int, moments: list[BeliefMoment] | None = None, **changes
) -> EpisodeResult:
    parameters = PlannerParameters(
        **({"variant": "lookahead", "dock": False, "docking_distance_m": 1.0} | changes)
    )
    rng = np.random.default_rng(0)
    return run_episode(scene, scene.targets[0], PERFECT, start, parameters, BeliefParameters(), rng, moments)


def test_a_success_on_the_shortest_way():
    scene = row_scene([[], [], [], [], [6]], target=6, fires={4: 6})
    result = run(scene, 1)
    assert (result.outcome, result.steps, result.shortest, result.spl) == (Outcome.SUCCESS, 3, 3, 1.0)
    assert len(result.decision_ms) == 3


def test_spl_of_a_detour_by_hand():
    """Two places one step back are looked at first: 1 + 1 + 3 steps where 3 would have done."""
    scene = row_scene([[0, 1], [], [], [], [6]], target=6, fires={4: 6})
    result = run(scene, 1)
    assert (result.outcome, result.steps, result.shortest) == (Outcome.SUCCESS, 5, 3)
    assert result.spl == pytest.approx(3 / 5)


def test_c13_a_target_in_view_at_the_start_costs_no_step():
    result = run(row_scene([[2], []], target=2, fires={0: 2}), 0)
    assert (result.outcome, result.steps, result.shortest, result.spl) == (Outcome.SUCCESS, 0, 1, 1.0)


@pytest.mark.parametrize(
    ("outcome", "steps", "shortest", "spl"),
    [
        (Outcome.SUCCESS, 4, 4, 1.0),
        (Outcome.SUCCESS, 8, 4, 0.5),
        (Outcome.SUCCESS, 0, 1, 1.0),
        (Outcome.SUCCESS, 3, 4, 1.0),
        (Outcome.LOCALISATION_ERROR, 4, 4, 0.0),
        (Outcome.DOCKING_ERROR, 4, 4, 0.0),
        (Outcome.OTHER_ERROR, 200, 4, 0.0),
    ],
)
def test_spl_by_hand(outcome, steps, shortest, spl):
    result = EpisodeResult(
        outcome=outcome, steps=steps, shortest=shortest, is_wrong_stop=False, decision_ms=()
    )
    assert result.spl == spl
    assert result.is_success == (outcome is Outcome.SUCCESS)


def test_a_false_alarm_that_ends_it_is_a_localisation_error():
    """The detector fires at the wrong place, from where the right one is not in view."""
    scene = row_scene([[], [3], [], [6]], target=6, fires={1: 3})
    result = run(scene, 0)
    assert (result.outcome, result.steps, result.spl) == (Outcome.LOCALISATION_ERROR, 1, 0.0)


@pytest.mark.parametrize("dock", [False, True])
def test_a_false_alarm_beside_the_target_is_a_success_as_the_target_is_in_view(dock):
    scene = row_scene([[], [3, 6], [], [6]], target=6, fires={1: 3})
    assert run(scene, 0, dock=dock, confirm_at_dock=False).outcome is Outcome.SUCCESS


def test_stopping_at_another_pose_than_one_that_counts_is_a_docking_error():
    """Found with the target in view at 1; it stops at 3, which looks straight at it, but should at 4."""
    sees = [[], [3], [3], [3], [3]]
    fires = dict.fromkeys((1, 2, 3, 4), 3)
    good = row_scene(sees, target=3, fires=fires, destination=[3])
    assert run(good, 0, dock=True).outcome is Outcome.SUCCESS
    bad = row_scene(sees, target=3, fires=fires, destination=[4])
    result = run(bad, 0, dock=True)
    assert (result.outcome, result.steps, result.shortest) == (Outcome.DOCKING_ERROR, 3, 4)
    assert run(bad, 0, dock=False).outcome is Outcome.SUCCESS  # a destination is for docking alone


def test_a_false_alarm_that_is_docked_to_is_a_localisation_error():
    scene = row_scene([[], [2], [2], [], [6]], target=6, fires={1: 2, 2: 2}, destination=[4])
    assert run(scene, 0, dock=True).outcome is Outcome.LOCALISATION_ERROR


# Candidate 2 is at the dock 2, candidate 6 at the dock 6; poses 1 and 2 see both, or not, as the test has it.
DOCKED_OUT_OF_SIGHT = [[], [2, 6], [2], [], [], [], [6]]
DOCKED_IN_SIGHT = [[], [2], [2, 6], [], [], [], [6]]


def errors(scene, **changes) -> tuple[Outcome, bool]:
    result = run(scene, 0, dock=True, **changes)
    return result.outcome, result.is_wrong_stop


@pytest.mark.parametrize(
    ("sees", "ends", "expected"),
    [
        pytest.param(
            [[], [2], [2], [], [], [], [6]],
            [6],
            (Outcome.LOCALISATION_ERROR, True),
            id="a false alarm, docked to out of sight of the target",
        ),
        pytest.param(
            DOCKED_IN_SIGHT,
            [6],
            (Outcome.LOCALISATION_ERROR, False),
            id="a false alarm whose dock sees the target, though not as it should",
        ),
        pytest.param(
            DOCKED_IN_SIGHT,
            [2, 6],
            (Outcome.SUCCESS, False),
            id="a false alarm whose dock counts",
        ),
        pytest.param(
            DOCKED_OUT_OF_SIGHT,
            [6],
            (Outcome.DOCKING_ERROR, True),
            id="found in view, then docked elsewhere",
        ),
        pytest.param(
            [[], [2, 6], [2, 6], [], [], [], [6]],
            [6],
            (Outcome.DOCKING_ERROR, False),
            id="found in view, then docked to where it is still in view but does not count",
        ),
    ],
)
def test_three_ways_to_stop_at_the_wrong_place_by_hand(sees, ends, expected):
    """The detector fires at candidate 2 from poses 1 and 2; the target is candidate 6."""
    scene = row_scene(sees, target=6, fires={1: 2, 2: 2}, destination=ends)
    assert errors(scene) == expected


def test_found_where_it_would_dock_is_told_by_what_is_in_view_there():
    """No step of a docking is left to take: the find is where it stops, with the target in view or not."""
    sees = [[], [], [], [3], [3]]
    in_view = row_scene(sees, target=3, fires={3: 3}, destination=[4])
    assert errors(in_view) == (Outcome.DOCKING_ERROR, False)
    false_alarm = row_scene([[], [], [], [3], [6]], target=6, fires={3: 3}, destination=[4])
    assert errors(false_alarm) == (Outcome.LOCALISATION_ERROR, True)


def test_a_rejected_docking_does_not_count_where_another_find_ends_it():
    """At 1, the target (6) in view, it goes for 2 and finds nothing there; at 3 a false alarm ends it."""
    sees = [[], [2, 6], [2], [3], [6]]
    scene = row_scene(sees, target=6, fires={1: 2, 3: 3}, destination=[4], candidates=40)
    moments: list[BeliefMoment] = []
    result = run(scene, 0, moments, dock=True, p_found=0.7)
    assert [moment.pose for moment in moments] == [0, 1, 2, 3]
    assert (result.outcome, result.is_wrong_stop) == (Outcome.LOCALISATION_ERROR, True)


def test_not_found_is_no_wrong_stop():
    scene = row_scene([[0, 1], [], [], [], [6]], target=6, fires={})
    assert errors(scene) == (Outcome.OTHER_ERROR, False)


@pytest.mark.parametrize("changes", [{"max_steps": 2}, {"max_steps": 50}])
def test_what_is_not_found_in_time_is_another_error(changes):
    """Because there was no time, or because the detector is blind."""
    scene = row_scene([[0, 1], [], [], [], [6]], target=6, fires={4: 6} if changes["max_steps"] == 2 else {})
    result = run(scene, 1, **changes)
    assert result.outcome is Outcome.OTHER_ERROR
    assert result.steps <= changes["max_steps"]


def test_found_but_not_reached_in_time_is_another_error():
    scene = row_scene([[], [3], [], [3]], target=3, fires={1: 3, 3: 3}, destination=[3])
    assert run(scene, 0, dock=True, max_steps=2).outcome is Outcome.OTHER_ERROR


def test_without_a_destination_docking_must_end_with_the_target_in_view():
    scene = row_scene([[], [3], [3], [3]], target=3, fires=dict.fromkeys((1, 2, 3), 3))
    assert run(scene, 0, dock=True).outcome is Outcome.SUCCESS


def test_the_detectors_word_counts_once_for_each_pose():
    """A walk at random over three poses: once all were looked from, the belief stays what it is."""
    moments: list[BeliefMoment] = []
    scene = row_scene([[0], [1], [2]], target=2, fires={0: 0})
    run(scene, 0, moments, variant="random", max_steps=40, p_found=0.9999, ending="view")
    assert len(moments) == 41
    assert moments[0].pose == 0
    known: set[int] = set()
    for before, after in zip([None, *moments], moments, strict=False):
        is_new = after.pose not in known
        known.add(after.pose)
        if before is not None:
            assert np.array_equal(before.probability, after.probability) != is_new
    assert known == {0, 1, 2}


EASY = [(seed, number) for seed in range(3) for number in range(0, 33, 3)]


@pytest.fixture(scope="module")
def easy() -> dict[int, SearchScene]:
    return {seed: make_scene("easy", seed) for seed in range(3)}


def episode(scene: SearchScene, number: int, variant: str, detector: str = NOISY, **changes) -> tuple:
    """Arguments of `run_episode`, all decided by `number`."""
    target = scene.targets[number]
    start = int(np.random.default_rng(number).choice(starts_of(scene, target)))
    thesis = variant in ("pomp", "pomp_be", "pomp_pd", "pomp_be_pd")
    quick = {"simulations": 32, "time_budget_s": 60.0, "docking_distance_m": NEAREST_M}
    parameters = PlannerParameters(variant=variant, **(quick | changes))
    belief = BeliefParameters(evidence="f1" if thesis else "likelihood")
    return scene, target, detector, start, parameters, belief, np.random.default_rng(number)


@pytest.mark.parametrize(("seed", "number"), EASY)
def test_with_a_perfect_detector_ours_always_succeeds_in_an_easy_scene(easy, seed, number):
    result = run_episode(*episode(easy[seed], number, "lookahead", PERFECT, dock=False))
    assert result.outcome is Outcome.SUCCESS
    assert result.spl > 0.1
    docked = run_episode(*episode(easy[seed], number, "lookahead", PERFECT))
    assert docked.outcome is Outcome.SUCCESS


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_decision_takes_time(easy, variant):
    """Also of the rules that do not look at a clock; docking decides nothing."""
    result = run_episode(*episode(easy[0], 4, variant, max_steps=40))
    assert 0 < len(result.decision_ms) <= result.steps
    assert min(result.decision_ms) > 0.0


@pytest.mark.parametrize("name", ["greedy_likelihood", "lookahead", "pomp_be_pd_likelihood"])
def test_few_finds_are_rejected_at_the_dock_and_none_without_news(easy, name):
    """In noisy episodes: a search does not wear itself out between docks."""
    (contestant,) = contestants([name], dock=True, simulations=32)
    parameters = dataclasses.replace(contestant.planner, confirm_at_dock=True)
    rejections = []
    for scene in easy.values():
        for number, target in enumerate(scene.targets):
            start = int(np.random.default_rng(number).choice(starts_of(scene, target)))
            rejections.append(rejections_in(scene, target, start, parameters, contestant.belief))
    assert sum(rejections) > 10
    assert max(rejections) <= 6


def rejections_in(scene: SearchScene, target: SearchTarget, start: int, planner, beliefs) -> int:
    """How often a find is rejected at its dock in one episode."""
    belief = RecordedBelief(scene.space, target.detections[NOISY], beliefs)
    search = Search(space=scene.space, parameters=planner, rng=np.random.default_rng(start))
    pose, rejected, looked = start, [], set()
    when_begun = 0
    while True:
        looked.add(pose)
        belief.look(pose)
        step = search.look(pose, scene.space.observability.row(pose), belief.probability)
        if step.message.startswith("looked again, not there"):
            assert len(looked) > when_begun  # something was seen since the docking began
            rejected.append(pose)
        if step.begins_docking:
            when_begun = len(looked)
        if not step.path:
            return len(rejected)
        pose = step.path[1]


def course_of(arguments: tuple) -> tuple:
    """Everything that an episode came to but the time that it took."""
    moments: list[BeliefMoment] = []
    result = run_episode(*arguments, moments)
    poses = [moment.pose for moment in moments]
    return result.outcome, result.steps, result.shortest, poses, moments[-1].probability.tolist()


@pytest.mark.parametrize("variant", VARIANTS)
def test_same_seed_same_episode(easy, variant):
    """The courses, not only the outcomes; the generator is made anew, the scene is not."""
    for number in (4, 5):
        one, other = (course_of(episode(easy[1], number, variant, max_steps=40)) for _ in range(2))
        assert one == other


@pytest.fixture
def another_process() -> Iterator[ProcessPoolExecutor]:
    """One that begins from nothing, as the benchmark's do; multiprocessing's own helper is stopped, too."""
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool
    multiprocessing.resource_tracker._resource_tracker._stop()


def test_same_seed_same_episode_in_another_process(easy, another_process):
    """Of the thesis' planner and of ours."""
    asked = [
        episode(easy[1], number, variant, max_steps=60)
        for variant in ("pomp_be_pd", "lookahead")
        for number in (4, 5, 6)
    ]
    there = [another_process.submit(run_episode, *arguments) for arguments in asked]
    again = [
        episode(easy[1], number, variant, max_steps=60)
        for variant in ("pomp_be_pd", "lookahead")
        for number in (4, 5, 6)
    ]
    here = [run_episode(*arguments) for arguments in again]
    for one, other in zip(here, (future.result(timeout=60) for future in there), strict=True):
        assert (one.outcome, one.steps, one.shortest) == (other.outcome, other.steps, other.shortest)
    assert len({result.steps for result in here}) > 2
