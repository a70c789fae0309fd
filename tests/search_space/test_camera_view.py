import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.search_space.camera_view import build_camera_view
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

EAST, NORTH = 0.0, math.pi / 2


def one_candidate_at(x_m: float, y_m: float, parameters: SearchSpaceParameters):
    """An open floor of 10 m x 10 m with the one candidate location there."""
    cells = np.zeros((100, 100), dtype=np.int8)
    mask = np.zeros((50, 50), dtype=np.int8)
    mask[int(y_m / 0.2), int(x_m / 0.2)] = 100
    origin = Pose2D(x_m=0.0, y_m=0.0)
    return build_camera_view(
        OccupancyMap(cells=cells, resolution_m=0.1, origin=origin),
        OccupancyMap(cells=mask, resolution_m=0.2, origin=origin),
        parameters,
    )


@pytest.mark.parametrize(
    ("distance_m", "bearing_deg", "seen"),
    [
        (0.49, 0.0, False),
        (0.51, 0.0, True),
        (3.99, 0.0, True),
        (4.01, 0.0, False),
        (2.0, 29.9, True),
        (2.0, -29.9, True),
        (2.0, 30.1, False),
        (2.0, -30.1, False),
        (2.0, 180.0, False),
    ],
)
def test_view_is_a_cone_between_two_ranges(parameters, distance_m, bearing_deg, seen):
    view = one_candidate_at(5.1, 5.1, parameters)
    yaw_rad = 0.7
    towards = yaw_rad + math.radians(bearing_deg)
    robot = Pose2D(
        x_m=5.1 - distance_m * math.cos(towards), y_m=5.1 - distance_m * math.sin(towards), yaw_rad=yaw_rad
    )
    assert view.visible(robot).tolist() == [seen]


def test_range_counts_from_the_camera_not_from_the_robot():
    view = one_candidate_at(5.1, 5.1, SearchSpaceParameters(camera_forward_m=0.3, range_min_m=0.5))
    assert not view.visible(Pose2D(x_m=5.1 - 0.79, y_m=5.1, yaw_rad=EAST))[0]
    assert view.visible(Pose2D(x_m=5.1 - 0.81, y_m=5.1, yaw_rad=EAST))[0]


def test_walls_hide_and_low_furniture_does_not(drawn, parameters):
    floor_map, mask = drawn("........", "..o.o...", "........", "........", "..#.o...", "........")
    view = build_camera_view(floor_map, mask, parameters)
    over_furniture = view.visible(Pose2D(x_m=0.15, y_m=1.35, yaw_rad=EAST))
    behind_wall = view.visible(Pose2D(x_m=0.15, y_m=0.45, yaw_rad=EAST))
    far = view.candidates.x_m > 1.0
    upper = view.candidates.y_m > 1.0
    assert over_furniture[upper].all()
    assert not behind_wall[far & ~upper].any()


def test_unknown_cells_hide(drawn, parameters):
    floor_map, mask = drawn("..?.o..")
    view = build_camera_view(floor_map, mask, parameters)
    assert not view.visible(Pose2D(x_m=0.15, y_m=0.15, yaw_rad=EAST)).any()
    floor_map, mask = drawn("....o..")
    view = build_camera_view(floor_map, mask, parameters)
    assert view.visible(Pose2D(x_m=0.15, y_m=0.15, yaw_rad=EAST)).all()


def test_without_a_mask_an_occupied_cell_hides_others_but_not_itself(drawn, parameters):
    floor_map, _ = drawn("........", "..#.#...", "........")
    view = build_camera_view(floor_map, None, parameters)
    seen = view.visible(Pose2D(x_m=0.15, y_m=0.45, yaw_rad=EAST))
    west_face = np.abs(view.candidates.x_m - 0.65) < 0.1
    second_block = view.candidates.x_m > 1.1
    assert seen[west_face].any()
    assert not seen[second_block].any()


def test_a_robot_outside_the_map_sees_nothing(drawn, parameters):
    floor_map, mask = drawn("....o..")
    view = build_camera_view(floor_map, mask, parameters)
    assert not view.visible(Pose2D(x_m=-1.0, y_m=0.15, yaw_rad=EAST)).any()
    assert not view.visible(Pose2D(x_m=1e6, y_m=-1e6, yaw_rad=NORTH)).any()


@given(
    seed=st.integers(0, 1000),
    x_m=st.floats(0.01, 3.99),
    y_m=st.floats(0.01, 3.99),
    yaw_rad=st.floats(-4.0, 4.0),
)
@settings(max_examples=100, deadline=None)
def test_more_walls_never_show_more(seed, x_m, y_m, yaw_rad):
    rng = np.random.default_rng(seed)
    cells = rng.choice(np.array([0, 0, 0, 0, 100], np.int8), size=(40, 40))
    walled = np.where(rng.random((40, 40)) < 0.1, 100, cells).astype(np.int8)
    cells[0, 0] = walled[0, 0] = 0
    origin = Pose2D(x_m=0.0, y_m=0.0)
    masked = rng.choice(np.array([0, 0, 0, 100], np.int8), size=(20, 20))
    masked[10, 10] = 100
    mask = OccupancyMap(cells=masked, resolution_m=0.2, origin=origin)
    robot = Pose2D(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)
    seen, seen_less = (
        build_camera_view(
            OccupancyMap(cells=c, resolution_m=0.1, origin=origin), mask, SearchSpaceParameters()
        ).visible(robot)
        for c in (cells, walled)
    )
    assert not (seen_less & ~seen).any()
