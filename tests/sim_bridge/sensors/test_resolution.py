"""Lower resolution loses detail, and neither size nor brightness nor place."""

import numpy as np
import pytest

from sim_bridge.sensors.resolution import Resolution

SIZES = [(1, 1), (1, 9), (33, 17), (48, 64)]
FACTORS = [1, 2, 3, 4, 16]


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("size", SIZES)
def test_each_area_becomes_its_mean(size: tuple[int, int], factor: int) -> None:
    pixels = np.random.default_rng(3).integers(0, 256, (*size, 3), dtype=np.uint8)
    small = Resolution(*size, 3, factor).shrunk(pixels)
    rows, columns = -(-size[0] // factor), -(-size[1] // factor)
    assert small.shape == (rows, columns, 3)
    for row in range(rows):
        for column in range(columns):
            area = pixels[row * factor : (row + 1) * factor, column * factor : (column + 1) * factor]
            assert small[row, column] == pytest.approx(area.reshape(-1, 3).mean(axis=0), abs=1e-4)


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("size", SIZES)
def test_one_colour_stays_as_it_is(size: tuple[int, int], factor: int) -> None:
    resolution = Resolution(*size, 3, factor)
    pixels = np.broadcast_to(np.array([3, 200, 255], dtype=np.uint8), (*size, 3))
    back = resolution.enlarged(resolution.shrunk(pixels))
    assert back.shape == (*size, 3)
    assert np.abs(back - pixels).max() < 1e-3


@pytest.mark.parametrize("factor", FACTORS)
def test_a_ramp_stays_in_its_place(factor: int) -> None:
    """Enlarging neither shifts nor stretches: between the outer areas' middles a ramp is the same ramp."""
    width = 50
    resolution = Resolution(2, width, 1, factor)
    ramp = np.broadcast_to((np.arange(width, dtype=np.uint8) * 2)[None, :, None], (2, width, 1))
    back = resolution.enlarged(resolution.shrunk(ramp))
    inner = slice(factor, width - factor)
    assert np.abs(back[:, inner] - ramp[:, inner]).max(initial=0.0) < 1e-3


def test_stripes_of_one_pixel_vanish() -> None:
    stripes = np.zeros((8, 8, 3), dtype=np.uint8)
    stripes[:, ::2] = 200
    resolution = Resolution(8, 8, 3, 2)
    assert resolution.enlarged(resolution.shrunk(stripes)) == pytest.approx(np.full((8, 8, 3), 100.0))
