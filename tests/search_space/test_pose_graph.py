import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.search_space.floor_grid import floor_grid
from robustnav_nodes.search_space.lattice import heading_steps
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action, PoseGraph, build_pose_graph

UNDO = {
    Action.FORWARD: Action.BACKWARD,
    Action.BACKWARD: Action.FORWARD,
    Action.TURN_LEFT: Action.TURN_RIGHT,
    Action.TURN_RIGHT: Action.TURN_LEFT,
}


def graph_of(floor_map: OccupancyMap, start: Pose2D | None = None, **changes) -> PoseGraph:
    parameters = SearchSpaceParameters(**changes)
    return build_pose_graph(floor_grid(floor_map, parameters), parameters, start)


def random_map(seed: int) -> OccupancyMap:
    blocks = np.random.default_rng(seed).choice(np.array([0, 0, 0, 100, -1], np.int8), size=(7, 9))
    blocks[3, 4] = 0
    cells = np.kron(blocks, np.ones((12, 12), dtype=np.int8))
    return OccupancyMap(cells=cells, resolution_m=0.05, origin=Pose2D(x_m=-1.3, y_m=2.7))


@given(seed=st.integers(0, 10_000), headings=st.sampled_from([4, 6, 8, 12, 16]))
@settings(max_examples=40, deadline=None)
def test_every_action_is_undone_by_its_opposite(seed, headings):
    graph = graph_of(random_map(seed), headings=headings)
    for action, undo in UNDO.items():
        begins = np.nonzero(graph.successors[:, action] != NOWHERE)[0]
        ends = graph.successors[begins, action]
        np.testing.assert_array_equal(graph.successors[ends, undo], begins)


@given(seed=st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_robot_never_touches_what_is_not_free(seed):
    """Neither where it stands nor half way of a move is a blocked cell's middle within the radius."""
    floor_map = random_map(seed)
    graph = graph_of(floor_map)
    row, column = np.nonzero(floor_map.cells != 0)
    blocked_x = floor_map.origin.x_m + (column + 0.5) * floor_map.resolution_m
    blocked_y = floor_map.origin.y_m + (row + 0.5) * floor_map.resolution_m
    ends = graph.successors[:, Action.FORWARD]
    ends = np.where(ends == NOWHERE, np.arange(len(graph)), ends)
    for share in (0.0, 0.5, 1.0):
        x_m = (1 - share) * graph.x_m + share * graph.x_m[ends]
        y_m = (1 - share) * graph.y_m + share * graph.y_m[ends]
        places = np.unique(np.stack([x_m, y_m], axis=1), axis=0)
        distance = np.hypot(places[:, :1] - blocked_x, places[:, 1:] - blocked_y)
        assert distance.size == 0 or distance.min() >= 0.18


@pytest.mark.parametrize(
    ("heading_deg", "step"),
    [(0, (1, 0)), (30, (1, 1)), (60, (1, 1)), (90, (0, 1)), (120, (-1, 1)), (210, (-1, -1)), (330, (1, -1))],
)
def test_forward_goes_to_the_lattice_place_ahead(heading_deg, step):
    assert tuple(heading_steps(12)[heading_deg // 30]) == step


@pytest.mark.parametrize("headings", [4, 8, 12, 16, 72])
def test_opposite_headings_step_in_opposite_directions(headings):
    steps = heading_steps(headings)
    np.testing.assert_array_equal(np.roll(steps, headings // 2, axis=0), -steps)
    assert np.all(np.any(steps != 0, axis=1))


def test_poses_of_an_open_floor(drawn):
    """Five by four cells of 0.3 m; a robot of 0.1 m fits in the middle of each."""
    floor_map, _ = drawn(".....", ".....", ".....", ".....")
    graph = graph_of(floor_map, robot_radius_m=0.1)
    assert len(graph) == 5 * 4 * 12
    corner = graph.nearest(Pose2D(x_m=0.15, y_m=0.15, yaw_rad=0.0))
    assert graph.pose(corner) == Pose2D(x_m=0.15, y_m=0.15)
    assert graph.legal_actions(corner) == (Action.FORWARD, Action.TURN_LEFT, Action.TURN_RIGHT)
    left = graph.pose(int(graph.successors[corner, Action.TURN_LEFT]))
    assert left.yaw_rad == pytest.approx(math.radians(30))


def test_diagonal_move_does_not_cut_a_corner(drawn):
    floor_map, _ = drawn("#..", ".#.", "..#")
    graph = graph_of(floor_map, robot_radius_m=0.1)
    diagonal = graph.nearest(Pose2D(x_m=0.15, y_m=0.45, yaw_rad=math.radians(60)))
    assert graph.successors[diagonal, Action.FORWARD] == NOWHERE


def test_unknown_floor_is_not_driven_on(drawn):
    floor_map, _ = drawn("...", "?.?", "...")
    graph = graph_of(floor_map, robot_radius_m=0.1)
    assert len(graph) == 7 * 12


@pytest.mark.parametrize("yaw_rad", [-0.1, 0.1, math.tau - 0.1, math.tau + 0.1, -math.tau])
def test_nearest_pose_has_the_nearest_heading(drawn, yaw_rad):
    floor_map, _ = drawn("...", "...")
    graph = graph_of(floor_map, robot_radius_m=0.1)
    assert graph.nearest(Pose2D(x_m=0.4, y_m=0.2, yaw_rad=yaw_rad)) == 12


def test_start_leaves_only_what_it_reaches(drawn):
    floor_map, _ = drawn("..#....", "..#....")
    everything = graph_of(floor_map, robot_radius_m=0.1)
    left = graph_of(floor_map, Pose2D(x_m=0.2, y_m=0.2), robot_radius_m=0.1)
    right = graph_of(floor_map, Pose2D(x_m=1.5, y_m=0.2), robot_radius_m=0.1)
    assert (len(left), len(right), len(everything)) == (4 * 12, 8 * 12, 12 * 12)
    assert left.x_m.max() < 0.6 < 0.9 < right.x_m.min()


def test_start_outside_the_floor_is_refused(drawn):
    floor_map, _ = drawn("..", "..")
    with pytest.raises(BadMapError, match=r"robot is at \(9\.00, 0\.20\).*localised"):
        graph_of(floor_map, Pose2D(x_m=9.0, y_m=0.2), robot_radius_m=0.1)


def test_robot_that_fits_nowhere_is_refused(drawn):
    floor_map, _ = drawn("..", "..")
    with pytest.raises(BadMapError, match=r"radius 1 m fits nowhere.*lower robot_radius_m"):
        graph_of(floor_map, robot_radius_m=1.0)


def test_shortest_path_counts_actions(drawn):
    """Two turns and three moves around an obstacle, worked by hand with headings of 90 degrees."""
    floor_map, _ = drawn("...", ".#.", "...")
    graph = graph_of(floor_map, robot_radius_m=0.1, headings=4)
    start = graph.nearest(Pose2D(x_m=0.15, y_m=0.15, yaw_rad=0.0))
    goal = graph.nearest(Pose2D(x_m=0.75, y_m=0.45, yaw_rad=math.pi / 2))
    path = graph.shortest_path(start, goal)
    assert path is not None
    assert len(path) - 1 == graph.steps_from(start)[goal] == 4
    assert path[0] == start
    assert path[-1] == goal
    for a, b in pairwise(path):
        assert b in graph.successors[a]


def test_closed_way_stays_closed_in_both_directions(drawn):
    floor_map, _ = drawn("...")
    graph = graph_of(floor_map, robot_radius_m=0.1, headings=4)
    a = graph.nearest(Pose2D(x_m=0.15, y_m=0.15))
    b = graph.nearest(Pose2D(x_m=0.45, y_m=0.15))
    closed = graph.without_way(a, b)
    assert closed.successors[a, Action.FORWARD] == NOWHERE
    assert closed.successors[b, Action.BACKWARD] == NOWHERE
    facing_back = graph.nearest(Pose2D(x_m=0.45, y_m=0.15, yaw_rad=math.pi))
    assert closed.successors[facing_back, Action.FORWARD] == NOWHERE
    assert closed.shortest_path(a, b) is None
    assert graph.successors[a, Action.FORWARD] == b


def test_closed_turn_closes_only_that_turn(drawn):
    floor_map, _ = drawn("...")
    graph = graph_of(floor_map, robot_radius_m=0.1, headings=4)
    closed = graph.without_way(0, 1)
    assert closed.successors[0, Action.TURN_LEFT] == NOWHERE
    assert closed.successors[1, Action.TURN_RIGHT] == NOWHERE
    assert (closed.successors != graph.successors).sum() == 2
