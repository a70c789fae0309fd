"""How good a detector is in homes that it has never seen: pictures from where a robot may stand."""

import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.frames import CameraMount, base_from_optical
from robustnav_msgs_py.values import (
    CameraModel,
    ColorImage,
    DepthImage,
    Float64,
    Pose2D,
    Velocity,
    VisibleObjects,
)
from robustnav_nodes.benchmarks.detection_scores import NONE
from robustnav_nodes.benchmarks.detection_tally import Tally, TrueObjects
from robustnav_nodes.detection.back_ends import make_detector
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.dials import dials_by_class
from robustnav_nodes.detection.parameters import TRUTH, DetectionParameters
from robustnav_nodes.detection.placement import place_boxes
from robustnav_nodes.detection.truth_detector import TruthDetector

if TYPE_CHECKING:  # the simulator stands on this package
    from sim_bridge.homes.home import Home
    from sim_bridge.homes.obstacles import ClearanceGrid

WIDTH, HEIGHT, VIEW_RAD, RANGE_M = 320, 240, math.pi / 3.0, 10.0
STAND_CLEARANCE_M = 0.25
AIMED_M = (0.8, 4.0)
AIM_ERROR_RAD = 0.4
# Blur needs motion: the robot slows down to look, but images come while it turns.
MOTION = Velocity(linear_m_s=0.1, angular_rad_s=0.3)
LOWEST_SCORE = 0.01  # average precision needs also what a node would not say


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """One image from `robot`, and what it really shows; pixels: float64 [n], how many show each object."""

    robot: Pose2D
    color: ColorImage
    depth: DepthImage
    camera: CameraModel
    seen: VisibleObjects
    pixels: Float64
    labels: tuple[str, ...]


Look = Callable[[Picture], Boxes]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Measured:
    """A detector under one degradation. place_error_m: distances of right detections from the objects'
    centres; image_ms: of each image.
    """

    degradation: str
    tally: Tally
    place_error_m: Float64
    image_ms: Float64


def pictures(seeds: Sequence[int], poses: int, degradation: str) -> Iterator[Picture]:
    """From `poses` places in the home of each seed: every other one at random, the others at an object.

    Homes are easy, medium and hard in turn. The same seed gives the same places whatever is degraded.
    """
    from sim_bridge.homes.generator import generate_home
    from sim_bridge.homes.rooms.room_programmes import Difficulty
    from sim_bridge.sensors.camera import Camera, camera_model
    from sim_bridge.sensors.degradations import DEGRADATIONS
    from sim_bridge.sensors.degraded_camera import DegradedCamera
    from sim_bridge.sensors.visibility import Observer
    from sim_bridge.stage import Stage

    difficulties, model, mount = list(Difficulty), camera_model(WIDTH, HEIGHT, VIEW_RAD), CameraMount()
    for number, seed in enumerate(seeds):
        home = generate_home(seed, difficulty=difficulties[number % len(difficulties)])
        with Stage(home) as stage:
            camera = Camera(stage.scenery, model, mount, RANGE_M)
            degraded = DegradedCamera(camera, DEGRADATIONS[degradation], seed)
            observer = Observer(stage.world, home, model, mount, RANGE_M)
            for frame, robot in enumerate(_places(home, stage.grid, seed, poses)):
                taken = degraded.take(robot, MOTION, frame, frame + 1)
                seen = observer.look(robot, frame + 1)
                if taken.color is not None:
                    yield Picture(
                        robot=robot,
                        color=taken.color,
                        depth=taken.depth,
                        camera=model,
                        seen=seen,
                        pixels=_pixels(taken.numbers, seen),
                        labels=home.labels,
                    )


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
    return Measured(
        degradation=degradation,
        tally=tally,
        place_error_m=np.array(off_m),
        image_ms=np.array(image_ms),
    )


def floor_distance_m(seen: VisibleObjects, mount: CameraMount) -> Float64:
    """float64 [n]: from the robot's centre to each object's, on the floor."""
    return np.asarray(np.hypot(*base_from_optical(mount, seen.position_m)[:, :2].T), dtype=np.float64)


def _places(home: "Home", grid: "ClearanceGrid", seed: int, poses: int) -> Iterator[Pose2D]:
    rng = np.random.default_rng([seed, poses])
    rows, columns = np.nonzero(grid.cells_m >= STAND_CLEARANCE_M)
    x_m, y_m = grid.x_m[columns], grid.y_m[rows]
    for number in range(poses):
        at, yaw_rad = int(rng.integers(len(x_m))), float(rng.uniform(-math.pi, math.pi))
        if number % 2 == 1 and home.objects:
            thing = home.objects[int(rng.integers(len(home.objects)))]
            away_m = np.hypot(x_m - thing.x_m, y_m - thing.y_m)
            near = np.flatnonzero((away_m >= AIMED_M[0]) & (away_m <= AIMED_M[1]))
            if len(near):
                at = int(near[rng.integers(len(near))])
                bearing_rad = math.atan2(thing.y_m - y_m[at], thing.x_m - x_m[at])
                yaw_rad = bearing_rad + float(rng.uniform(-AIM_ERROR_RAD, AIM_ERROR_RAD))
        yield Pose2D(x_m=float(x_m[at]), y_m=float(y_m[at]), yaw_rad=yaw_rad)


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
    kept = np.isin(boxes.label, np.array(labels, dtype=np.uint32))
    return Boxes(box_px=boxes.box_px[kept], score=boxes.score[kept], label=boxes.label[kept])


def _pixels(numbers: NDArray[np.int32], seen: VisibleObjects) -> Float64:
    return np.array([(numbers == instance).sum() for instance in seen.instance], dtype=np.float64)
