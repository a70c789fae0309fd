"""Ways keep their distance, and there is one wherever the robot fits through."""

import math
from itertools import pairwise

import numpy as np
import pytest

from sim_bridge.homes.home import Home
from sim_bridge.homes.obstacles import ClearanceGrid, Obstacles
from sim_bridge.homes.rect import Rect
from sim_bridge.robot.route import SPARE_M, NoWayError, Point, RoutePlanner

KEEP_M = 0.16
HALL = Rect(x_min_m=0.0, y_min_m=0.0, x_max_m=6.0, y_max_m=4.0)


def planner_for(rects: tuple[Rect, ...], bounds: Rect) -> RoutePlanner:
    grid = ClearanceGrid(bounds, 0.05).with_rects(rects)
    return RoutePlanner(Obstacles(rects, bounds), grid, KEEP_M)


def distance_m(rects: tuple[Rect, ...], start: Point, end: Point) -> float:
    """How near the straight move comes to anything, looked at every half millimetre."""
    obstacles = Obstacles(rects, Rect(x_min_m=-9.0, y_min_m=-9.0, x_max_m=30.0, y_max_m=30.0))
    steps = np.linspace(start, end, max(2, math.ceil(math.dist(start, end) / 0.0005)))
    return min(obstacles.clearance_m(x_m, y_m) for x_m, y_m in steps.tolist())


@pytest.mark.parametrize("seed", range(5))
def test_edges_are_those_that_keep_the_distance_all_along(seed: int) -> None:
    rng = np.random.default_rng(seed)
    low = rng.uniform((0.0, 0.0), (5.5, 3.5), (25, 2))
    high = low + rng.uniform(0.01, 0.4, (25, 2))
    rects = tuple(
        Rect(x_min_m=x0, y_min_m=y0, x_max_m=x1, y_max_m=y1)
        for (x0, y0), (x1, y1) in zip(low.tolist(), high.tolist(), strict=True)
    )
    grid = ClearanceGrid(HALL, 0.05).with_rects(rects)
    planner = planner_for(rects, HALL)
    rows, columns = np.nonzero(grid.cells_m >= KEEP_M + SPARE_M)
    graph = planner._graph.tocsr()
    number = {at: node for node, at in enumerate(zip(rows.tolist(), columns.tolist(), strict=True))}
    narrow = 0
    for (row, column), node in number.items():
        if grid.cells_m[row, column] > KEEP_M + 0.02:
            continue
        for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
            other = number.get((row + down, column + right))
            if other is None:
                continue
            ends = [
                (float(grid.x_m[c]), float(grid.y_m[r]))
                for r, c in ((row, column), (row + down, column + right))
            ]
            near_m = distance_m(rects, *ends) - KEEP_M - SPARE_M
            if abs(near_m) > 1e-6:
                assert (graph[node, other] > 0.0) == (near_m > 0.0)
                narrow += near_m < 0.0
    assert narrow > 0


@pytest.mark.parametrize("seed", range(3))
def test_ways_through_homes_touch_nothing(homes: list[Home], seed: int) -> None:
    home = homes[seed]
    rects = home.obstacles()
    planner, obstacles = planner_for(rects, home.bounds), Obstacles(rects, home.bounds)
    grid = ClearanceGrid(home.bounds, 0.05).with_rects(rects)
    rows, columns = np.nonzero(grid.cells_m >= 0.2)
    rng = np.random.default_rng(seed)
    start = home.start.x_m, home.start.y_m
    for at in rng.integers(len(rows), size=15).tolist():
        goal = float(grid.x_m[columns[at]]), float(grid.y_m[rows[at]])
        way = [start, *planner.plan(start, goal)]
        assert way[-1] == goal
        assert all(obstacles.is_line_free(one, other, KEEP_M) for one, other in pairwise(way))
        start = goal


def test_a_closed_door_leaves_no_way() -> None:
    wall = (
        Rect(x_min_m=2.95, y_min_m=0.0, x_max_m=3.05, y_max_m=1.5),
        Rect(x_min_m=2.95, y_min_m=2.4, x_max_m=3.05, y_max_m=4.0),
    )
    door = Rect(x_min_m=2.95, y_min_m=1.5, x_max_m=3.05, y_max_m=2.4)
    assert planner_for(wall, HALL).plan((1.0, 0.5), (5.0, 0.5))[-1] == (5.0, 0.5)
    with pytest.raises(NoWayError, match=r"there is no way from \(1.00, 0.50\) to \(5.00, 0.50\)"):
        planner_for((*wall, door), HALL).plan((1.0, 0.5), (5.0, 0.5))


def test_an_empty_hall_is_crossed_straight() -> None:
    assert planner_for((), HALL).plan((1.0, 1.0), (5.0, 3.0)) == [(5.0, 3.0)]
