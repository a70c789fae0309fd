"""Where rays meet boxes, cylinders and balls; PyBullet agrees."""

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadSceneError
from sim_bridge.homes.home import Home
from sim_bridge.homes.materials import material
from sim_bridge.homes.shapes import Part, Shape, ball, box, cylinder, extent, first_hit_m
from sim_bridge.sensors.world import World

RED = material("red paint")
ALONG_X = np.array([[1.0, 0.0, 0.0]])
DOWN = np.array([[0.0, 0.0, -1.0]])


def test_hits_worked_by_hand() -> None:
    cases = [
        (box((0.0, 0.0, 0.5), (0.4, 0.6, 1.0), RED), (-2.0, 0.2, 0.3), ALONG_X, 1.8),
        (box((0.0, 0.0, 0.5), (0.4, 0.6, 1.0), RED), (-2.0, 0.4, 0.3), ALONG_X, np.inf),
        (box((0.0, 0.0, 0.5), (0.4, 0.6, 1.0), RED), (2.0, 0.0, 0.3), ALONG_X, np.inf),
        (cylinder((0.0, 0.0, 0.5), 0.4, 1.0, RED), (-2.0, 0.0, 0.3), ALONG_X, 1.8),
        (cylinder((0.0, 0.0, 0.5), 0.4, 1.0, RED), (0.1, 0.1, 3.0), DOWN, 2.0),
        (cylinder((0.0, 0.0, 0.5), 0.4, 1.0, RED), (0.3, 0.1, 3.0), DOWN, np.inf),
        (cylinder((0.0, 0.0, 0.5), 0.4, 1.0, RED), (-2.0, 0.0, 1.1), ALONG_X, np.inf),
        (ball((0.0, 0.0, 0.2), 0.4, RED), (-2.0, 0.0, 0.2), ALONG_X, 1.8),
        (ball((0.0, 0.0, 0.2), 0.4, RED), (-2.0, 0.0, 0.5), ALONG_X, np.inf),
    ]
    for part, origin, direction, distance in cases:
        assert first_hit_m((part,), np.array(origin), direction)[0] == pytest.approx(distance)


def test_the_nearest_part_counts() -> None:
    parts = (ball((1.0, 0.0, 0.0), 0.2, RED), ball((0.0, 0.0, 0.0), 0.2, RED))
    assert first_hit_m(parts, np.array((-1.0, 0.0, 0.0)), ALONG_X)[0] == pytest.approx(0.9)
    assert extent(parts) == ((-0.1, -0.1, -0.1), (1.1, 0.1, 0.1))


def test_pybullet_meets_objects_where_the_primitives_say(homes: list[Home]) -> None:
    home = homes[0]
    rng = np.random.default_rng(0)
    errors_m: list[float] = []
    with World(home) as world:
        for thing in home.objects:
            centre = np.array(thing.centre_m)
            targets = centre + rng.uniform(-0.5, 0.5, (50, 3)) * max(thing.size_m)
            starts = centre + np.array([0.0, 0.0, 1.0]) + rng.uniform(-0.3, 0.3, (50, 3))
            reach = np.linalg.norm(targets - starts, axis=1)
            directions = (targets - starts) / reach[:, None]
            cos, sin = np.cos(thing.yaw_rad), np.sin(thing.yaw_rad)
            turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
            foot = np.array((thing.x_m, thing.y_m, thing.z_m))
            shares, bodies = world.cast(starts, targets)
            met = np.array([world.instance_of.get(int(body)) == thing.instance for body in bodies])
            for at in np.nonzero(met)[0]:
                own = first_hit_m(thing.parts, turn @ (starts[at] - foot), (directions[at] @ turn.T)[None])[0]
                errors_m.append(abs(own - shares[at] * reach[at]))
    # PyBullet rounds edges by some millimetres, so that a ray that grazes one may meet another part.
    assert len(errors_m) > 100
    assert np.percentile(errors_m, 90) < 0.002
    assert np.percentile(errors_m, 98) < 0.01


def test_impossible_parts_are_refused() -> None:
    for size in ((0.0, 1.0, 1.0), (1.0, -1.0, 1.0), (float("nan"), 1.0, 1.0)):
        with pytest.raises(BadSceneError, match="sizes must be positive"):
            box((0.0, 0.0, 0.0), size, RED)
    with pytest.raises(BadSceneError, match="equal extents"):
        Part(shape=Shape.BALL, centre_m=(0.0, 0.0, 0.0), size_m=(1.0, 1.0, 2.0), material=RED)
