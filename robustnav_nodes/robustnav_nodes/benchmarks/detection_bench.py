"""How good a detector is in homes that it has never seen."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.values import (
    Float64,
)
from robustnav_nodes.benchmarks.detection_instances import (
    MatcherMaker,
    Sighting,
    Trial,
    sightings,
    trials,
)
from robustnav_nodes.benchmarks.detection_pictures import Picture, floor_distance_m, pictures
from robustnav_nodes.benchmarks.detection_scores import NONE
from robustnav_nodes.benchmarks.detection_tally import Tally, TrueObjects
from robustnav_nodes.detection.back_ends import make_detector
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.dials import dials_by_class
from robustnav_nodes.detection.parameters import TRUTH, DetectionParameters
from robustnav_nodes.detection.placement import place_boxes
from robustnav_nodes.detection.truth_detector import TruthDetector

AFTER = 100_000  # seeds of the homes with look-alikes lie so much higher
LOWEST_SCORE = 0.01  # average precision needs also what a node would not say


Look = Callable[[Picture], Boxes]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """A detector under one degradation. place_error_m: distances of right detections from the objects'
    centres; image_ms: of each image; choices: of one thing among others of its class, none where the back end
    does not compare things.
    """

    degradation: str
    tally: Tally
    place_error_m: Float64
    image_ms: Float64
    choices: tuple[Trial, ...] = ()


def detector_of(parameters: DetectionParameters, labels: Sequence[str]) -> tuple[tuple[str, ...], Look]:
    """The back end of `parameters`: its class names, and how it looks at a picture.

    labels: of the homes, which the truth back end has. Raises as `make_detector` does.
    """
    if parameters.back_end == TRUTH:
        truth = TruthDetector(
            labels=labels,
            dials=dials_by_class(parameters, labels),
            seed=parameters.seed,
            view_spacing_m=parameters.view_spacing_m,
            view_headings=parameters.view_headings,
        )
        return tuple(labels), lambda picture: truth.detect(picture.seen, picture.robot, picture.camera)
    detector = make_detector(replace(parameters, score_min=LOWEST_SCORE))
    return detector.labels, lambda picture: detector.detect(picture.color)


def measure(
    parameters: DetectionParameters,
    degradation: str,
    seeds: Sequence[int],
    poses: int,
    progress: Callable[[], None] = lambda: None,
) -> Measured:
    """Show the back end of `parameters` the homes of `seeds`; `progress` is called after each image."""
    from sim_bridge.homes.objects.catalogue import LABELS

    labels, look = detector_of(parameters, LABELS)
    tally = Tally(labels, 0.0 if parameters.back_end == TRUTH else parameters.score_min)
    off_m: list[float] = []
    image_ms: list[float] = []
    for picture in pictures(seeds, poses, degradation):
        began = time.perf_counter()
        boxes = look(picture)
        image_ms.append((time.perf_counter() - began) * 1e3)
        boxes = _of_classes(boxes, [number for number, name in enumerate(labels) if name in LABELS])
        truth, rows = _truth(picture, labels)
        chosen = tally.add(truth, boxes)
        off_m += _place_errors(picture, boxes, np.append(rows, NONE)[chosen], parameters)
        progress()
    matcher = _matcher_maker(parameters)
    return Measured(
        degradation=degradation,
        tally=tally,
        place_error_m=np.array(off_m),
        image_ms=np.array(image_ms),
        choices=() if matcher is None else _choices(matcher, parameters, degradation, seeds, poses),
    )


def _matcher_maker(parameters: DetectionParameters) -> MatcherMaker | None:
    """Only the learned back end tells things of one class apart."""
    if parameters.back_end != "learned":
        return None
    from robustnav_nodes.detection.learned.detector import LearnedDetector
    from robustnav_nodes.detection.learned.instance_matcher import InstanceMatcher

    detector = make_detector(parameters)
    if not isinstance(detector, LearnedDetector):
        return None
    return lambda image, box_px, height_m: InstanceMatcher(detector, image, box_px, height_m)


def _choices(
    matcher: MatcherMaker, parameters: DetectionParameters, degradation: str, seeds: Sequence[int], poses: int
) -> tuple[Trial, ...]:
    """In homes of their own, that hold several of a class."""
    found: list[Sighting] = []
    for picture in pictures([seed + AFTER for seed in seeds], poses, degradation, look_alikes=True):
        found += sightings(picture, parameters)
    return tuple(trials(found, matcher, np.random.default_rng(list(seeds))))


def _truth(picture: Picture, labels: Sequence[str]) -> tuple[TrueObjects, NDArray[np.int64]]:
    """What the detector could have found, and which rows of `picture.seen` that is."""
    seen = picture.seen
    number_of = {name: number for number, name in enumerate(labels)}
    numbers = [number_of.get(picture.labels[label], NONE) for label in seen.label]
    rows = np.flatnonzero(np.array(numbers, dtype=np.int64) != NONE)
    truth = TrueObjects(
        box_px=seen.box_px[rows],
        label=np.array(numbers, dtype=np.int64)[rows].astype(np.uint32),
        distance_m=floor_distance_m(seen, CameraMount())[rows],
        visible=seen.visible_fraction[rows].astype(np.float64),
        pixels=picture.pixels[rows],
    )
    return truth, rows


def _place_errors(
    picture: Picture, boxes: Boxes, rows: NDArray[np.int64], parameters: DetectionParameters
) -> list[float]:
    """How far each right box was placed from the centre of its object (row of `picture.seen`)."""
    right = np.flatnonzero(rows != NONE)
    placed, _ = place_boxes(
        Boxes(box_px=boxes.box_px[right], score=boxes.score[right], label=right.astype(np.uint32)),
        picture.depth,
        picture.camera,
        parameters,
    )
    centres_m = picture.seen.position_m[rows[placed.label]]
    return [float(off_m) for off_m in np.linalg.norm(placed.position_m - centres_m, axis=1)]


def _of_classes(boxes: Boxes, labels: Sequence[int]) -> Boxes:
    """Only boxes of these classes: of the others nobody knows whether they are there."""
    return boxes[np.isin(boxes.label, np.array(labels, dtype=np.uint32))]
