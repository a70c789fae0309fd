"""Clearances are exact, however they are looked up."""

import math

import numpy as np
import pytest

from sim_bridge.homes.home import Home
from sim_bridge.homes.obstacles import FAR_M, ClearanceGrid, Obstacles
from sim_bridge.homes.rect import Rect


def exact_m(rects: tuple[Rect, ...], bounds: Rect, x_m: float, y_m: float) -> float:
    """The signed distance, rectangle by rectangle."""
    nearest = min(x_m - bounds.x_min_m, bounds.x_max_m - x_m, y_m - bounds.y_min_m, bounds.y_max_m - y_m)
    for rect in rects:
        beyond_x = max(rect.x_min_m - x_m, x_m - rect.x_max_m)
        beyond_y = max(rect.y_min_m - y_m, y_m - rect.y_max_m)
        outside = math.hypot(max(beyond_x, 0.0), max(beyond_y, 0.0))
        nearest = min(nearest, outside if outside > 0.0 else max(beyond_x, beyond_y))
    return nearest


def random_rects(rng: np.random.Generator, count: int) -> tuple[Rect, ...]:
    low = rng.uniform(-5.0, 4.5, (count, 2))
    high = low + rng.uniform(0.01, 1.5, (count, 2))
    return tuple(
        Rect(x_min_m=x0, y_min_m=y0, x_max_m=x1, y_max_m=y1)
        for (x0, y0), (x1, y1) in zip(low.tolist(), high.tolist(), strict=True)
    )


HALL = Rect(x_min_m=-5.0, y_min_m=-5.0, x_max_m=5.0, y_max_m=5.0)


@pytest.mark.parametrize("count", [0, 1, 3, 20, 80])
def test_a_clearance_is_exact_everywhere(count: int) -> None:
    rng = np.random.default_rng(count)
    for _ in range(5):
        rects = random_rects(rng, count)
        obstacles = Obstacles(rects, HALL)
        # Also on the sides of squares, outside of the bounds, and at one place twice.
        points = np.concatenate([rng.uniform(-6.0, 6.0, (200, 2)), rng.integers(-50, 50, (100, 2)) * 0.1])
        for x_m, y_m in [*points.tolist(), *points[:50].tolist()]:
            assert obstacles.clearance_m(x_m, y_m) == pytest.approx(exact_m(rects, HALL, x_m, y_m), abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_a_grid_of_clearances_holds_the_exact_ones(homes: list[Home], seed: int) -> None:
    home = homes[seed]
    rects = home.obstacles()
    grid = ClearanceGrid(home.bounds, 0.05).with_rects(rects)
    rng = np.random.default_rng(seed)
    for row, column in zip(
        rng.integers(len(grid.y_m), size=300), rng.integers(len(grid.x_m), size=300), strict=True
    ):
        x_m, y_m = float(grid.x_m[column]), float(grid.y_m[row])
        expected_m = min(FAR_M, exact_m(rects, home.bounds, x_m, y_m))
        assert grid.cells_m[row, column] == pytest.approx(expected_m, abs=1e-12)


def test_a_grid_does_not_depend_on_the_order_of_the_rectangles(homes: list[Home]) -> None:
    home = homes[0]
    rects = home.obstacles()
    one = ClearanceGrid(home.bounds, 0.05).with_rects(rects)
    other = ClearanceGrid(home.bounds, 0.05).with_rects(rects[30:]).with_rects(rects[:30][::-1])
    assert np.array_equal(one.cells_m, other.cells_m)


def test_a_robot_beside_one_box() -> None:
    box = Rect(x_min_m=1.0, y_min_m=-1.0, x_max_m=2.0, y_max_m=1.0)
    obstacles = Obstacles([box], HALL)
    assert obstacles.clearance_m(0.0, 0.0) == 1.0
    assert obstacles.clearance_m(1.25, 0.0) == -0.25
    assert obstacles.clearance_m(2.3, 1.4) == pytest.approx(0.5)
    assert obstacles.clearance_m(-4.75, 0.0) == 0.25
    assert obstacles.clearance_m(1e9, 0.0) < 0.0
    assert obstacles.is_line_free((-2.0, 1.2), (4.0, 1.2), 0.19)
    assert not obstacles.is_line_free((-2.0, 1.2), (4.0, 1.2), 0.21)
