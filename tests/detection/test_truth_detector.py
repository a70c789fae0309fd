"""The simulated detector errs as its dials say, and errs alike when it looks again from the same place."""

import math
from collections.abc import Sequence

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.parameters import build
from robustnav_msgs_py.values import CameraModel, Pose2D, VisibleObjects
from robustnav_nodes.detection.dials import Dials, dials_by_class
from robustnav_nodes.detection.parameters import DetectionParameters
from robustnav_nodes.detection.truth_detector import TruthDetector

LABELS = ("mug", "book", "plant")
CAMERA = CameraModel(width=320, height=240, fx=277.0, fy=277.0, cx=160.0, cy=120.0)


def seen(labels: Sequence[int] = (0,), distance_m: float = 2.0, visible: float = 1.0) -> VisibleObjects:
    count = len(labels)
    return VisibleObjects(
        position_m=np.tile(np.array([0.0, 0.0, distance_m], np.float32), (count, 1)),
        label=np.array(labels, np.uint32),
        instance=np.arange(count, dtype=np.uint32),
        visible_fraction=np.full(count, visible, np.float32),
        box_px=np.tile(np.array([100.0, 90.0, 120.0, 110.0], np.float32), (count, 1)),
        stamp_ns=0,
    )


def detector(seed: int = 1, **dials: float) -> TruthDetector:
    parameters = build(DetectionParameters, dials)
    return TruthDetector(
        labels=LABELS,
        dials=dials_by_class(parameters, LABELS),
        seed=seed,
        view_spacing_m=0.3,
        view_headings=12,
    )


def poses(count: int) -> list[Pose2D]:
    """`count` poses in as many different cells."""
    return [Pose2D(x_m=0.3 * (index % 40) - 6.0, y_m=0.3 * (index // 40) - 6.0) for index in range(count)]


def test_a_perfect_detector_says_what_is_there() -> None:
    perfect = detector(recall=1.0, precision=1.0)
    for pose in poses(50):
        boxes = perfect.detect(seen((0, 2)), pose, CAMERA)
        assert list(boxes.label) == [0, 2]
        assert np.array_equal(boxes.box_px[0], [100.0, 90.0, 120.0, 110.0])


def test_recall_is_as_dialled() -> None:
    some = detector(recall=0.6, precision=1.0)
    hits = sum(len(some.detect(seen(), pose, CAMERA)) for pose in poses(1600))
    assert hits / 1600 == pytest.approx(0.6, abs=0.04)


def test_imagined_objects_are_as_many_as_precision_and_prevalence_say() -> None:
    lying = detector(recall=0.6, precision=0.5, prevalence=0.2)
    expected = 0.2 * 0.6  # right and imagined detections are equally many at precision 0.5
    count = sum(int(np.sum(lying.detect(seen((1,)), pose, CAMERA).label == 2)) for pose in poses(1600))
    assert count / 1600 == pytest.approx(expected, abs=0.03)


def test_an_imagined_object_is_another_one_in_view_or_nothing() -> None:
    lying = detector(recall=1.0, precision=0.05, prevalence=1.0)  # always imagines
    taken_for = lying.detect(seen((1,)), poses(1)[0], CAMERA)
    mug = list(taken_for.label).index(0)
    assert np.array_equal(taken_for.box_px[mug], [100.0, 90.0, 120.0, 110.0])
    for box in lying.detect(seen(()), poses(1)[0], CAMERA).box_px:
        assert 0.0 <= box[0] < box[2] <= CAMERA.width
        assert 0.0 <= box[1] < box[3] <= CAMERA.height


def test_looking_again_from_the_same_place_tells_nothing_new() -> None:
    some = detector(recall=0.5, precision=0.5, prevalence=0.5)
    for pose in poses(40):
        near = Pose2D(x_m=pose.x_m + 0.05, y_m=pose.y_m - 0.05, yaw_rad=pose.yaw_rad + 0.1)
        first, again = some.detect(seen((0, 1)), pose, CAMERA), some.detect(seen((0, 1)), near, CAMERA)
        assert np.array_equal(first.label, again.label)
        assert np.array_equal(first.score, again.score)


def test_another_place_another_seed_or_another_instance_errs_otherwise() -> None:
    outcomes = {
        tuple(
            len(detector(seed=seed, recall=0.5, precision=1.0).detect(seen(), pose, CAMERA))
            for pose in poses(30)
        )
        for seed in range(5)
    }
    assert len(outcomes) == 5
    turned = [
        len(detector(recall=0.5, precision=1.0).detect(seen(), Pose2D(x_m=0, y_m=0, yaw_rad=yaw), CAMERA))
        for yaw in np.arange(12) * math.tau / 12
    ]
    assert 0 < sum(turned) < 12


@pytest.mark.parametrize("hidden", [{"distance_m": 4.5}, {"visible": 0.1}])
def test_what_is_too_far_or_hidden_is_not_seen(hidden: dict[str, float]) -> None:
    assert len(detector(recall=1.0, precision=1.0).detect(seen(**hidden), poses(1)[0], CAMERA)) == 0


def test_dials_of_a_single_class() -> None:
    parameters = build(DetectionParameters, {"class_dials": ["coffee cup recall=0.25 range_max_m=2"]})
    dials = dials_by_class(parameters, ("mug", "coffee cup"))
    assert dials["mug"].recall == parameters.recall
    assert dials["coffee cup"] == Dials(
        recall=0.25, precision=0.8, prevalence=0.1, range_max_m=2.0, visible_fraction_min=0.3
    )


@pytest.mark.parametrize(
    "line",
    ["unicorn recall=0.5", "mug recall=lots", "mug sharpness=1", "mug", "recall=0.5", "mug recall=1.5"],
)
def test_dials_that_cannot_be_read_are_refused(line: str) -> None:
    with pytest.raises(BadParameterError):
        dials_by_class(build(DetectionParameters, {"class_dials": [line]}), ("mug",))
