"""Things throw a soft shadow on what they stand on, the same from wherever it is seen."""

import numpy as np
import pytest

from sim_bridge.homes.materials import material
from sim_bridge.homes.shapes import box
from sim_bridge.sensors.camera import camera_model, look_at
from sim_bridge.sensors.hulls import BOTTOM
from sim_bridge.sensors.scenery import Item, Scenery

LAMP_M = (0.0, 0.0, 2.3)
WHITE = material("white ceramic")


def brightness(*, box_at_m: float | None, eye_m: tuple[float, float, float], x_m: float) -> float:
    """Of the floor at (x_m, 0), with a cube of 0.4 m around the origin whose bottom is at `box_at_m`."""
    floor = box((0.0, 0.0, -0.05), (20.0, 20.0, 0.1), material("white paint"))
    items = [Item(number=1, name="floor", parts=(floor,), light_m=LAMP_M, unseen=(BOTTOM,))]
    if box_at_m is not None:
        cube = (box((0.0, 0.0, 0.2), (0.4, 0.4, 0.4), WHITE),)
        items.append(Item(number=2, name="cube", parts=cube, light_m=LAMP_M, z_m=box_at_m))
    frame = look_at(Scenery(items), camera_model(101, 101, 0.8), eye_m, (x_m, 0.0, 0.0))
    assert frame.numbers[50, 50] == 1
    assert frame.color is not None
    return float(frame.color.pixels[50, 50].mean())


EYE_M = (3.0, 0.5, 1.1)


def test_the_floor_is_darker_beside_what_stands_on_it() -> None:
    light = [
        brightness(box_at_m=0.0, eye_m=EYE_M, x_m=x_m) / brightness(box_at_m=None, eye_m=EYE_M, x_m=x_m)
        for x_m in (0.21, 0.24, 0.27, 0.5)
    ]
    assert light == sorted(light)
    assert light[0] < 0.9
    assert light[-1] == 1.0


def test_what_hangs_above_throws_no_shadow() -> None:
    hanging = brightness(box_at_m=0.05, eye_m=EYE_M, x_m=0.24)
    assert hanging == brightness(box_at_m=None, eye_m=EYE_M, x_m=0.24)


@pytest.mark.parametrize("eye_m", [(2.0, 1.0, 1.5), (0.5, -1.0, 0.8), (0.3, 0.0, 0.5), (0.26, 0.02, 0.06)])
def test_a_shadow_is_the_same_from_everywhere(eye_m: tuple[float, float, float]) -> None:
    """Also from so near that the shadow reaches under the camera."""
    here = brightness(box_at_m=0.0, eye_m=eye_m, x_m=0.24)
    assert here == pytest.approx(brightness(box_at_m=0.0, eye_m=EYE_M, x_m=0.24), abs=2.0)


def test_a_thing_does_not_shade_itself() -> None:
    sheet = (box((0.0, 0.0, 0.002), (0.6, 0.6, 0.004), WHITE),)
    item = Item(number=2, name="mat", parts=sheet, light_m=LAMP_M)
    frame = look_at(Scenery([item]), camera_model(101, 101, 0.4), (0.5, 0.0, 1.5), (0.0, 0.0, 0.0))
    assert frame.color is not None
    levels = frame.color.pixels[frame.numbers == 2].astype(int).sum(axis=1)
    assert np.ptp(levels) < 60
