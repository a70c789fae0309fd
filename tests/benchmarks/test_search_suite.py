import dataclasses

import numpy as np
import pytest

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene
from robustnav_nodes.benchmarks.search_suite import (
    CLASSES,
    DESTINATION_M,
    DIFFICULTIES,
    NOISY,
    PERFECT,
    make_scene,
    starts_of,
)

EASY_SEEDS = range(12)


@pytest.fixture(scope="module")
def scenes() -> list[SearchScene]:
    return [make_scene("easy", seed) for seed in EASY_SEEDS] + [
        make_scene("medium", 0),
        make_scene("hard", 0),
    ]


@pytest.fixture(scope="module")
def easy(scenes) -> list[SearchScene]:
    return [scene for scene in scenes if scene.difficulty == "easy"]


def arrays_of(scene: SearchScene) -> dict[str, np.ndarray]:
    """Everything that an episode depends on."""
    graph, observability = scene.space.graph, scene.space.observability
    found = {
        "x": graph.x_m,
        "y": graph.y_m,
        "yaw": graph.yaw_rad,
        "successors": graph.successors,
        "candidates": scene.space.candidates.position_m,
        "seen_start": observability.seen_start,
        "seen": observability.seen,
        "starts": scene.starts,
    }
    for target in scene.targets:
        found |= {f"{target.label} view": target.in_view, f"{target.label} end": target.destination}
        for detector, record in target.detections.items():
            for name in ("pose", "start", "candidate", "weight"):
                found[f"{target.label} {detector} {name}"] = getattr(record, name)
            known = record.statistics
            found[f"{target.label} {detector} known"] = np.array([known.precision, known.recall])
    return found


@pytest.mark.parametrize("difficulty", ["easy", "medium"])
def test_a_scene_is_always_the_same(difficulty):
    one, other = (arrays_of(make_scene(difficulty, 3)) for _ in range(2))
    assert one.keys() == other.keys()
    for name, array in one.items():
        np.testing.assert_array_equal(array, other[name], err_msg=name)


def test_scenes_differ_by_seed_and_by_difficulty(scenes):
    shapes = {scene.space.graph.x_m.tobytes() + scene.space.candidates.x_m.tobytes() for scene in scenes}
    assert len(shapes) == len(scenes)
    assert len({scene.name for scene in scenes}) == len(scenes)


def test_sizes_lie_within_the_bounds_of_the_difficulty(scenes):
    for scene in scenes:
        kind = DIFFICULTIES[scene.difficulty]
        assert kind.poses[0] <= len(scene.space.graph) <= kind.poses[1]
        assert kind.candidates[0] <= len(scene.space.candidates) <= kind.candidates[1]
        assert len(scene.targets) == CLASSES


def test_every_pose_can_be_reached_from_every_other(scenes):
    """From pose 0, and back: the graph is that of one connected floor."""
    for scene in scenes:
        graph = scene.space.graph
        assert np.isfinite(graph.steps_from(0)).all()
        for start in range(0, len(graph), 97):
            assert np.isfinite(graph.steps_from(start)[0])


def test_each_target_is_at_a_place_and_seen_from_where_that_place_is(scenes):
    for scene in scenes:
        columns = [scene.space.observability.column(j).tobytes() for j in range(len(scene.space.candidates))]
        for target in scene.targets:
            assert target.in_view.any()
            assert target.in_view.tobytes() in columns


def test_a_search_may_end_where_the_target_is_in_view_and_near(easy):
    """Within half a metre of the nearest view; the place is where the perfect detector says."""
    for scene in easy:
        space = scene.space
        for target in scene.targets:
            record = target.detections[PERFECT]
            place = int(record.candidate[np.argmax(record.weight)])
            distance_m = np.hypot(
                space.graph.x_m - space.candidates.x_m[place], space.graph.y_m - space.candidates.y_m[place]
            )
            nearest_m = distance_m[target.in_view].min()
            assert target.destination.any()
            assert not (target.destination & ~target.in_view).any()
            assert DESTINATION_M == 0.5
            assert np.all(distance_m[target.destination] <= nearest_m + 0.5 + 1e-9)
            assert np.all(target.destination[target.in_view & (distance_m <= nearest_m + 0.49)])


def test_starts_are_three_actions_or_more_from_a_view(scenes):
    """And every pose that is so far away is a start."""
    for scene in scenes:
        for target in scene.targets[:4]:
            starts = starts_of(scene, target)
            is_start = np.isin(np.arange(len(scene.space.graph)), starts)
            for pose in range(0, len(is_start), max(1, len(is_start) // 40)):
                away = scene.space.graph.steps_from(pose)[target.in_view].min()
                assert is_start[pose] == (away >= 3)


def test_only_the_starts_of_a_scene_are_starts_and_all_where_none_is_far_enough(easy):
    scene, target = easy[0], easy[0].targets[0]
    far = starts_of(scene, target)
    some = dataclasses.replace(scene, starts=far[::2])
    assert starts_of(some, target).tolist() == far[::2].tolist()
    near = np.nonzero(target.in_view)[0].astype(np.int32)
    assert starts_of(dataclasses.replace(scene, starts=near), target).tolist() == near.tolist()


def test_the_perfect_detector_fires_wherever_the_target_is_in_view_and_nowhere_else(scenes):
    for scene in scenes:
        for target in scene.targets:
            record = target.detections[PERFECT]
            assert record.pose.tolist() == np.nonzero(target.in_view)[0].tolist()
            assert record.statistics == ClassStatistics(precision=1.0, recall=1.0)
            peaks = record.candidate[record.weight == 1.0]
            assert len(set(peaks.tolist())) == 1


def test_detections_are_of_what_their_pose_has_in_view(scenes):
    """Densities in 0..1, the largest 1, poses ascending: what a policy may take for granted."""
    for scene in scenes:
        for target in scene.targets[:8]:
            for record in target.detections.values():
                assert np.all(np.diff(record.pose) >= 0)
                assert record.start[-1] == len(record.candidate) == len(record.weight)
                for pose in np.unique(record.pose)[::5]:
                    densities = record.at(int(pose), len(scene.space.candidates))
                    assert len(densities) == np.count_nonzero(record.pose == pose)
                    assert densities.max(axis=1).tolist() == [1.0] * len(densities)
                    assert densities.min() >= 0.0
                    assert not densities[:, ~scene.space.observability.row(int(pose))].any()


def test_what_a_record_says_at_a_pose_by_hand():
    """Two detections at pose 3, one at pose 5, none at 4."""
    record = DetectionRecord(
        statistics=ClassStatistics(),
        pose=np.array([3, 3, 5], dtype=np.int32),
        start=np.array([0, 2, 3, 4]),
        candidate=np.array([0, 2, 1, 2], dtype=np.int32),
        weight=np.array([1.0, 0.5, 1.0, 1.0]),
    )
    assert record.at(3, 4).tolist() == [[1.0, 0.0, 0.5, 0.0], [0.0, 1.0, 0.0, 0.0]]
    assert record.at(5, 4).tolist() == [[0.0, 0.0, 1.0, 0.0]]
    assert record.at(4, 4).shape == (0, 4)


def test_the_noisy_detector_has_the_recall_and_precision_that_its_statistics_promise(scenes):
    """Over all poses, targets and scenes. A firing that has the target in view may be true or false, so that
    the rates are told by where it fires: recall + false alarms at poses with the target in view, false
    alarms at others. Both counts are sums of independent yes-or-no draws: 4 standard deviations of each
    (once in 10 000 sets of scenes) are about 3 % of the true and 10 % of the false alarms here.
    """
    inside, outside = np.zeros(3), np.zeros(3)  # counted, expected, variance
    true_expected, all_expected = 0.0, 0.0
    for scene in scenes:
        sees_any = np.diff(scene.space.observability.seen_start) > 0
        for target in scene.targets:
            record = target.detections[NOISY]
            known = record.statistics
            assert 0.7 <= known.precision <= 0.9
            assert 0.5 <= known.recall <= 0.7
            views, poses = np.count_nonzero(target.in_view), np.count_nonzero(sees_any)
            p_false = known.recall * views * (1.0 / known.precision - 1.0) / poses
            fired_in_view = np.count_nonzero(target.in_view[record.pose])
            hit = known.recall * (1.0 - known.recall)
            false = p_false * (1.0 - p_false)
            inside += [fired_in_view, (known.recall + p_false) * views, (hit + false) * views]
            elsewhere = poses - views
            outside += [len(record.pose) - fired_in_view, p_false * elsewhere, false * elsewhere]
            true_expected += known.recall * views
            all_expected += known.recall * views / known.precision
    for counted, expected, variance in (inside, outside):
        assert abs(counted - expected) < 4.0 * np.sqrt(variance)
    fired = inside[0] + outside[0]
    true = inside[0] - (inside[1] - true_expected)
    assert true / fired == pytest.approx(true_expected / all_expected, abs=0.02)


def test_a_true_detection_lies_near_the_target(easy):
    """0.5 m in each direction: half of them within 0.59 m, where candidates are dense enough to tell."""
    off_m = []
    for scene in easy:
        candidates = scene.space.candidates
        for target in scene.targets:
            perfect, noisy = target.detections[PERFECT], target.detections[NOISY]
            place = int(perfect.candidate[np.argmax(perfect.weight)])
            for number in np.nonzero(target.in_view[noisy.pose])[0]:
                span = slice(noisy.start[number], noisy.start[number + 1])
                peak = noisy.candidate[span][np.argmax(noisy.weight[span])]
                off_m.append(
                    np.hypot(
                        candidates.x_m[peak] - candidates.x_m[place],
                        candidates.y_m[peak] - candidates.y_m[place],
                    )
                )
    assert 0.3 < np.median(off_m) < 0.7


def test_an_unknown_difficulty_is_refused():
    with pytest.raises(KeyError, match="impossible"):
        make_scene("impossible", 0)
