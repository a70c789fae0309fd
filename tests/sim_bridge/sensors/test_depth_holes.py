"""The wanted share of depth is lost, and first where a real camera loses it."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from robustnav_msgs_py.values import Bool, Float32, Pose2D
from sim_bridge.homes.home import Home
from sim_bridge.sensors.camera import camera_model
from sim_bridge.sensors.depth_holes import BASELINE_M, HoleMaker
from sim_bridge.simulation import Simulation

HEIGHT, WIDTH = 120, 160
MODEL = camera_model(WIDTH, HEIGHT, math.radians(60.0))
SHARES = [0.02, 0.1, 0.3, 0.9]


def lost(depth_m: Float32, share: float, seed: int = 0) -> Bool:
    height, width = depth_m.shape
    model = camera_model(width, height, math.radians(60.0))
    found = HoleMaker(model, share).lost(depth_m, np.random.default_rng(seed))
    assert found.dtype == np.bool_
    assert found.shape == depth_m.shape
    return found


def wall(depth_m: float) -> Float32:
    return np.full((HEIGHT, WIDTH), depth_m, dtype=np.float32)


@pytest.mark.parametrize("share", SHARES)
def test_the_share_is_met_in_real_views(
    simulation: Simulation, free_poses: Callable[[Home, int, int], list[Pose2D]], share: float
) -> None:
    maker = HoleMaker(simulation._camera.model, share)
    for number, pose in enumerate(free_poses(simulation.home, 4, 1)):
        depth_m = simulation._camera.take(pose, 0).depth.depth_m
        found = maker.lost(depth_m, np.random.default_rng(number))
        assert found.sum() == pytest.approx(share * np.isfinite(depth_m).sum(), abs=2.0)


@pytest.mark.parametrize("size", [(1, 1), (1, 9), (9, 1), (33, 17)])
@pytest.mark.parametrize("share", SHARES)
def test_the_share_is_met_on_average_in_images_of_any_size(size: tuple[int, int], share: float) -> None:
    depth_m = np.random.default_rng(1).uniform(0.5, 8.0, size).astype(np.float32)
    shares = [lost(depth_m, share, seed).mean() for seed in range(600)]
    assert np.mean(shares) == pytest.approx(share, rel=0.2, abs=0.01)


def test_only_finite_depth_is_lost_and_all_of_it_where_asked() -> None:
    depth_m = wall(2.0)
    depth_m[:40] = np.inf
    depth_m[40:60] = np.nan
    found = lost(depth_m, 1.0)
    assert not found[:60].any()
    assert found[60:].all()
    assert not lost(depth_m, 0.0).any()
    assert not lost(np.full((5, 5), np.nan, dtype=np.float32), 0.5).any()


@pytest.mark.parametrize("seed", range(10))
def test_the_shadow_left_of_a_near_thing_goes_first(seed: int) -> None:
    """A board at 1 m before a wall at 3 m: its shadow is fx * baseline * (1 / 1 - 1 / 3) pixels wide."""
    depth_m = wall(3.0)
    depth_m[:, 80:110] = 1.0
    width_px = MODEL.fx * BASELINE_M * (1.0 - 1.0 / 3.0)
    shadow = np.zeros(depth_m.shape, dtype=np.bool_)
    shadow[:, 80 - math.floor(width_px) : 80] = True
    found = lost(depth_m, float(shadow.mean()), seed)
    assert (found & shadow).sum() > 0.99 * shadow.sum()


def test_grazing_surfaces_go_before_those_that_face_the_camera() -> None:
    """Left a wall that is seen under a flat angle, right one from the front; both as far in the middle."""
    x = (np.arange(WIDTH) - MODEL.cx) / MODEL.fx
    depth_m = wall(2.0)
    side_m = 0.25
    depth_m[:, x < 0.0] = np.minimum(2.0, side_m / np.maximum(-x[x < 0.0], 1e-3)).astype(np.float32)
    grazing = depth_m[0] < 1.9
    assert grazing[: WIDTH // 4].all()
    faces = (depth_m[0] == 2.0) & (x > 0.1)
    share = np.mean([lost(depth_m, 0.2, seed) for seed in range(20)], axis=(0, 1))
    just_as_far = grazing & (depth_m[0] > 1.3)
    assert share[just_as_far].mean() > 3.0 * share[faces].mean()


def test_what_is_far_goes_before_what_is_near() -> None:
    depth_m = wall(2.0)
    depth_m[: HEIGHT // 2] = 5.0
    share = np.mean([lost(depth_m, 0.2, seed) for seed in range(20)], axis=(0, 2))
    assert share[: HEIGHT // 2 - 1].mean() > 10.0 * share[HEIGHT // 2 + 1 :].mean()


def test_holes_in_a_bare_wall_are_blobs() -> None:
    """A lost pixel's neighbour is mostly lost too, and holes are somewhere else in every frame."""
    one, other = (lost(wall(2.0), 0.1, seed) for seed in (1, 2))
    assert (one[:, 1:] & one[:, :-1]).sum() / one[:, :-1].sum() > 0.7
    assert (one & other).sum() < 0.5 * one.sum()
