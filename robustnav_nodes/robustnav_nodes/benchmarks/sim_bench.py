"""How fast the simulator is: pictures, steps, homes, memory; on one core."""

import math
import resource
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

import numpy as np

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.benchmarks.one_core import one_core

if TYPE_CHECKING:  # the simulator stands on this package
    from sim_bridge.simulation import Simulation

SIZES = ((320, 240), (640, 480))
POSES = 60
STEPS = 3000
# So many commands are driven meanwhile.
STEPS_PER_GOAL = 250
STAND_CLEARANCE_M = 0.25
BODIES = 150


@dataclass(frozen=True, slots=True, kw_only=True)
class SimFigures:
    """What was measured in hard homes; medians over poses of the first home that has 150 bodies.

    `..._fps`: pictures a second, rendered, with depth, ready to be published; `lockstep_realtime_factor`:
    simulated seconds a second with odometry and scans, without camera; `hard_home_build_s`: a home from its
    seed to its first picture and scan, the slowest of all seeds; `rss_mb`: most memory of this process.
    """

    bodies: int
    rgbd_320x240_fps: float
    rgbd_640x480_fps: float
    depth_320x240_fps: float
    lockstep_realtime_factor: float
    hard_home_build_s: float
    rss_mb: float


def sim_figures(seeds: Sequence[int]) -> SimFigures:
    """Measure in the hard homes of these seeds."""
    from sim_bridge.parameters import SimParameters
    from sim_bridge.simulation import Simulation

    with one_core():
        builds = []
        large: Simulation | None = None
        for seed in [seeds[0], *seeds]:  # the first one compiles
            began = time.perf_counter()
            simulation = Simulation(SimParameters(seed=seed, difficulty="hard"))
            _pictures(simulation, 320, 240, [simulation.home.start])
            simulation.laser_scan()
            builds.append(time.perf_counter() - began)
            if large is None and _bodies(simulation) >= BODIES:
                large = simulation
            else:
                simulation.close()
        if large is None:
            raise BadParameterError(
                f"no hard home of seeds {seeds[0]}..{seeds[-1]} has {BODIES} bodies: ask for more homes"
            )
        poses = _poses(large)
        seconds = {
            (width, height, color): median(_pictures(large, width, height, poses, color=color))
            for width, height in SIZES
            for color in (True, False)
        }
        realtime_factor = _realtime_factor(large)
        bodies = _bodies(large)
        large.close()
    return SimFigures(
        bodies=bodies,
        rgbd_320x240_fps=1.0 / seconds[320, 240, True],
        rgbd_640x480_fps=1.0 / seconds[640, 480, True],
        depth_320x240_fps=1.0 / seconds[320, 240, False],
        lockstep_realtime_factor=realtime_factor,
        hard_home_build_s=max(builds[1:]),
        rss_mb=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    )


def _bodies(simulation: "Simulation") -> int:
    return len(simulation.stage.scenery.items)


def _poses(simulation: "Simulation") -> list[Pose2D]:
    """Random poses on free floor."""
    rng = np.random.default_rng(0)
    grid = simulation.stage.grid
    rows, columns = np.nonzero(grid.cells_m >= STAND_CLEARANCE_M)
    return [
        Pose2D(
            x_m=float(grid.x_m[columns[at]]),
            y_m=float(grid.y_m[rows[at]]),
            yaw_rad=float(rng.uniform(-math.pi, math.pi)),
        )
        for at in rng.integers(len(rows), size=POSES)
    ]


def _pictures(
    simulation: "Simulation", width: int, height: int, poses: Sequence[Pose2D], *, color: bool = True
) -> list[float]:
    """Seconds for a picture from each pose."""
    from sim_bridge.sensors.camera import Camera, camera_model

    model = camera_model(width, height, simulation.parameters.camera_view_rad)
    camera = Camera(simulation.stage.scenery, model, simulation.mount, simulation.parameters.camera_range_m)
    return [_timed(lambda pose=pose: camera.take(pose, 0, color=color)) for pose in poses]  # type: ignore[misc]


def _realtime_factor(simulation: "Simulation") -> float:
    """Simulated seconds a second while the robot drives from goal to goal, hears nothing and sees nothing."""
    goals = _poses(simulation)
    began = time.perf_counter()
    for step in range(STEPS):
        if step % STEPS_PER_GOAL == 0:
            simulation.go_to(goals[step // STEPS_PER_GOAL])
        due = simulation.step()
        if due.odom:
            simulation.odometry()
        if due.scan:
            simulation.laser_scan()
    return STEPS * simulation.period_s / (time.perf_counter() - began)


def _timed(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began
