import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.planner.docking import destination_pose
from robustnav_nodes.search_space.observability import Observability


@pytest.fixture
def open_floor(space_of):
    """A table in the middle of the south wall; the robot comes from the north."""
    return space_of(
        "###########",
        "#.........#",
        "#.........#",
        "#.........#",
        "#.........#",
        "#.........#",
        "#....o....#",
        "###########",
    )


def test_docking_pose_by_hand(open_floor):
    """The table is at (1.65, 0.45). Three cells north of it and facing it, 0.9 m off, fits 0.8 m best."""
    graph = open_floor.graph
    start = graph.nearest(Pose2D(x_m=1.65, y_m=1.95, yaw_rad=1.5 * math.pi))
    found = destination_pose(open_floor, graph, start, 0, distance_m=0.8)
    assert found is not None
    pose = graph.pose(found)
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((1.65, 1.35, 1.5 * math.pi))


@pytest.mark.parametrize("distance_m", [0.6, 0.9, 1.2])
def test_the_wanted_distance_is_kept(open_floor, distance_m):
    graph = open_floor.graph
    found = destination_pose(open_floor, graph, 0, 0, distance_m)
    pose = graph.pose(found)
    off = math.hypot(open_floor.candidates.x_m[0] - pose.x_m, open_floor.candidates.y_m[0] - pose.y_m)
    assert off == pytest.approx(distance_m, abs=0.1)


@given(location=st.integers(0, 10_000), start=st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_the_destination_sees_the_location_and_can_be_reached(home, location, start):
    location %= len(home.candidates)
    start %= len(home.graph)
    found = destination_pose(home, home.graph, start, location, 0.8)
    assert found is not None
    assert home.observability.column(location)[found]
    assert np.isfinite(home.graph.steps_from(start)[found])
    assert destination_pose(home, home.graph, found, location, 0.8) == found


def test_a_location_that_no_pose_sees_is_faced(space_of):
    """Range 0.5 m and more, and a robot that can only stand 0.3 m away: it faces the location from there."""
    space = space_of("#####", "#..o#", "#####", range_min_m=0.5)
    location, graph = 0, space.graph
    nothing_seen = Observability.of_rows(
        np.zeros(len(graph) + 1, dtype=np.int64), np.zeros(0, dtype=np.int32), len(space.candidates)
    )
    space = dataclasses.replace(space, observability=nothing_seen)
    found = destination_pose(space, graph, 0, location, 0.3)
    pose = graph.pose(found)
    assert (pose.x_m, pose.y_m, pose.yaw_rad) == pytest.approx((0.75, 0.45, 0.0))


def test_no_way_gives_no_destination(space_of):
    space = space_of("##########", "#..##...o#", "##########", headings=12)
    lonely = space.graph.nearest(Pose2D(x_m=0.45, y_m=0.45, yaw_rad=math.pi / 2))
    turns_closed = space.graph
    for action in turns_closed.legal_actions(lonely):
        turns_closed = turns_closed.without_way(lonely, int(turns_closed.successors[lonely, action]))
    assert destination_pose(space, turns_closed, lonely, 0, 0.5) is None
    assert destination_pose(space, space.graph, lonely, 0, 0.5) is not None
