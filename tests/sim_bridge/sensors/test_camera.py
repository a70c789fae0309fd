"""The pictures are what the camera's model says."""

import math

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadSceneError
from robustnav_msgs_py.frames import CameraMount, map_from_base, optical_from_base
from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.home import Home
from sim_bridge.homes.materials import material
from sim_bridge.homes.shapes import Vector3, box
from sim_bridge.sensors.camera import OPTICAL_FRAME, Camera, camera_model, look_at
from sim_bridge.sensors.rasterizer import NOTHING
from sim_bridge.sensors.scenery import Item, Scenery, scenery_of

MOUNT = CameraMount()


def lone_box(centre_m: Vector3, size_m: Vector3) -> Scenery:
    parts = (box(centre_m, size_m, material("red paint")),)
    return Scenery([Item(number=7, name="box", parts=parts, light_m=(0.0, 0.0, 2.3))])


@pytest.mark.parametrize("yaw_rad", [0.0, 0.3, -0.4])
@pytest.mark.parametrize("ahead", [(2.0, 0.0, 0.8), (1.5, 0.4, 0.5), (3.0, -0.8, 0.2)])
def test_known_points_project_to_the_right_pixels(ahead: Vector3, yaw_rad: float) -> None:
    pose = Pose2D(x_m=0.7, y_m=-0.4, yaw_rad=yaw_rad)
    x_m, y_m, z_m = map_from_base(pose, np.array([ahead]))[0].tolist()
    model = camera_model(320, 240, math.radians(60.0))
    scenery = lone_box((x_m, y_m, z_m), (0.04, 0.04, 0.04))
    numbers = Camera(scenery, model, MOUNT, 10.0).take(pose, 0).numbers
    rows, columns = np.nonzero(numbers == 7)
    point = optical_from_base(MOUNT, np.array([ahead]))[0]
    assert len(rows) > 5
    assert np.mean((columns.min(), columns.max())) == pytest.approx(
        model.cx + model.fx * point[0] / point[2], abs=1.0
    )
    assert np.mean((rows.min(), rows.max())) == pytest.approx(
        model.cy + model.fy * point[1] / point[2], abs=1.0
    )


@pytest.mark.parametrize("edge_m", np.linspace(-0.31, 0.29, 7).tolist())
def test_edges_lie_between_the_right_pixels(edge_m: float) -> None:
    """A pixel's sample is at its centre: one at column u shows what projects to u, not to u + 1."""
    level = CameraMount(x_m=0.0, z_m=0.0, pitch_rad=0.0)
    model = camera_model(320, 240, math.radians(60.0))
    wall = lone_box((2.0, edge_m + 2.0, edge_m + 2.0), (0.002, 4.0, 4.0))
    numbers = Camera(wall, model, level, 10.0).take(Pose2D(x_m=0.0, y_m=0.0), 0).numbers
    rows, columns = np.nonzero(numbers != NOTHING)
    assert columns.max() == math.floor(model.cx - model.fx * edge_m / 1.999)
    assert rows.max() == math.floor(model.cy - model.fy * edge_m / 1.999)


def test_nothing_to_see_is_infinitely_far() -> None:
    model = camera_model(64, 48, math.radians(60.0))
    scenery = lone_box((3.0, 0.0, 0.5), (0.5, 0.5, 0.5))
    far = Camera(scenery, model, MOUNT, 10.0).take(Pose2D(x_m=0.0, y_m=0.0), 0)
    near = Camera(scenery, model, MOUNT, 1.0).take(Pose2D(x_m=0.0, y_m=0.0), 0)
    assert np.isfinite(far.depth.depth_m).any()
    assert (np.isinf(far.depth.depth_m) == (far.numbers == NOTHING)).all()
    assert np.isposinf(near.depth.depth_m).all()


def test_a_frame_is_stamped_and_may_leave_colour_out(small_home: Home, viewpoints: list[Pose2D]) -> None:
    camera = Camera(scenery_of(small_home), camera_model(320, 240, 1.0), MOUNT, 10.0)
    frame = camera.take(viewpoints[0], 42)
    assert frame.color is not None
    assert {frame.color.stamp_ns, frame.depth.stamp_ns, frame.model.stamp_ns} == {42}
    assert {frame.color.frame_id, frame.depth.frame_id, frame.model.frame_id} == {OPTICAL_FRAME}
    without = camera.take(viewpoints[0], 42, color=False)
    assert without.color is None
    np.testing.assert_array_equal(without.depth.depth_m, frame.depth.depth_m)
    np.testing.assert_array_equal(without.numbers, frame.numbers)


def test_the_same_pose_gives_the_same_bytes(small_home: Home, viewpoints: list[Pose2D]) -> None:
    pictures = []
    for _ in range(2):
        camera = Camera(scenery_of(small_home), camera_model(161, 119, 1.0), MOUNT, 10.0)
        frames = [camera.take(pose, 0) for pose in viewpoints]
        pictures.append(b"".join(frame.color.pixels.tobytes() for frame in frames if frame.color))
    assert len(pictures[0]) == len(viewpoints) * 161 * 119 * 3
    assert pictures[0] == pictures[1]


def test_the_model_has_the_asked_for_view() -> None:
    model = camera_model(320, 240, math.radians(60.0))
    assert model.fx == pytest.approx(320 / (2 * math.tan(math.radians(30.0))))
    assert model.horizontal_view_rad == pytest.approx(math.radians(60.0))


def test_from_above_north_is_up(small_home: Home) -> None:
    """The whole home from above: its chest is in the south-east, its table in the north-west."""
    model = camera_model(400, 300, 1.0)
    frame = look_at(scenery_of(small_home), model, (4.0, 1.75, 9.0), (4.0, 1.75, 0.0))
    numbers = {item.name: number for number, item in scenery_of(small_home).items.items()}
    place = {
        name: [axis.mean() for axis in np.nonzero(frame.numbers == numbers[name])]
        for name in ("table", "chest")
    }
    assert place["table"][0] < model.cy < place["chest"][0]
    assert place["table"][1] < model.cx < place["chest"][1]
    assert {0, 1, 2} <= set(np.unique(frame.numbers).tolist())


def test_looking_at_oneself_is_refused() -> None:
    with pytest.raises(BadSceneError, match="cannot look at where it is itself"):
        look_at(Scenery([]), camera_model(8, 6, 1.0), (1.0, 2.0, 3.0), (1.0, 2.0, 3.0))
