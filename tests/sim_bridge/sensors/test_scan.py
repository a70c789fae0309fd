"""The laser sees what the map shows."""

import math
from collections.abc import Callable

import numpy as np

from robustnav_msgs_py.values import Pose2D
from sim_bridge.homes.floor_plan import OCCUPIED, floor_plan
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
