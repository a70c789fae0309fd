"""The laser sees what the map shows."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.floor_plan import OCCUPIED, floor_plan
from sim_bridge.homes.materials import material
from sim_bridge.homes.shapes import Axis, Part, ball, box, cylinder
from sim_bridge.sensors.scan import LASER_HEIGHT_M, Laser
from sim_bridge.sensors.scenery import Item, Scenery
from sim_bridge.simulation import Simulation

FreePoses = Callable[..., list[Pose2D]]


def test_every_return_lies_on_an_occupied_cell(simulation: Simulation, free_poses: FreePoses) -> None:
    plan = floor_plan(simulation.home)
    for pose in free_poses(simulation.home, 30, seed=1):
        scan = simulation._laser.take(pose, 5)
        assert scan.stamp_ns == 5
        assert scan.ranges_m.shape == (360,)
        hit = np.isfinite(scan.ranges_m)
        assert hit.mean() > 0.9
        angles = pose.yaw_rad + scan.angle_min_rad + scan.angle_step_rad * np.arange(360)
        # A little beyond the surface lies the cell that holds it.
        reach = scan.ranges_m[hit] + 0.01
        rows = ((pose.y_m + reach * np.sin(angles[hit]) - plan.origin.y_m) / plan.resolution_m).astype(int)
        columns = ((pose.x_m + reach * np.cos(angles[hit]) - plan.origin.x_m) / plan.resolution_m).astype(int)
        # A ray that grazes a corner may leave the cell again within that centimetre.
        assert (plan.cells[rows, columns] == OCCUPIED).mean() > 0.98


RED = material("red paint")
LEVEL_M = LASER_HEIGHT_M


@pytest.mark.parametrize(
    ("part", "ahead_m", "left_m"),
    [
        (box((0.0, 0.0, LEVEL_M), (0.4, 0.6, 0.2), RED), 0.2, 0.3),
        (box((0.0, 0.0, LEVEL_M + 0.15), (0.4, 0.6, 0.2), RED), math.inf, math.inf),
        (cylinder((0.0, 0.0, LEVEL_M), 0.4, 0.3, RED), 0.2, 0.2),
        (cylinder((0.0, 0.0, LEVEL_M), 0.4, 0.6, RED, Axis.X), 0.3, 0.2),
        (cylinder((0.0, 0.0, LEVEL_M + 0.16), 0.4, 0.6, RED, Axis.X), 0.3, 0.12),
        (cylinder((0.0, 0.0, LEVEL_M + 0.16), 0.4, 0.6, RED, Axis.Y), 0.12, 0.3),
        (ball((0.0, 0.0, LEVEL_M), 0.4, RED), 0.2, 0.2),
        (ball((0.0, 0.0, LEVEL_M - 0.16), 0.4, RED), 0.12, 0.12),
    ],
)
def test_cuts_worked_by_hand(part: Part, ahead_m: float, left_m: float) -> None:
    """A thing turned by 0.7 rad, from 2 m before its front and its left side; then lifted, and taken away."""
    scenery = Scenery([Item(number=1, name="one", parts=(part,), light_m=(0, 0, 2), x_m=1.0, yaw_rad=0.7)])
    laser = Laser(scenery, 360, 8.0)
    for turn_rad, half_m in ((0.7, ahead_m), (0.7 + math.pi / 2.0, left_m)):
        x_m, y_m = 1.0 + 2.0 * math.cos(turn_rad), 2.0 * math.sin(turn_rad)
        facing = Pose2D(x_m=x_m, y_m=y_m, yaw_rad=turn_rad + math.pi)
        for place, met_m in (((1.0, 0.0, 0.0), 2.0 - half_m), ((1.0, 0.0, 1.0), math.inf)):
            scenery.move(1, *place, 0.7)
            assert laser.take(facing, 0).ranges_m[180] == pytest.approx(abs(met_m), abs=1e-6)
        scenery.move(1, 20.0, 0.0, 0.0, 0.7)
        assert np.isinf(laser.take(facing, 0).ranges_m).all()


def test_the_ray_ahead_measures_the_wall(simulation: Simulation, free_poses: FreePoses) -> None:
    checked = 0
    for pose in free_poses(simulation.home, 200, seed=2):
        room = simulation.home.room_at(pose.x_m, pose.y_m)
        if room is None:
            continue
        for yaw_rad, wall_m in (
            (0.0, room.inside.x_max_m - pose.x_m),
            (math.pi / 2, room.inside.y_max_m - pose.y_m),
        ):
            scan = simulation._laser.take(Pose2D(x_m=pose.x_m, y_m=pose.y_m, yaw_rad=yaw_rad), 0)
            ahead = float(scan.ranges_m[180])
            free = simulation.drive.obstacles.is_line_free(
                (pose.x_m, pose.y_m),
                (
                    pose.x_m + (wall_m - 0.01) * math.cos(yaw_rad),
                    pose.y_m + (wall_m - 0.01) * math.sin(yaw_rad),
                ),
                0.001,
            )
            door = any(
                door.opening.grown(0.02).holds(
                    pose.x_m + wall_m * math.cos(yaw_rad), pose.y_m + wall_m * math.sin(yaw_rad)
                )
                for door in simulation.home.doors
            )
            if free and not door:
                assert abs(ahead - wall_m) < 0.005
                checked += 1
    assert checked > 30
