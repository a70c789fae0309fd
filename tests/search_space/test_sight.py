import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.search_space.camera_view import CameraView, build_camera_view
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.sight import line_of_sight

ORIGIN = Pose2D(x_m=0.0, y_m=0.0)


@given(
    seed=st.integers(0, 1000),
    ax=st.floats(0.0, 3.999),
    ay=st.floats(0.0, 3.999),
    bx=st.floats(0.0, 3.999),
    by=st.floats(0.0, 3.999),
)
@settings(max_examples=300, deadline=None)
def test_who_sees_is_seen(seed, ax, ay, bx, by):
    """The line of sight is the same in both directions, but for the patches that each end may look over."""
    cells = np.random.default_rng(seed).choice(np.array([0, 0, 0, 100], np.int8), size=(20, 20))
    cells[0, 0] = 0
    cells[int(ay / 0.2), int(ax / 0.2)] = 0
    cells[int(by / 0.2), int(bx / 0.2)] = 0
    floor_map = OccupancyMap(cells=cells, resolution_m=0.2, origin=ORIGIN)
    mask = OccupancyMap(cells=np.full((1, 1), 100, dtype=np.int8), resolution_m=0.1, origin=ORIGIN)
    view = build_camera_view(floor_map, mask, SearchSpaceParameters())
    scene = view.scene._replace(candidate_half_m=0.0)
    assert line_of_sight(scene, ax, ay, bx, by) == line_of_sight(scene, bx, by, ax, ay)


def seen_one_by_one(view: CameraView, pose: Pose2D) -> np.ndarray:
    """Cone, range and line of sight worked out for every candidate."""
    scene = view.scene
    camera_x = pose.x_m + scene.camera_forward_m * math.cos(pose.yaw_rad)
    camera_y = pose.y_m + scene.camera_forward_m * math.sin(pose.yaw_rad)
    seen = []
    for x_m, y_m in zip(view.candidates.x_m, view.candidates.y_m, strict=True):
        range_m = math.hypot(x_m - camera_x, y_m - camera_y)
        bearing_rad = math.remainder(math.atan2(y_m - camera_y, x_m - camera_x) - pose.yaw_rad, math.tau)
        in_view = (
            scene.range_min_m <= range_m <= scene.range_max_m and abs(bearing_rad) <= scene.half_view_rad
        )
        seen.append(in_view and line_of_sight(scene, camera_x, camera_y, x_m, y_m))
    return np.array(seen)


@given(
    seed=st.integers(0, 1000),
    x_m=st.floats(-3.0, 23.0),
    y_m=st.floats(-3.0, 23.0),
    yaw_rad=st.floats(-4.0, 4.0),
    range_max_m=st.sampled_from([1.0, 4.0, 30.0]),
)
@settings(max_examples=100, deadline=None)
def test_looking_only_into_near_buckets_misses_nothing(seed, x_m, y_m, yaw_rad, range_max_m):
    rng = np.random.default_rng(seed)
    cells = rng.choice(np.array([0, 100], np.int8), p=[0.97, 0.03], size=(100, 100))
    masked = rng.choice(np.array([0, 100], np.int8), p=[0.9, 0.1], size=(50, 50))
    cells[0, 0], masked[25, 25] = 0, 100
    view = build_camera_view(
        OccupancyMap(cells=cells, resolution_m=0.2, origin=ORIGIN),
        OccupancyMap(cells=masked, resolution_m=0.4, origin=ORIGIN),
        SearchSpaceParameters(range_max_m=range_max_m),
    )
    robot = Pose2D(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)
    np.testing.assert_array_equal(view.visible(robot), seen_one_by_one(view, robot))
