"""How the planner's cost grows with the search space: decisions, belief updates, building it, memory."""

import json
import math
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.belief.tracker import BeliefTracker
from robustnav_nodes.belief.view_gate import Verdict
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.pomcp import plan
from robustnav_nodes.planner.search import Search
from robustnav_nodes.planner.search_problem import SEARCH, search_model
from robustnav_nodes.search_space.space import SearchSpace

SIZES = (100, 316, 1_000, 3_162, 10_000, 31_623, 100_000)
DECISIONS = 60
LOOKAHEADS = 20
VIEWS = 60
NO_TIME_LIMIT_S = 60.0

_CELL_M = 0.05
_WALL = 2  # cells
_DOOR_M = 0.9
_ROOM_M = (2.0, 4.0)  # side of a room: small where one room is more than enough, and otherwise
_POSES_PER_ROOM = 800  # of the large ones
_BLOCK = (0.30, 0.38)  # sides of furniture over the room's
_AISLE_M = 0.8  # at least, between furniture

# What this makes large must be allowed to be large; the rest is as on the robot.
_SPACE: dict[str, Any] = {
    "candidate_size_m": 0.1,
    "camera_forward_m": 0.0,
    "max_poses": 1_000_000,
    "max_candidates": 1_000_000,
    "max_observability_mb": 16_384,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannerRow:
    """One size of the search space, measured in a process of its own on one core.

    simulations_per_s, simulated_steps_per_s: of all decisions together, the model's making included;
    decision_ms_p50, decision_ms_p95: one decision of POMCP, of 1024 simulations; lookahead_ms_p50: one of the
    default planner; belief_update_ms: median over views
    that count and show no detection; search_space_s: building it, compilation not included; rss_mb: most
    memory that the process ever held, Python and its libraries included.
    """

    poses: int
    candidates: int
    simulations_per_s: float
    simulated_steps_per_s: float
    decision_ms_p50: float
    decision_ms_p95: float
    lookahead_ms_p50: float
    belief_update_ms: float
    search_space_s: float
    rss_mb: float


def planner_rows(
    sizes: Sequence[int] = SIZES, seed: int = 1, progress: Callable[[PlannerRow], None] = lambda row: None
) -> list[PlannerRow]:
    """A row for each size, of about as many poses and about as many candidates; `progress` gets each."""
    rows = []
    for size in sizes:
        # Not multiprocessing: it leaves a process of its own behind that outlives the measurement.
        command = [sys.executable, "-m", __name__, str(size), str(seed)]
        measured = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
        rows.append(PlannerRow(**json.loads(measured.stdout)))
        progress(rows[-1])
    return rows


def planner_row(size: int, seed: int) -> PlannerRow:
    """Measure one size here; `rss_mb` is that of this process, whatever it did before."""
    rng = np.random.default_rng([seed, size])
    parameters = PlannerParameters(time_budget_s=NO_TIME_LIMIT_S, **_SPACE)
    SearchSpace.build(*synthetic_floor(SIZES[0], np.random.default_rng(0)), parameters)  # compiles
    floor_map, mask = synthetic_floor(size, rng)
    began = time.perf_counter()
    space = SearchSpace.build(floor_map, mask, parameters)
    search_space_s = time.perf_counter() - began
    decision_s, simulations, steps = _decisions(space, parameters, rng)
    belief_update_ms = 1000.0 * float(np.median(_belief_updates_s(space, rng)))
    return PlannerRow(
        poses=len(space.graph),
        candidates=len(space.candidates),
        simulations_per_s=simulations / float(decision_s.sum()),
        simulated_steps_per_s=steps / float(decision_s.sum()),
        decision_ms_p50=1000.0 * float(np.percentile(decision_s, 50)),
        decision_ms_p95=1000.0 * float(np.percentile(decision_s, 95)),
        lookahead_ms_p50=float(np.median(_lookahead_ms(space, parameters, rng))),
        belief_update_ms=belief_update_ms,
        search_space_s=search_space_s,
        rss_mb=_peak_rss_mb(),
    )


def synthetic_floor(size: int, rng: np.random.Generator) -> tuple[OccupancyMap, OccupancyMap]:
    """Map and candidate mask of a floor with about `size` poses and about as many candidates of 0.1 m.

    Square rooms in a square, a door between each two neighbours, and low furniture in every corner, so that
    all free floor is connected.
    """
    rooms = max(1, round(size / _POSES_PER_ROOM))
    columns = math.isqrt(rooms - 1) + 1
    rows = -(-rooms // columns)
    side_m = max(_ROOM_M[0], _ROOM_M[1] * math.sqrt(min(1.0, size / _POSES_PER_ROOM)))
    side, door, aisle = (round(length / _CELL_M) for length in (side_m, _DOOR_M, _AISLE_M))
    pitch = side + _WALL
    occupied = np.ones((rows * pitch + _WALL, columns * pitch + _WALL), dtype=np.bool_)
    masked = np.zeros_like(occupied)
    middle = slice((side - door) // 2, (side + door) // 2)
    for room in range(rooms):
        top, left = _WALL + room // columns * pitch, _WALL + room % columns * pitch
        inside = (slice(top, top + side), slice(left, left + side))
        occupied[inside] = False
        for corner in range(4):
            height, width = (
                min(round(side * part), (side - aisle) // 2) for part in rng.uniform(*_BLOCK, size=2)
            )
            down = slice(0, height) if corner < 2 else slice(side - height, side)
            along = slice(0, width) if corner % 2 == 0 else slice(side - width, side)
            masked[inside][down, along] = True
        if room % columns > 0:
            occupied[top : top + side, left - _WALL : left][middle] = False
        if room >= columns:
            occupied[top - _WALL : top, left : left + side][:, middle] = False
    return _grid(occupied | masked), _grid(masked)


def draw_planner_rows(rows: Sequence[PlannerRow], png: Path) -> None:
    """Draw how time and memory grow over the number of poses, on logarithmic axes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # no screen
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 4.5), layout="constrained")
    FigureCanvasAgg(figure)
    times, memory = figure.subplots(1, 2, width_ratios=(2, 1))
    poses = [row.poses for row in rows]
    times.loglog(poses, [row.decision_ms_p50 for row in rows], "o-", label="POMCP, median")
    times.loglog(poses, [row.decision_ms_p95 for row in rows], "^--", label="POMCP, 95 %")
    times.loglog(poses, [row.lookahead_ms_p50 for row in rows], "x-", label="lookahead")
    times.loglog(poses, [row.belief_update_ms for row in rows], "s-", label="belief update")
    times.loglog(poses, [1000.0 * row.search_space_s for row in rows], "d-", label="search space")
    times.set(xlabel="poses (about as many candidates)", ylabel="time, ms")
    times.legend()
    memory.loglog(poses, [row.rss_mb for row in rows], "o-")
    memory.set(xlabel="poses", ylabel="most memory, MB")
    memory.yaxis.set_minor_formatter("{x:.0f}")
    for axes in (times, memory):
        axes.grid(visible=True, which="major", alpha=0.4)
    figure.savefig(png, dpi=150)


def _grid(cells: NDArray[np.bool_]) -> OccupancyMap:
    return OccupancyMap(
        cells=cells.astype(np.int8) * np.int8(100), resolution_m=_CELL_M, origin=Pose2D(x_m=0.0, y_m=0.0)
    )


def _decisions(
    space: SearchSpace, parameters: PlannerParameters, rng: np.random.Generator
) -> tuple[NDArray[np.float64], int, int]:
    """Seconds of each decision, and the simulations and steps of all: anywhere, nothing known yet."""
    visited = np.zeros(len(space.graph), dtype=np.bool_)
    can_be_seen = np.nonzero(space.observability.seen_from_somewhere())[0]
    seconds, simulations, steps = np.zeros(DECISIONS), 0, 0
    for decision in range(-1, DECISIONS):  # the first one compiles and does not count
        start = int(rng.integers(len(space.graph)))
        particles = can_be_seen[rng.integers(len(can_be_seen), size=parameters.simulations)]
        began = time.perf_counter()
        model = search_model(space.graph, space.observability, start, visited, parameters)
        chosen = plan(SEARCH, model, particles, parameters, rng)
        if decision >= 0:
            seconds[decision] = time.perf_counter() - began
            simulations += chosen.simulations
            steps += chosen.steps
    return seconds, simulations, steps


def _lookahead_ms(space: SearchSpace, parameters: PlannerParameters, rng: np.random.Generator) -> list[float]:
    """Milliseconds of each decision of a search that finds nothing."""
    search = Search(space=space, parameters=replace(parameters, variant="lookahead"), rng=rng)
    probability = np.full(len(space.candidates), 1.0 / len(space.candidates))
    pose, elapsed_ms = int(rng.integers(len(space.graph))), []
    for _ in range(LOOKAHEADS):
        step = search.look(pose, space.observability.row(pose), probability)
        if not step.path:
            break
        pose = step.path[1]
        elapsed_ms.append(step.elapsed_ms)
    return elapsed_ms


def _belief_updates_s(space: SearchSpace, rng: np.random.Generator) -> list[float]:
    """Seconds of each view that counted, from poses at random, where the detector was silent."""
    if space.view is None:
        raise ValueError("a search space that was built from a map has a view")
    tracker = BeliefTracker(
        view=space.view, statistics=ClassStatistics(), parameters=BeliefParameters(**_SPACE)
    )
    nothing = np.zeros((0, 2))
    seconds = []
    for pose in rng.integers(len(space.graph), size=VIEWS):
        began = time.perf_counter()
        verdict = tracker.observe(space.graph.pose(int(pose)), nothing)
        if verdict is Verdict.COUNTED:
            seconds.append(time.perf_counter() - began)
    return seconds[1:]  # the first one may compile


def _peak_rss_mb() -> float:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # kB; bytes on macOS
    return peak / (1e6 if sys.platform == "darwin" else 1e3)


if __name__ == "__main__":
    print(json.dumps(asdict(planner_row(size=int(sys.argv[1]), seed=int(sys.argv[2])))))
