"""Renders pictures of simulated homes as a robot takes them: to learn from, and to be judged on."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError, BadSceneError
from robustnav_msgs_py.frames import CameraMount, base_from_map, optical_from_base
from robustnav_msgs_py.values import Pose2D, Velocity
from robustnav_nodes.detection.learned.training_pictures import (
    OBJECTS_FILE,
    PIXELS_FILE,
    ObjectTable,
    PictureSet,
    load_pictures,
    save_objects,
)
from robustnav_nodes.worker_pool import worker_pool

if TYPE_CHECKING:  # the simulator stands on this package
    from sim_bridge.homes.home import Home, SmallObject
    from sim_bridge.homes.obstacles import ClearanceGrid
    from sim_bridge.sensors.camera import Camera, CameraFrame
    from sim_bridge.sensors.degradations import ImageDegradation

WIDTH, HEIGHT = 320, 240
VIEW_RAD = math.pi / 3.0
RANGE_M = 10.0
CLEARANCE_M = 0.20
# Small homes are drawn oftener than their share of a robot's life: they cost little and are crowded.
DIFFICULTIES = {"easy": 0.25, "medium": 0.45, "hard": 0.30}
CROWDED_OBJECTS = {"easy": 16, "medium": 36, "hard": 70}
P_CROWDED, P_LOOK_ALIKES = 0.5, 0.6
# Most pictures look at an object from a distance of this range; the others look anywhere.
P_AIMED, DISTANCES_M, AIM_RAD, AIM_TRIES = 0.75, (0.6, 4.2), 0.40, 6
NEAR_DISTANCES_M = (0.6, 2.4)
RING_M = 0.15
# Of what shows fewer pixels nothing is said.
FEWEST_PX = 12
AIM_WIDTH, AIM_HEIGHT = 80, 60
# Another processor rounds otherwise: pictures are the same where nearly all levels differ by no more.
SAME_LEVELS, SAME_SHARE = 2, 0.001
# Part of the homes is seen through another camera on another mast.
P_OTHER_CAMERA = 0.35
P_DEGRADED = 0.35


class Kind(StrEnum):
    """What the pictures are for.

    TRAINING also has crowded homes, homes with look-alikes, other cameras and what is wrong with cameras.
    TEST has homes and camera as they are by default. LOOK_ALIKES has homes with look-alikes, seen from near.
    """

    TRAINING = "training"
    TEST = "test"
    LOOK_ALIKES = "look-alikes"


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderPlan:
    """Which pictures: `homes` homes of the seeds from `first_seed` on, `per_home` of each."""

    kind: Kind
    first_seed: int
    homes: int
    per_home: int


def render_pictures(
    plan: RenderPlan, folder: Path, workers: int, advanced: Callable[[], None] = lambda: None
) -> PictureSet:
    """Render into `folder` with `workers` processes (1: in this one); `advanced` is called after each home.

    A folder that is complete is only read. Raises BadFileError where it is of another plan, or of homes that
    looked otherwise: the first of them is rendered again and compared.
    """
    from sim_bridge.homes.objects.catalogue import LABELS

    if not (folder / OBJECTS_FILE).exists():
        folder.mkdir(parents=True, exist_ok=True)
        shape = (plan.homes * plan.per_home, HEIGHT, WIDTH, 3)
        np.lib.format.open_memmap(folder / PIXELS_FILE, mode="w+", dtype=np.uint8, shape=shape).flush()
        jobs = [(plan, folder / PIXELS_FILE, home) for home in range(plan.homes)]
        tables = []
        with worker_pool(workers) as pool:
            for table in pool.map(_render_home, jobs) if workers > 1 else map(_render_home, jobs):
                tables.append(table)
                advanced()
        save_objects(folder, ObjectTable.joined(tables), LABELS)
        return load_pictures(folder)
    pictures = load_pictures(folder)
    if len(pictures) != plan.homes * plan.per_home or not _is_of(plan, pictures):
        raise BadFileError(
            f"the pictures in {str(folder)!r} are not those of {plan.homes} homes of the seeds from "
            f"{plan.first_seed} on, {plan.per_home} of each, as they are rendered now; remove the folder"
        )
    return pictures


def _is_of(plan: RenderPlan, pictures: PictureSet) -> bool:
    """Whether the first home's pictures are what they would be now."""
    shape = (plan.per_home, HEIGHT, WIDTH, 3)
    with TemporaryDirectory() as folder:
        path = Path(folder) / PIXELS_FILE
        np.lib.format.open_memmap(path, mode="w+", dtype=np.uint8, shape=shape).flush()
        _render_home((plan, path, 0))
        again = np.array(np.load(path, mmap_mode="r"), dtype=np.int16)
    apart = np.abs(again - pictures.pixels[: plan.per_home])
    return bool((apart > SAME_LEVELS).mean() < SAME_SHARE)


def _render_home(job: tuple[RenderPlan, Path, int]) -> ObjectTable:
    """One home's pictures, into their place in the file."""
    from sim_bridge.homes.floor_plan import RESOLUTION_M
    from sim_bridge.homes.objects.catalogue import LABELS
    from sim_bridge.homes.obstacles import ClearanceGrid
    from sim_bridge.sensors.camera import Camera, camera_model
    from sim_bridge.sensors.scenery import Scenery, scenery_of

    plan, path, number = job
    rng = np.random.default_rng([plan.first_seed, number])
    home = _home(plan, number, rng)
    look_alikes = LABELS[number % len(LABELS)] if plan.kind is Kind.LOOK_ALIKES else ""
    view_rad, mount = VIEW_RAD, CameraMount()
    if plan.kind is Kind.TRAINING and rng.random() < P_OTHER_CAMERA:
        view_rad *= rng.uniform(0.9, 1.2)
        mount = CameraMount(z_m=rng.uniform(0.8, 1.3), pitch_rad=rng.uniform(0.15, 0.38))
    scenery = scenery_of(home)
    camera = Camera(scenery, camera_model(WIDTH, HEIGHT, view_rad), mount, RANGE_M)
    glance = Camera(scenery, camera_model(AIM_WIDTH, AIM_HEIGHT, view_rad), mount, RANGE_M)
    grid = ClearanceGrid(home.bounds, RESOLUTION_M).with_rects(home.obstacles())
    # Each object without all others: what it would cover.
    alone = {
        thing.instance: Camera(Scenery([scenery.items[thing.instance]]), camera.model, mount, RANGE_M)
        for thing in home.objects
    }
    pixels = np.lib.format.open_memmap(path, mode="r+")
    tables = []
    for at in range(plan.per_home):
        pose = _pose(home, grid, glance, rng, look_alikes)
        picture = number * plan.per_home + at
        frame = _taken(camera, pose, rng) if plan.kind is Kind.TRAINING else camera.take(pose, 0)
        if frame.color is not None:
            pixels[picture] = frame.color.pixels
        tables.append(_objects(home, number, picture, frame.numbers, pose, camera, alone))
    return ObjectTable.joined(tables)


def _home(plan: RenderPlan, number: int, rng: np.random.Generator) -> "Home":
    from sim_bridge.homes.generator import generate_home
    from sim_bridge.homes.objects.catalogue import LABELS
    from sim_bridge.homes.rooms.room_programmes import Difficulty

    name = str(rng.choice(list(DIFFICULTIES), p=list(DIFFICULTIES.values())))
    crowded, alike = rng.random(2) < (P_CROWDED, P_LOOK_ALIKES)
    seed = plan.first_seed + number
    training = plan.kind is Kind.TRAINING
    if plan.kind is not Kind.TEST:
        try:
            return generate_home(
                seed,
                difficulty=Difficulty(name),
                objects=CROWDED_OBJECTS[name] if training and crowded else None,
                look_alikes=LABELS[number % len(LABELS)] if alike or not training else "",
            )
        except BadSceneError:  # so many of them find no place there
            pass
    return generate_home(seed, difficulty=Difficulty(name))


def _pose(
    home: "Home", grid: "ClearanceGrid", glance: "Camera", rng: np.random.Generator, look_alikes: str
) -> Pose2D:
    """Somewhere on the free floor, looking anywhere or, mostly, at an object that is in sight.

    With `look_alikes` always, if it can be, at one of that class, from near.
    """
    aims = [thing for thing in home.objects if thing.label == look_alikes] or home.objects
    distances_m = NEAR_DISTANCES_M if look_alikes else DISTANCES_M
    rows, columns = np.nonzero(grid.cells_m >= CLEARANCE_M)
    x_m, y_m = grid.x_m[columns], grid.y_m[rows]
    if look_alikes or rng.random() < P_AIMED:
        for _ in range(AIM_TRIES):
            thing = aims[int(rng.integers(len(aims)))]
            away_m = np.hypot(x_m - thing.x_m, y_m - thing.y_m)
            ring = np.flatnonzero(np.abs(away_m - rng.uniform(*distances_m)) < RING_M)
            if not len(ring):
                continue
            at = int(ring[rng.integers(len(ring))])
            towards = math.atan2(thing.y_m - y_m[at], thing.x_m - x_m[at])
            pose = _at(x_m[at], y_m[at], towards + rng.uniform(-AIM_RAD, AIM_RAD))
            if (glance.take(pose, 0, color=False).numbers == thing.instance).any():
                return pose
    at = int(rng.integers(len(x_m)))
    return _at(x_m[at], y_m[at], rng.uniform(-math.pi, math.pi))


def _at(x_m: float, y_m: float, yaw_rad: float) -> Pose2D:
    return Pose2D(x_m=float(x_m), y_m=float(y_m), yaw_rad=math.remainder(yaw_rad, math.tau))


def _taken(camera: "Camera", pose: Pose2D, rng: np.random.Generator) -> "CameraFrame":
    """A picture, some of them with what is wrong with cameras."""
    from sim_bridge.sensors.degraded_camera import DegradedCamera

    if rng.random() >= P_DEGRADED:
        return camera.take(pose, 0)
    worse = DegradedCamera(camera, _degradation(rng), int(rng.integers(2**31)))
    speed = Velocity(linear_m_s=rng.uniform(0.0, 0.5), angular_rad_s=rng.uniform(-1.2, 1.2))
    return worse.take(pose, speed, 0, 0)


def _degradation(rng: np.random.Generator) -> "ImageDegradation":
    from sim_bridge.sensors.degradations import ImageDegradation

    kind = rng.integers(4)
    if kind == 0:
        return ImageDegradation(exposure_s=rng.uniform(0.01, 0.04))
    if kind == 1:
        return ImageDegradation(darkness=rng.uniform(0.3, 0.85), image_noise=rng.uniform(0.3, 1.2))
    if kind == 2:
        return ImageDegradation(image_noise=rng.uniform(2.0, 10.0))
    return ImageDegradation(image_downscale=2, image_noise=rng.uniform(0.0, 2.0))


def _objects(
    home: "Home",
    number: int,
    picture: int,
    numbers: NDArray[np.int32],
    pose: Pose2D,
    camera: "Camera",
    alone: "Mapping[int, Camera]",
) -> ObjectTable:
    """The objects of which so many pixels show that they can be spoken of."""
    rows, columns = np.nonzero((numbers >= 0) & (numbers < len(home.objects)))
    count = np.bincount(numbers[rows, columns], minlength=len(home.objects))
    shown = np.flatnonzero(count >= FEWEST_PX)
    low = np.full((len(home.objects), 2), np.inf)
    high = np.full((len(home.objects), 2), -np.inf)
    for axis, values in enumerate((columns, rows)):
        np.minimum.at(low[:, axis], numbers[rows, columns], values)
        np.maximum.at(high[:, axis], numbers[rows, columns], values)
    things = [home.objects[instance] for instance in shown.tolist()]
    would_cover = [
        (alone[thing.instance].take(pose, 0, color=False).numbers == thing.instance).sum() for thing in things
    ]
    centres_m = np.array([thing.centre_m for thing in things]).reshape(-1, 3)
    optical_m = optical_from_base(camera.mount, base_from_map(pose, centres_m))
    return ObjectTable(
        picture=np.full(len(shown), picture, dtype=np.int32),
        box_px=np.concatenate([low[shown], high[shown] + 1.0], axis=1).astype(np.float32),
        label=np.array([home.labels.index(thing.label) for thing in things], dtype=np.int32),
        look=np.array([_look_numbers(thing) for thing in things], dtype=np.int32).reshape(-1, 4),
        home=np.full(len(shown), number, dtype=np.int32),
        instance=shown.astype(np.int32),
        visible_px=count[shown].astype(np.int32),
        visible_fraction=(count[shown] / np.maximum(would_cover, 1)).astype(np.float32),
        distance_m=np.linalg.norm(optical_m, axis=1).astype(np.float32),
        ahead_m=optical_m[:, 2].astype(np.float32),
        focal_px=np.full(len(shown), camera.model.fx, dtype=np.float32),
    )


def _look_numbers(thing: "SmallObject") -> tuple[int, int, int, int]:
    """Colour, substance, pattern and size as numbers."""
    from sim_bridge.homes.materials import COLOURS, Pattern, Substance
    from sim_bridge.homes.scene import Size

    look = thing.look
    return (
        list(COLOURS).index(look.colour),
        list(Substance).index(look.substance),
        list(Pattern).index(look.pattern),
        list(Size).index(look.size),
    )
