"""The settings that benchmarks compare, and the camera that has all of them."""

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.parameters import build
from robustnav_msgs_py.values import Velocity
from sim_bridge.robot.drive import STANDSTILL
from sim_bridge.sensors.degradations import DEGRADATIONS, ImageDegradation
from sim_bridge.sensors.degraded_camera import DegradedCamera
from sim_bridge.simulation import Simulation

TURNING = Velocity(linear_m_s=0.0, angular_rad_s=1.2)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("exposure_s", 0.2),
        ("exposure_s", -0.01),
        ("darkness", 1.1),
        ("image_noise", float("nan")),
        ("image_downscale", 0),
        ("image_downscale", 1.5),
        ("depth_noise", 1.0),
        ("depth_step", -1.0),
        ("depth_holes", 2.0),
    ],
)
def test_values_out_of_range_are_refused_by_name(name: str, value: float) -> None:
    with pytest.raises(BadParameterError, match=name):
        ImageDegradation(**{name: value})
    with pytest.raises(BadParameterError, match=name):
        build(ImageDegradation, {name: value})


def test_none_is_the_perfect_camera(simulation: Simulation) -> None:
    pose = simulation.home.start
    perfect = simulation._camera.take(pose, 9)
    found = DegradedCamera(simulation._camera, DEGRADATIONS["none"], seed=1).take(pose, TURNING, 0, 9)
    assert (found.color.pixels == perfect.color.pixels).all()
    assert (found.depth.depth_m == perfect.depth.depth_m).all()
    assert found.model == perfect.model


@pytest.mark.parametrize("name", [name for name in DEGRADATIONS if name != "none"])
def test_each_setting_makes_pictures_worse_and_keeps_their_form(name: str, simulation: Simulation) -> None:
    pose = simulation.home.start
    perfect = simulation._camera.take(pose, 9)
    camera = DegradedCamera(simulation._camera, DEGRADATIONS[name], seed=1)
    found = camera.take(pose, TURNING, 4, 9)
    same_color = (found.color.pixels == perfect.color.pixels).all()
    same_depth = np.array_equal(found.depth.depth_m, perfect.depth.depth_m, equal_nan=True)
    assert not (same_color and same_depth)
    assert same_color == (name == "holes")
    assert same_depth == (name not in {"holes", "noise"})
    assert found.color.pixels.shape == perfect.color.pixels.shape
    assert found.depth.depth_m.shape == perfect.depth.depth_m.shape
    assert {found.color.stamp_ns, found.depth.stamp_ns, found.model.stamp_ns} == {9}
    assert (np.isposinf(found.depth.depth_m) == np.isposinf(perfect.depth.depth_m)).all()
    again = camera.take(pose, TURNING, 4, 9)
    assert (again.color.pixels == found.color.pixels).all()
    assert np.array_equal(again.depth.depth_m, found.depth.depth_m, equal_nan=True)


def test_depth_and_numbers_are_of_the_pose_that_the_stamp_means(simulation: Simulation) -> None:
    pose = simulation.home.start
    camera = DegradedCamera(simulation._camera, DEGRADATIONS["blur"], seed=1)
    still, turning = camera.take(pose, STANDSTILL, 0, 9), camera.take(pose, TURNING, 0, 9)
    assert (still.depth.depth_m == turning.depth.depth_m).all()
    assert (still.numbers == turning.numbers).all()
