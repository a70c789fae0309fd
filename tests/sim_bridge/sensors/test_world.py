"""Rays meet what the home is made of, also after things have moved."""

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import Home
from sim_bridge.sensors.world import NOTHING, World


def down_onto(world: World, x_m: float, y_m: float, from_m: float = 2.0) -> tuple[float, int]:
    """The height of what is met on the way down, and its body."""
    top = np.array([[x_m, y_m, from_m]])
    shares, bodies = world.cast(top, top - (0.0, 0.0, from_m + 1.0))
    return from_m - float(shares[0]) * (from_m + 1.0), int(bodies[0])


def test_rays_meet_objects_furniture_and_floor(small_home: Home) -> None:
    with World(small_home) as world:
        ball_top_m, body = down_onto(world, 6.1, 0.3)
        assert ball_top_m == pytest.approx(0.98, abs=1e-3)
        assert world.instance_of[body] == 2
        table_top_m, body = down_onto(world, 2.1, 1.9)
        assert table_top_m == pytest.approx(0.76, abs=1e-3)
        assert body not in world.instance_of
        assert down_onto(world, 1.0, 1.0)[0] == pytest.approx(0.0, abs=1e-3)
        assert down_onto(world, -3.0, 1.0)[1] == NOTHING


def test_cylinders_lie_along_their_axes(small_home: Home) -> None:
    """The roll lies along x of an object turned by 0.7 rad: 0.25 m long, 0.12 m thick."""
    with World(small_home) as world:
        along, across = np.array((np.cos(0.7), np.sin(0.7))), np.array((-np.sin(0.7), np.cos(0.7)))
        for way, reach_m in ((along, 0.125), (across, 0.06)):
            for sign in (-1.0, 1.0):
                inside = np.array((2.3, 2.2)) + sign * way * (reach_m - 0.01)
                outside = np.array((2.3, 2.2)) + sign * way * (reach_m + 0.01)
                assert world.instance_of.get(down_onto(world, *inside.tolist())[1]) == 0
                assert world.instance_of.get(down_onto(world, *outside.tolist())[1]) is None
        # The chest's knob along its x, which looks north, and its bar along its y.
        north = np.array([[5.7, 2.0, 0.3], [6.0, 2.0, 0.6]])
        shares, _ = world.cast(north, north - (0.0, 2.0, 0.0))
        assert 2.0 - 2.0 * shares == pytest.approx([0.35 + 0.30, 0.35 + 0.235], abs=2e-3)


def test_doorways_have_a_floor(small_home: Home) -> None:
    with World(small_home) as world:
        for x_m in (3.96, 3.99, 4.01, 4.04):
            assert down_onto(world, x_m, 1.7)[0] == pytest.approx(0.0, abs=1e-3)


def test_a_moved_object_is_met_where_it_is_now(small_home: Home) -> None:
    with World(small_home) as world:
        world.move(2, 1.0, 1.0, 0.2, 0.5)
        height_m, body = down_onto(world, 1.0, 1.0)
        assert height_m == pytest.approx(0.38, abs=1e-3)
        assert world.instance_of[body] == 2
        assert down_onto(world, 6.1, 0.3)[0] == pytest.approx(0.8, abs=1e-3)
        with pytest.raises(BadSceneError, match="no object 99"):
            world.move(99, 0.0, 0.0, 0.0, 0.0)


def test_boxes_come_and_go(small_home: Home) -> None:
    with World(small_home) as world:
        body = world.add_box((1.0, 1.0, 0.25), (0.2, 0.2, 0.5))
        assert down_onto(world, 1.0, 1.0) == (pytest.approx(0.5, abs=1e-3), body)
        world.remove(body)
        assert down_onto(world, 1.0, 1.0)[0] == pytest.approx(0.0, abs=1e-3)


def test_closing_twice_does_nothing(small_home: Home) -> None:
    world = World(small_home)
    world.close()
    world.close()
