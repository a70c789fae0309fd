"""In homes of every difficulty, picture, depth, ground truth, laser and map tell of the same home."""

import dataclasses
import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from robustnav_msgs_py.frames import CameraMount, base_from_map, optical_from_base
from robustnav_msgs_py.values import LaserScan, Pose2D, VisibleObjects
from sim_bridge.homes.floor_plan import OCCUPIED, floor_plan
from sim_bridge.parameters import SimParameters
from sim_bridge.sensors.camera import CameraFrame, map_from_optical
from sim_bridge.sensors.rasterizer import NOTHING
from sim_bridge.sensors.scan import LASER_HEIGHT_M
from sim_bridge.sensors.scenery import FIRST_OTHER
from sim_bridge.sensors.visibility import RAYS_PER_AXIS
from sim_bridge.simulation import Simulation

FreePoses = Callable[..., list[Pose2D]]
Looks = list[tuple[Pose2D, CameraFrame, VisibleObjects]]

MOUNT = CameraMount()
REACH_M = 20.0
# What covers so many pixels is large enough for its box to be compared.
LARGE_PX = 60
STEP_M = 0.005
TOLERANCE_M, HAIRS_M = 0.02, (-0.003, -0.001, 0.001, 0.003)


@pytest.fixture(scope="module", params=["easy", "medium", "hard"])
def sim(request: pytest.FixtureRequest) -> Iterator[Simulation]:
    with Simulation(SimParameters(seed=5, difficulty=request.param)) as made:
        yield made


@pytest.fixture(scope="module")
def looks(sim: Simulation, free_poses: FreePoses) -> Looks:
    """Eighty poses, what the camera shows there, and what is said to be in view."""
    poses = free_poses(sim.home, 80, seed=2)
    return [(pose, sim._camera.take(pose, 0, color=False), sim._observer.look(pose, 0)) for pose in poses]


def depth_of_rays(sim: Simulation, pose: Pose2D, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """What PyBullet finds behind pixels, along the optical axis; inf where nothing."""
    model = sim._camera.model
    ahead = np.stack([(u - model.cx) / model.fx, (v - model.cy) / model.fy, np.ones(len(u))], axis=1)
    eye = map_from_optical(MOUNT, pose, np.zeros((1, 3)))
    ends = map_from_optical(MOUNT, pose, REACH_M * ahead)
    shares, bodies = sim.stage.world.cast(np.tile(eye, (len(u), 1)), ends)
    return np.where(bodies == NOTHING, np.inf, shares * REACH_M)


def away_from_edges(frame: CameraFrame, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Whether all that is around the pixel is the same item, and no part of it stands out."""
    numbers, depth = frame.numbers, frame.depth.depth_m
    height, width = numbers.shape
    calm = np.ones(len(u), dtype=bool)
    for du in (-1, 0, 1):
        for dv in (-1, 0, 1):
            p, q = np.clip(u + du, 0, width - 1), np.clip(v + dv, 0, height - 1)
            calm &= numbers[q, p] == numbers[v, u]
            calm &= np.abs(depth[q, p] - depth[v, u]) < 0.02 + 0.03 * depth[v, u]
    return calm


def test_depth_is_what_rays_meet(sim: Simulation, free_poses: FreePoses) -> None:
    rng = np.random.default_rng(0)
    errors = []
    for pose in free_poses(sim.home, 25, seed=1):
        frame = sim._camera.take(pose, 0, color=False)
        height, width = frame.numbers.shape
        u, v = rng.integers(0, width, 500), rng.integers(0, height, 500)
        depth = frame.depth.depth_m[v, u]
        kept = np.isfinite(depth) & away_from_edges(frame, u, v)
        errors.append(np.abs(depth - depth_of_rays(sim, pose, u, v))[kept])
    found = np.concatenate(errors)
    assert len(found) > 5000
    assert np.median(found) < 0.001
    assert found.max() < 0.02


def test_boxes_and_fractions_are_those_of_the_picture(looks: Looks) -> None:
    errors, listed = [], []
    for _, frame, truth in looks:
        numbers = frame.numbers
        for instance in np.unique(numbers[(numbers != NOTHING) & (numbers < FIRST_OTHER)]).tolist():
            rows, columns = np.nonzero(numbers == instance)
            if len(rows) < LARGE_PX:
                continue
            listed.append(instance in truth.instance)
            if not listed[-1]:
                continue
            box = truth.box_px[truth.instance == instance][0]
            shown = np.array((columns.min(), rows.min(), columns.max() + 1, rows.max() + 1))
            # Of a large object only every so many-th pixel is looked at.
            stride = math.ceil(max(*(shown[2:] - shown[:2])) / RAYS_PER_AXIS)
            errors.append(np.abs(box - shown).max() / max(2.0, stride))
    assert len(errors) > 40
    assert all(listed)
    assert (np.array(errors) <= 1.0).mean() > 0.97


def test_what_is_said_to_be_seen_is_in_the_picture(sim: Simulation, looks: Looks) -> None:
    model = sim._camera.model
    for _, frame, truth in looks:
        numbers = frame.numbers
        for at, instance in enumerate(truth.instance.tolist()):
            x_min, y_min, x_max, y_max = truth.box_px[at]
            if (x_max - x_min) * (y_max - y_min) < LARGE_PX or truth.visible_fraction[at] < 0.2:
                continue
            assert (numbers == instance).any(), sim.home.objects[instance].label
            assert 0.0 <= x_min < x_max <= model.width
            assert 0.0 <= y_min < y_max <= model.height


def test_objects_are_where_the_model_projects_their_corners(sim: Simulation, looks: Looks) -> None:
    model, checked = sim._camera.model, 0
    for pose, frame, _ in looks:
        for thing in sim.home.objects:
            corners = optical_from_base(MOUNT, base_from_map(pose, thing.corners_m()))
            if corners[:, 2].min() < 0.3:
                continue
            u = model.cx + model.fx * corners[:, 0] / corners[:, 2]
            v = model.cy + model.fy * corners[:, 1] / corners[:, 2]
            rows, columns = np.nonzero(frame.numbers == thing.instance)
            if not len(rows):
                continue
            # All of the thing is within the box around its projected corners.
            assert u.min() - 1.0 <= columns.min()
            assert columns.max() <= u.max() + 1.0
            assert v.min() - 1.0 <= rows.min()
            assert rows.max() <= v.max() + 1.0
            checked += 1
    assert checked > 30


def heading_of_rays(pose: Pose2D, scan: LaserScan) -> np.ndarray:
    """The heading of each ray of a scan in `map`."""
    return pose.yaw_rad + scan.angle_min_rad + scan.angle_step_rad * np.arange(len(scan.ranges_m))


def ranges_of_rays(sim: Simulation, pose: Pose2D, headings: np.ndarray, aside_m: float) -> np.ndarray:
    """What PyBullet finds along rays in the laser's plane that begin `aside_m` to the left of the laser."""
    ahead = np.stack([np.cos(headings), np.sin(headings), np.zeros(len(headings))], axis=1)
    left = np.stack([-ahead[:, 1], ahead[:, 0], ahead[:, 2]], axis=1)
    starts = np.array((pose.x_m, pose.y_m, LASER_HEIGHT_M)) + aside_m * left
    reach_m = sim.parameters.scan_range_m
    shares, bodies = sim.stage.world.cast(starts, starts + reach_m * ahead)
    return np.where(bodies == NOTHING, np.inf, shares * reach_m)


def test_the_laser_meets_what_rays_meet(sim: Simulation, free_poses: FreePoses) -> None:
    """To within 2 cm; where a ray grazes an edge, between what PyBullet meets a hair to either side."""
    clear = grazing = 0
    for pose in free_poses(sim.home, 12, seed=7):
        scan = sim._laser.take(pose, 0)
        headings = heading_of_rays(pose, scan)
        met_m = ranges_of_rays(sim, pose, headings, 0.0)
        far = np.isinf(met_m) & np.isinf(scan.ranges_m)
        same = far | (np.abs(np.where(far, 0.0, met_m) - np.where(far, 0.0, scan.ranges_m)) < TOLERANCE_M)
        beside_m = [ranges_of_rays(sim, pose, headings[~same], aside_m) for aside_m in HAIRS_M]
        assert (np.min(beside_m, axis=0) - TOLERANCE_M <= scan.ranges_m[~same]).all()
        assert (scan.ranges_m[~same] <= np.max(beside_m, axis=0) + TOLERANCE_M).all()
        clear, grazing = clear + int(same.sum()), grazing + int((~same).sum())
    assert grazing < 0.002 * clear


def test_the_laser_meets_walls_where_the_map_shows_them(sim: Simulation, free_poses: FreePoses) -> None:
    """Along each ray that ends at a wall, the first occupied cell of a plan without furniture."""
    plan = floor_plan(dataclasses.replace(sim.home, furniture=()))
    walls = [wall.base.grown(0.002) for wall in sim.home.walls if wall.z_min_m == 0.0]
    errors = []
    for pose in free_poses(sim.home, 12, seed=6):
        scan = sim._laser.take(pose, 0)
        for range_m, angle in zip(scan.ranges_m.tolist(), heading_of_rays(pose, scan).tolist(), strict=True):
            cos, sin = math.cos(angle), math.sin(angle)
            end = (pose.x_m + range_m * cos, pose.y_m + range_m * sin)
            if not math.isfinite(range_m) or not any(wall.holds(*end) for wall in walls):
                continue
            along_m = np.arange(0.0, range_m + 0.2, STEP_M)
            rows = ((pose.y_m + along_m * sin - plan.origin.y_m) / plan.resolution_m).astype(int)
            columns = ((pose.x_m + along_m * cos - plan.origin.x_m) / plan.resolution_m).astype(int)
            errors.append(abs(along_m[np.argmax(plan.cells[rows, columns] == OCCUPIED)] - range_m))
    assert len(errors) > 1000
    # A ray that grazes a door's edge may pass it in the map.
    assert (np.array(errors) <= plan.resolution_m).mean() > 0.998
