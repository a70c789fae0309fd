"""The colour sensor is as noisy, dark and coarse as its module says."""

import numpy as np
import pytest

from robustnav_msgs_py.values import ColorImage
from sim_bridge.sensors.camera import camera_model
from sim_bridge.sensors.degradations import DEGRADATIONS, ImageDegradation
from sim_bridge.sensors.image_noise import FIXED_SHARE, ImageSensor

SIZES = [(1, 1), (33, 17), (240, 320)]
HARD = ImageDegradation(darkness=0.7, image_noise=5.0, image_downscale=2)


def grey(level: int, height: int = 120, width: int = 160) -> ColorImage:
    return ColorImage(
        pixels=np.full((height, width, 3), level, dtype=np.uint8), stamp_ns=7, frame_id="camera"
    )


def random_image(height: int, width: int, seed: int = 0) -> ColorImage:
    pixels = np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)
    return ColorImage(pixels=pixels, stamp_ns=7, frame_id="camera")


def sensed(image: ColorImage, degradation: ImageDegradation, frame: int = 0, seed: int = 1) -> np.ndarray:
    height, width, _ = image.pixels.shape
    found = ImageSensor(degradation, camera_model(width, height, 1.0), seed).sensed(image, frame)
    assert found.pixels.shape == image.pixels.shape
    assert found.pixels.dtype == np.uint8
    assert (found.stamp_ns, found.frame_id) == (image.stamp_ns, image.frame_id)
    return found.pixels


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("degradation", [*DEGRADATIONS.values(), HARD, ImageDegradation(darkness=1.0)])
def test_any_image_keeps_size_type_and_stamp(degradation: ImageDegradation, size: tuple[int, int]) -> None:
    image = random_image(*size)
    before = image.pixels.copy()
    sensed(image, degradation)
    assert (image.pixels == before).all(), "the perfect image was written to"


def test_a_perfect_sensor_changes_nothing() -> None:
    image = random_image(33, 17)
    assert (sensed(image, ImageDegradation()) == image.pixels).all()


def test_a_frame_is_the_same_whenever_it_is_taken() -> None:
    image = random_image(33, 17)
    sensor = ImageSensor(HARD, camera_model(17, 33, 1.0), seed=5)
    first = sensor.sensed(image, 8).pixels
    sensor.sensed(image, 3)
    assert (sensor.sensed(image, 8).pixels == first).all()
    assert (sensed(image, HARD, frame=8, seed=5) == first).all()
    assert (sensed(image, HARD, frame=9, seed=5) != first).any()
    assert (sensed(image, HARD, frame=8, seed=6) != first).any()


@pytest.mark.parametrize("noise", [1.0, 4.0, 12.0])
@pytest.mark.parametrize("level", [90, 128, 180])
def test_noise_has_the_asked_for_spread_and_no_bias(level: int, noise: float) -> None:
    sensor = ImageSensor(ImageDegradation(image_noise=noise), camera_model(160, 120, 1.0), seed=2)
    now, later = (sensor.sensed(grey(level), frame).pixels.astype(float) for frame in (0, 1))
    # The fixed pattern is in both, so the difference has the rest twice; rounding adds 1/12.
    from_frame_to_frame = (now - later).std() / np.sqrt(2.0)
    assert from_frame_to_frame == pytest.approx(np.hypot(noise, np.sqrt(1.0 / 12.0)), rel=0.02)
    assert now.std() == pytest.approx(np.sqrt(noise**2 * (1.0 + FIXED_SHARE**2) + 1.0 / 12.0), rel=0.02)
    assert now.mean() == pytest.approx(level, abs=0.05 * noise)


def test_the_fixed_pattern_outlasts_an_average_over_frames() -> None:
    sensor = ImageSensor(ImageDegradation(image_noise=8.0), camera_model(160, 120, 1.0), seed=2)
    frames = 40
    mean = np.mean([sensor.sensed(grey(128), frame).pixels for frame in range(frames)], axis=0)
    expected = np.hypot(8.0 * FIXED_SHARE, np.sqrt((8.0**2 + 1.0 / 12.0) / frames))
    assert mean.std() == pytest.approx(expected, rel=0.03)


# By hand for level 100, c = 255 / 4000: g = (1 - darkness)^2, A = min(1 / g, 8), mean A g 100,
# variance A^2 c g (1 - g) 100.
@pytest.mark.parametrize(
    ("darkness", "mean", "std"),
    [(0.0, 100.0, 0.0), (0.2, 100.0, 1.894), (0.5, 100.0, 4.373), (0.8, 32.0, 3.957), (1.0, 0.0, 0.0)],
)
def test_dark_pictures_are_dark_and_grainy(darkness: float, mean: float, std: float) -> None:
    found = sensed(grey(100), ImageDegradation(darkness=darkness)).astype(float)
    assert found.mean() == pytest.approx(mean, abs=0.1)
    rounding = 1.0 / 12.0 if std else 0.0
    assert found.std() == pytest.approx(np.sqrt(std**2 + rounding), rel=0.02)


def test_the_darker_it_is_the_more_grain_there_is_in_what_is_left() -> None:
    grain = []
    for darkness in np.linspace(0.0, 0.9, 10):
        found = sensed(grey(120), ImageDegradation(darkness=float(darkness), image_noise=0.5)).astype(float)
        grain.append(found.std() / found.mean())
    assert grain == sorted(grain)


def test_a_gain_makes_sensor_noise_louder() -> None:
    """Darkness 0.5: g = 0.25, A = 4, so that noise of 2 levels is one of 8, besides the photons' 4.95."""
    model = camera_model(160, 120, 1.0)
    sensor = ImageSensor(ImageDegradation(darkness=0.5, image_noise=2.0), model, seed=1)
    now, later = (sensor.sensed(grey(128), frame).pixels.astype(float) for frame in (0, 1))
    assert (now - later).std() / np.sqrt(2.0) == pytest.approx(np.hypot(8.0, 4.948), rel=0.02)


def test_black_and_white_clip_and_do_not_wrap() -> None:
    loud = ImageDegradation(image_noise=30.0)
    assert np.median(sensed(grey(255), loud)) > 220
    assert np.median(sensed(grey(0), loud)) < 35


@pytest.mark.parametrize("factor", [2, 5, 16])
def test_lower_resolution_keeps_brightness_and_loses_detail(factor: int) -> None:
    image = random_image(120, 160)
    found = sensed(image, ImageDegradation(image_downscale=factor)).astype(float)
    assert found.mean() == pytest.approx(image.pixels.mean(), abs=1.0)
    assert found.std() < 0.6 * image.pixels.std()
