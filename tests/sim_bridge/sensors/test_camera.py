"""The pictures are what the camera's model says."""

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest

from robustnav_msgs_py.frames import CameraMount, map_from_base, optical_from_base
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.home import Furniture, Home
from sim_bridge.homes.shapes import box
from sim_bridge.sensors.camera import Camera, camera_model, map_from_optical
from sim_bridge.sensors.world import NOTHING, World
from sim_bridge.simulation import Simulation

FreePoses = Callable[..., list[Pose2D]]

MOUNT = CameraMount()


def test_depth_agrees_with_rays(simulation: Simulation, free_poses: FreePoses) -> None:
    camera = simulation._camera
    model = camera.model
    rng = np.random.default_rng(0)
    compared = 0
    for pose in free_poses(simulation.home, 12, seed=1):
        frame = camera.take(pose, 0)
        u, v = rng.integers(0, model.width, 200), rng.integers(0, model.height, 200)
        depth = frame.depth.depth_m[v, u]
        rays = np.stack([(u - model.cx) / model.fx, (v - model.cy) / model.fy, np.ones(200)], axis=1)
        eye = map_from_optical(MOUNT, pose, np.zeros((1, 3)))
        shares, bodies = simulation._world.cast(
            np.repeat(eye, 200, axis=0), map_from_optical(MOUNT, pose, rays * 20.0)
        )
        # At the edge between two things, ray and pixel may meet different ones.
        same = (bodies == frame.bodies[v, u]) & np.isfinite(depth)
        assert same.mean() > 0.9
        error = np.abs(depth - shares * 20.0)[same]
        # The renderer's cylinders and balls are polygons: their sides lie a little inside the true ones.
        assert np.percentile(error, 99) < 0.02
        assert np.median(error) < 0.001
        compared += same.sum()
    assert compared > 1500


def lone_box(home: Home, centre: tuple[float, float, float], size: tuple[float, float, float]) -> Home:
    """A home of nothing but one box in the air."""
    piece = Furniture(
        name="box",
        kind="box",
        room="",
        x_m=0.0,
        y_m=0.0,
        quarter_turns=0,
        depth_m=1.0,
        width_m=1.0,
        height_m=1.0,
        tall=True,
        surfaces=(),
        parts=(box(centre, size, (1.0, 0.0, 0.0)),),
    )
    return dataclasses.replace(home, rooms=(), walls=(), objects=(), furniture=(piece,))


@pytest.mark.parametrize("yaw_rad", [0.0, 0.3, -0.4])
@pytest.mark.parametrize("ahead", [(2.0, 0.0, 0.8), (1.5, 0.4, 0.5), (3.0, -0.8, 0.2)])
def test_known_points_project_to_the_right_pixels(
    homes: list[Home], ahead: tuple[float, float, float], yaw_rad: float
) -> None:
    pose = Pose2D(x_m=0.7, y_m=-0.4, yaw_rad=yaw_rad)
    x_m, y_m, z_m = map_from_base(pose, np.array([ahead]))[0].tolist()
    model = camera_model(320, 240, math.radians(60.0))
    with World(lone_box(homes[0], (x_m, y_m, z_m), (0.04, 0.04, 0.04))) as world:
        bodies = Camera(world, model, MOUNT, 10.0).take(pose, 0).bodies
    rows, columns = np.nonzero(bodies != NOTHING)
    point = optical_from_base(MOUNT, np.array([ahead]))[0]
    assert len(rows) > 5
    assert np.mean((columns.min(), columns.max())) == pytest.approx(
        model.cx + model.fx * point[0] / point[2], abs=1.0
    )
    assert np.mean((rows.min(), rows.max())) == pytest.approx(
        model.cy + model.fy * point[1] / point[2], abs=1.0
    )


@pytest.mark.parametrize("edge_m", np.linspace(-0.31, 0.29, 7).tolist())
def test_edges_lie_between_the_right_pixels(homes: list[Home], edge_m: float) -> None:
    """A pixel's sample is at its centre: one at column u shows what projects to u, not to u + 1."""
    level = CameraMount(x_m=0.0, z_m=0.0, pitch_rad=0.0)
    model = camera_model(320, 240, math.radians(60.0))
    wall = lone_box(homes[0], (2.0, edge_m + 2.0, edge_m + 2.0), (0.002, 4.0, 4.0))
    with World(wall) as world:
        bodies = Camera(world, model, level, 10.0).take(Pose2D(x_m=0.0, y_m=0.0), 0).bodies
    rows, columns = np.nonzero(bodies != NOTHING)
    assert columns.max() == math.floor(model.cx - model.fx * edge_m / 1.999)
    assert rows.max() == math.floor(model.cy - model.fy * edge_m / 1.999)


def test_nothing_to_see_is_infinitely_far(homes: list[Home]) -> None:
    model = camera_model(64, 48, math.radians(60.0))
    with World(lone_box(homes[0], (3.0, 0.0, 0.5), (0.5, 0.5, 0.5))) as world:
        far = Camera(world, model, MOUNT, 10.0).take(Pose2D(x_m=0.0, y_m=0.0), 0)
        near = Camera(world, model, MOUNT, 1.0).take(Pose2D(x_m=0.0, y_m=0.0), 0)
    assert np.isfinite(far.depth.depth_m).any()
    assert (np.isinf(far.depth.depth_m) == (far.bodies == NOTHING)).all()
    assert np.isposinf(near.depth.depth_m).all()


def test_the_model_has_the_asked_for_view() -> None:
    model = camera_model(320, 240, math.radians(60.0))
    assert model.fx == pytest.approx(320 / (2 * math.tan(math.radians(30.0))))
    assert model.horizontal_view_rad == pytest.approx(math.radians(60.0))


def test_doorways_have_a_floor(homes: list[Home]) -> None:
    for home in homes[:5]:
        with World(home) as world:
            for door in home.doors:
                x_m, y_m = door.opening.centre_m
                # On either side of the seam between the floors of two rooms.
                above = np.array([[x_m + side, y_m + side, 1.0] for side in (-0.01, 0.01)])
                shares, _ = world.cast(above, above - (0.0, 0.0, 2.0))
                assert shares == pytest.approx(0.5, abs=1e-3)
