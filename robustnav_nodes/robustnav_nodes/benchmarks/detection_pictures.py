"""Pictures to try a detector on: homes by seed, from where a robot may stand, with what they really show."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
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

if TYPE_CHECKING:  # the simulator stands on this package
    from sim_bridge.homes.home import Home
    from sim_bridge.homes.obstacles import ClearanceGrid

WIDTH, HEIGHT, VIEW_RAD, RANGE_M = 320, 240, math.pi / 3.0, 10.0
STAND_CLEARANCE_M = 0.25
AIMED_M = (0.8, 4.0)
AIM_ERROR_RAD = 0.4
# Blur needs motion: the robot slows down to look, but images come while it turns.
MOTION = Velocity(linear_m_s=0.1, angular_rad_s=0.3)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """One image from `robot` in the home of seed `home`, and what it really shows.

    pixels: float64 [n], how many show each object.
    """

    home: int
    robot: Pose2D
    color: ColorImage
    depth: DepthImage
    camera: CameraModel
    seen: VisibleObjects
    pixels: Float64
    labels: tuple[str, ...]


def pictures(
    seeds: Sequence[int], poses: int, degradation: str, *, look_alikes: bool = False
) -> Iterator[Picture]:
    """From `poses` places in the home of each seed: every other one at random, the others at an object.

    Homes are easy, medium and hard in turn. The same seed gives the same places whatever is degraded.
    look_alikes: each home holds several of one class, another one in each home, and those are looked at.
    """
    from sim_bridge.homes.generator import generate_home
    from sim_bridge.homes.objects.catalogue import LABELS
    from sim_bridge.homes.rooms.room_programmes import Difficulty
    from sim_bridge.sensors.camera import Camera, camera_model
    from sim_bridge.sensors.degradations import DEGRADATIONS
    from sim_bridge.sensors.degraded_camera import DegradedCamera
    from sim_bridge.sensors.visibility import Observer
    from sim_bridge.stage import Stage

    difficulties, model, mount = list(Difficulty), camera_model(WIDTH, HEIGHT, VIEW_RAD), CameraMount()
    for number, seed in enumerate(seeds):
        alike = LABELS[number % len(LABELS)] if look_alikes else ""
        home = generate_home(seed, difficulty=difficulties[number % len(difficulties)], look_alikes=alike)
        with Stage(home) as stage:
            camera = Camera(stage.scenery, model, mount, RANGE_M)
            degraded = DegradedCamera(camera, DEGRADATIONS[degradation], seed)
            observer = Observer(stage.world, home, model, mount, RANGE_M)
            for frame, robot in enumerate(_places(home, alike, stage.grid, seed, poses)):
                taken = degraded.take(robot, MOTION, frame, frame + 1)
                seen = observer.look(robot, frame + 1)
                if taken.color is not None:
                    yield Picture(
                        home=seed,
                        robot=robot,
                        color=taken.color,
                        depth=taken.depth,
                        camera=model,
                        seen=seen,
                        pixels=_pixels(taken.numbers, seen),
                        labels=home.labels,
                    )


def floor_distance_m(seen: VisibleObjects, mount: CameraMount) -> Float64:
    """float64 [n]: from the robot's centre to each object's, on the floor."""
    return np.asarray(np.hypot(*base_from_optical(mount, seen.position_m)[:, :2].T), dtype=np.float64)


def _places(home: "Home", alike: str, grid: "ClearanceGrid", seed: int, poses: int) -> Iterator[Pose2D]:
    rng = np.random.default_rng([seed, poses])
    rows, columns = np.nonzero(grid.cells_m >= STAND_CLEARANCE_M)
    x_m, y_m = grid.x_m[columns], grid.y_m[rows]
    things = [thing for thing in home.objects if alike in ("", thing.label)]
    for number in range(poses):
        at, yaw_rad = int(rng.integers(len(x_m))), float(rng.uniform(-math.pi, math.pi))
        if number % 2 == 1 and things:
            thing = things[int(rng.integers(len(things)))]
            away_m = np.hypot(x_m - thing.x_m, y_m - thing.y_m)
            near = np.flatnonzero((away_m >= AIMED_M[0]) & (away_m <= AIMED_M[1]))
            if len(near):
                at = int(near[rng.integers(len(near))])
                bearing_rad = math.atan2(thing.y_m - y_m[at], thing.x_m - x_m[at])
                yaw_rad = bearing_rad + float(rng.uniform(-AIM_ERROR_RAD, AIM_ERROR_RAD))
        yield Pose2D(x_m=float(x_m[at]), y_m=float(y_m[at]), yaw_rad=yaw_rad)


def _pixels(numbers: NDArray[np.int32], seen: VisibleObjects) -> Float64:
    return np.array([(numbers == instance).sum() for instance in seen.instance], dtype=np.float64)
