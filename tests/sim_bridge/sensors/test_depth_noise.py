"""Depth is as noisy as triangulation makes it; what is not a depth stays what it is."""

import numpy as np
import pytest

from robustnav_msgs_py.values import DepthImage
from sim_bridge.sensors.camera import camera_model
from sim_bridge.sensors.degradations import KINECT_NOISE_PER_M, KINECT_STEP_PER_M, ImageDegradation
from sim_bridge.sensors.depth_noise import DepthSensor

SIZES = [(1, 1), (33, 17), (120, 160)]
KINECT = ImageDegradation(depth_noise=KINECT_NOISE_PER_M, depth_step=KINECT_STEP_PER_M, depth_holes=0.1)


def flat(depth_m: float, height: int = 120, width: int = 160) -> DepthImage:
    return DepthImage(
        depth_m=np.full((height, width), depth_m, dtype=np.float32), stamp_ns=7, frame_id="camera"
    )


def sensed(image: DepthImage, degradation: ImageDegradation, frame: int = 0, seed: int = 1) -> np.ndarray:
    height, width = image.depth_m.shape
    before = image.depth_m.copy()
    found = DepthSensor(degradation, camera_model(width, height, 1.0), seed).sensed(image, frame)
    assert np.array_equal(image.depth_m, before, equal_nan=True), "the perfect image was written to"
    assert found.depth_m.shape == image.depth_m.shape
    assert found.depth_m.dtype == np.float32
    assert (found.stamp_ns, found.frame_id) == (image.stamp_ns, image.frame_id)
    return found.depth_m


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("depth_m", [np.nan, np.inf])
def test_no_depth_stays_no_depth(depth_m: float, size: tuple[int, int]) -> None:
    image = flat(depth_m, *size)
    assert np.array_equal(sensed(image, KINECT), image.depth_m, equal_nan=True)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("size", SIZES)
def test_infinity_and_nan_stay_and_depth_becomes_depth_or_nan(size: tuple[int, int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    depth_m = rng.uniform(0.1, 10.0, size).astype(np.float32)
    kind = rng.integers(0, 3, size)
    depth_m[kind == 1] = np.inf
    depth_m[kind == 2] = np.nan
    image = DepthImage(depth_m=depth_m, stamp_ns=7, frame_id="camera")
    found = sensed(image, KINECT, frame=seed)
    assert np.isposinf(found[kind == 1]).all()
    assert np.isnan(found[kind == 2]).all()
    good = found[kind == 0]
    assert (np.isnan(good) | (np.isfinite(good) & (good > 0.0))).all()


def test_a_perfect_camera_changes_nothing() -> None:
    image = flat(2.0)
    assert (sensed(image, ImageDegradation()) == image.depth_m).all()


@pytest.mark.parametrize("depth_m", [0.5, 1.0, 2.0, 5.0, 10.0])
def test_the_spread_grows_with_the_square_of_depth(depth_m: float) -> None:
    found = sensed(flat(depth_m), ImageDegradation(depth_noise=KINECT_NOISE_PER_M)).astype(float)
    std_m = KINECT_NOISE_PER_M * depth_m**2
    assert found.std() == pytest.approx(std_m, rel=0.03)
    assert found.mean() == pytest.approx(depth_m, abs=0.05 * std_m)


def test_steps_by_hand() -> None:
    """Steps of 0.1 / m: what comes out is 1 / 0.1, 1 / 0.2, 1 / 0.3 ...; beyond 20 m is infinity's step."""
    coarse = ImageDegradation(depth_step=0.02)
    depth_m = np.array([[1.0, 1.005, 4.9, 48.0, 120.0]], dtype=np.float32)
    found = sensed(DepthImage(depth_m=depth_m, stamp_ns=0, frame_id="camera"), coarse)
    # In steps: 50, 49.75, 10.2, 1.04 and 0.4.
    assert found[0, :4] == pytest.approx([1.0, 1.0, 5.0, 50.0], rel=1e-5)
    assert np.isnan(found[0, 4])


def test_noise_never_puts_a_surface_behind_the_camera() -> None:
    found = sensed(flat(25.0), ImageDegradation(depth_noise=0.02))
    assert np.isnan(found).any()
    assert np.nanmin(found) > 0.0


def test_a_frame_is_the_same_whenever_it_is_taken() -> None:
    sensor = DepthSensor(KINECT, camera_model(160, 120, 1.0), seed=5)
    first = sensor.sensed(flat(2.0), 8).depth_m
    sensor.sensed(flat(2.0), 3)
    assert np.array_equal(sensor.sensed(flat(2.0), 8).depth_m, first, equal_nan=True)
    assert np.array_equal(sensed(flat(2.0), KINECT, frame=8, seed=5), first, equal_nan=True)
    assert not np.array_equal(sensor.sensed(flat(2.0), 9).depth_m, first, equal_nan=True)
