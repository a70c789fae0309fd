"""Every pixel is an exact sample: rays through the primitives, and PyBullet, say the same."""

import math

import numpy as np
import pytest

from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.values import Float64, Pose2D
from sim_bridge.homes.home import Home
from sim_bridge.homes.materials import material
from sim_bridge.homes.shapes import Axis, Part, Shape, Vector3, ball, box, cylinder, first_hit_m
from sim_bridge.sensors.camera import Camera, CameraFrame, camera_model, look_at, map_from_optical
from sim_bridge.sensors.rasterizer import NEAR_M, NOTHING
from sim_bridge.sensors.scenery import FIRST_OTHER, Item, Scenery, scenery_of
from sim_bridge.sensors.world import World

PAINT = material("red paint")
MOUNT = CameraMount()
MODEL = camera_model(320, 240, math.radians(60.0))
REACH_M = 20.0


def item(number: int, *parts: Part, at_m: Vector3 = (0.0, 0.0, 0.0), yaw_rad: float = 0.0) -> Item:
    x_m, y_m, z_m = at_m
    return Item(
        number=number,
        name=str(number),
        parts=parts,
        light_m=(0.0, 0.0, 2.3),
        x_m=x_m,
        y_m=y_m,
        z_m=z_m,
        yaw_rad=yaw_rad,
    )


def rays(pose: Pose2D, u: Float64, v: Float64) -> tuple[Float64, Float64]:
    """The eye, and for each pixel the vector from it to depth 1, both in `map`."""
    ahead = np.stack([(u - MODEL.cx) / MODEL.fx, (v - MODEL.cy) / MODEL.fy, np.ones(len(u))], axis=1)
    eye = map_from_optical(MOUNT, pose, np.zeros((1, 3)))[0]
    return eye, map_from_optical(MOUNT, pose, ahead) - eye


def truth(home: Home, eye: Float64, ahead: Float64) -> tuple[Float64, np.ndarray]:
    """Depth of, and number of, what rays through the exact primitives meet first."""
    depth, number = np.full(len(ahead), np.inf), np.full(len(ahead), NOTHING)
    lengths = np.linalg.norm(ahead, axis=1)
    for thing in scenery_of(home).items.values():
        cos, sin = math.cos(thing.yaw_rad), math.sin(thing.yaw_rad)
        turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
        origin = turn @ (eye - (thing.x_m, thing.y_m, thing.z_m))
        hit = first_hit_m(thing.parts, origin, ahead @ turn.T / lengths[:, None]) / lengths
        nearer = hit < depth
        depth[nearer], number[nearer] = hit[nearer], thing.number
    return depth, number


def away_from_edges(frame: CameraFrame, u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Whether the pixel's neighbours show the same item, at about the same depth."""
    depth = frame.depth.depth_m
    calm = np.ones(len(u), dtype=bool)
    for du, dv in ((1, 0), (-1, 0), (0, 1), (0, -1)):
        p, q = np.clip(u + du, 0, MODEL.width - 1), np.clip(v + dv, 0, MODEL.height - 1)
        calm &= frame.numbers[q, p] == frame.numbers[v, u]
        calm &= np.abs(depth[q, p] - depth[v, u]) < 0.1
    return calm


def test_depth_and_numbers_agree_with_the_primitives(small_home: Home, viewpoints: list[Pose2D]) -> None:
    camera = Camera(scenery_of(small_home), MODEL, MOUNT, REACH_M)
    rng = np.random.default_rng(0)
    same, errors, flat_errors = [], [], []
    for pose in viewpoints:
        frame = camera.take(pose, 0, color=False)
        u, v = rng.integers(0, MODEL.width, 1500), rng.integers(0, MODEL.height, 1500)
        depth, number = truth(small_home, *rays(pose, u, v))
        shown = frame.numbers[v, u]
        same.append(shown == number)
        both = (shown == number) & (shown != NOTHING) & away_from_edges(frame, u, v)
        errors.append(np.abs(frame.depth.depth_m[v, u] - depth)[both])
        is_flat = np.array(
            [
                all(part.shape is Shape.BOX for part in camera.scenery.items[int(at)].parts)
                for at in shown[both]
            ]
        )
        flat_errors.append(errors[-1][is_flat])
    assert np.concatenate(same).mean() >= 0.995
    assert np.concatenate(flat_errors).max() < 0.001
    # Round parts are polygons, and a pixel may lie at the edge between two parts of one thing.
    assert np.percentile(np.concatenate(errors), 99.9) < 0.005
    assert len(np.concatenate(errors)) > 10_000


def test_depth_and_instances_agree_with_pybullet(small_home: Home, viewpoints: list[Pose2D]) -> None:
    camera = Camera(scenery_of(small_home), MODEL, MOUNT, REACH_M)
    rng = np.random.default_rng(1)
    same, errors = [], []
    with World(small_home) as world:
        for pose in viewpoints:
            frame = camera.take(pose, 0, color=False)
            u, v = rng.integers(0, MODEL.width, 800), rng.integers(0, MODEL.height, 800)
            eye, ahead = rays(pose, u, v)
            shares, bodies = world.cast(np.tile(eye, (len(u), 1)), eye + REACH_M * ahead)
            met = np.array([world.instance_of.get(int(body), NOTHING) for body in bodies])
            shown = frame.numbers[v, u]
            same.append(np.where(shown < FIRST_OTHER, shown, NOTHING) == met)
            both = same[-1] & (bodies != NOTHING) & away_from_edges(frame, u, v)
            errors.append(np.abs(frame.depth.depth_m[v, u] - REACH_M * shares)[both])
    assert np.concatenate(same).mean() >= 0.995
    assert np.percentile(np.concatenate(errors), 99) < 0.02
    assert np.median(np.concatenate(errors)) < 0.001


@pytest.mark.parametrize(
    "part",
    [
        box((0.0, 0.0, 0.0), (0.5, 0.3, 0.4), PAINT),
        ball((0.0, 0.0, 0.0), 0.5, PAINT),
        *(cylinder((0.0, 0.0, 0.0), 0.3, 0.5, PAINT, axis) for axis in Axis),
    ],
)
def test_solids_have_no_holes(part: Part) -> None:
    """Each row of a convex solid's picture is one stretch, from wherever it is seen."""
    rng = np.random.default_rng(2)
    scenery = Scenery([item(5, part, yaw_rad=0.4)])
    model = camera_model(160, 120, 1.0)
    for _ in range(40):
        eye = rng.normal(size=3)
        eye *= rng.uniform(0.8, 2.0) / np.linalg.norm(eye)
        frame = look_at(scenery, model, (eye[0], eye[1], eye[2]), (0.0, 0.0, 0.0))
        for row in frame.numbers:
            (columns,) = np.nonzero(row == 5)
            assert len(columns) == 0 or columns[-1] - columns[0] + 1 == len(columns)


def test_a_wall_right_before_the_camera_fills_the_picture() -> None:
    level = CameraMount(x_m=0.0, z_m=1.0, pitch_rad=0.0)
    scenery = Scenery([item(1, box((0.56, 0.0, 1.0), (1.0, 8.0, 8.0), PAINT))])
    frame = Camera(scenery, MODEL, level, 10.0).take(Pose2D(x_m=0.0, y_m=0.0), 0)
    np.testing.assert_allclose(frame.depth.depth_m, 0.06, atol=1e-5)
    assert (frame.numbers == 1).all()


def test_what_is_nearer_than_the_near_plane_is_cut_off() -> None:
    """A floor that begins behind the camera is cut where it comes too near, and exact beyond that."""
    scenery = Scenery([item(1, box((0.0, 0.0, -0.5), (30.0, 30.0, 1.0), PAINT))])
    model = camera_model(321, 241, math.radians(120.0))
    for height_m in (0.02, 0.06, 1.0):
        frame = look_at(scenery, model, (0.0, 0.0, height_m), (1.0, 0.0, height_m))
        rows = np.arange(241)
        below = (rows - model.cy) / model.fy
        depth = np.where(below > 0.0, height_m / np.where(below > 0.0, below, 1.0), np.inf)
        shown = (depth > NEAR_M * 1.001) & (depth < 14.9)
        np.testing.assert_allclose(frame.depth.depth_m[shown, 160], depth[shown], rtol=1e-4)
        assert np.isposinf(frame.depth.depth_m[(depth < NEAR_M * 0.999) | (below <= 0.0), 160]).all()


def test_inside_a_solid_nothing_of_it_is_seen() -> None:
    scenery = Scenery([item(1, box((0.0, 0.0, 0.0), (2.0, 2.0, 2.0), PAINT))])
    frame = look_at(scenery, MODEL, (0.1, 0.2, 0.3), (0.9, 0.2, 0.1))
    assert (frame.numbers == NOTHING).all()
    assert np.isposinf(frame.depth.depth_m).all()


def test_an_empty_scenery_shows_nothing() -> None:
    frame = look_at(Scenery([]), MODEL, (0.0, 0.0, 1.0), (1.0, 0.0, 1.0))
    assert (frame.numbers == NOTHING).all()


@pytest.mark.parametrize("size", [(1, 1), (33, 17), (641, 479), (2, 300)])
def test_pictures_of_any_size_show_the_same_middle(small_home: Home, size: tuple[int, int]) -> None:
    model = camera_model(*size, math.radians(60.0))
    frame = look_at(scenery_of(small_home), model, (1.0, 1.0, 1.1), (2.4, 2.4, 0.76))
    assert frame.color is not None
    assert frame.color.pixels.shape == (size[1], size[0], 3)
    if size[0] % 2 and size[1] % 2:
        distance_m = math.dist((1.0, 1.0, 1.1), (2.4, 2.4, 0.76))
        assert frame.depth.depth_m[size[1] // 2, size[0] // 2] == pytest.approx(distance_m, abs=1e-3)


def test_what_is_drawn_first_never_hides_what_is_nearer(small_home: Home, viewpoints: list[Pose2D]) -> None:
    """The picture does not depend on the order of the items, but for ties."""
    items = list(scenery_of(small_home).items.values())
    there, back = (Camera(Scenery(order), MODEL, MOUNT, 10.0) for order in (items, items[::-1]))
    for pose in viewpoints:
        one, two = there.take(pose, 0, color=False), back.take(pose, 0, color=False)
        np.testing.assert_allclose(one.depth.depth_m, two.depth.depth_m, rtol=2e-5)
        assert (one.numbers != two.numbers).mean() < 1e-3


def test_a_moved_thing_is_seen_where_it_is_now(small_home: Home) -> None:
    scenery = scenery_of(small_home)
    scenery.move(2, 2.0, 1.0, 0.3, 0.0)
    frame = look_at(scenery, MODEL, (1.0, 1.0, 0.39), (2.0, 1.0, 0.39))
    rows, columns = np.nonzero(frame.numbers == 2)
    assert (rows.mean(), columns.mean()) == pytest.approx((MODEL.cy, MODEL.cx), abs=0.6)
