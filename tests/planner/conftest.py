"""Small homes, drawn as text, and the search spaces on them."""

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
import pytest

from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.planner.parameters import PlannerParameters
from robustnav_nodes.planner.policy import Sight, Situation
from robustnav_nodes.search_space.candidates import Candidates
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE, PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

CELL_M = 0.3


def draw(*rows: str, resolution_m: float = 0.05) -> tuple[OccupancyMap, OccupancyMap]:
    """Map and candidate mask from text: `#` wall, `o` low furniture, else free; top row is +y."""
    art = np.array([list(row) for row in reversed(rows)])
    occupied = np.where((art == "#") | (art == "o"), 100, 0).astype(np.int8)
    masked = np.where(art == "o", 100, 0).astype(np.int8)
    scale = np.ones((round(CELL_M / resolution_m),) * 2, dtype=np.int8)
    origin = Pose2D(x_m=0.0, y_m=0.0)
    floor_map = OccupancyMap(cells=np.kron(occupied, scale), resolution_m=resolution_m, origin=origin)
    return floor_map, OccupancyMap(cells=np.kron(masked, scale), resolution_m=resolution_m, origin=origin)


@pytest.fixture(scope="session")
def space_of() -> Callable[..., SearchSpace]:
    """space_of(*rows, **parameters): the search space of a drawn home."""

    def build(*rows: str, **changes: float) -> SearchSpace:
        return SearchSpace.build(*draw(*rows), planner_parameters(**changes))

    return build


def planner_parameters(**changes: object) -> PlannerParameters:
    by_hand = {
        "camera_forward_m": 0.0,
        "robot_radius_m": 0.1,
        "candidate_size_m": 0.3,
        "range_min_m": 0.5,
        "range_max_m": 4.0,
        "docking_distance_m": 0.8,
    }
    return PlannerParameters(**(by_hand | changes))  # type: ignore[arg-type]


@pytest.fixture(scope="session")
def parameters_with() -> Callable[..., PlannerParameters]:
    """parameters_with(**changes): the camera at the robot's centre, a small robot, one candidate a cell."""
    return planner_parameters


@pytest.fixture(scope="session")
def home() -> SearchSpace:
    """Three rooms with a door between each two, low furniture, and one tall thing."""
    art = (
        "############################",
        "#.......#.......ooo#.......#",
        "#oo.....#..........#......o#",
        "#oo.....#..........#......o#",
        "#oo.....................oo.#",
        "#..................#....oo.#",
        "#.......#..oo......#.......#",
        "#.......#..oo......#.......#",
        "#..oo...#..oo......#.......#",
        "#..oo............#.#oo.....#",
        "#................#.#oo.....#",
        "#.......#ooo.......#oo.....#",
        "############################",
    )
    return SearchSpace.build(*draw(*art), planner_parameters())


def table(
    successors: Sequence[Sequence[int]], sees: Sequence[Sequence[int]], candidates: int | None = None
) -> SearchSpace:
    """A search space without a map: the pose that each of four actions leads to, and what each pose sees.

    The poses stand in a row, 1 m apart, as the candidates do, 1 m to the north; each looks that way.
    """
    poses = len(successors)
    last = max((max(row, default=-1) for row in sees), default=-1)
    count = last + 1 if candidates is None else candidates
    starts = np.concatenate([[0], np.cumsum([len(row) for row in sees])])
    seen = np.array([candidate for row in sees for candidate in sorted(row)], dtype=np.int32)
    return SearchSpace(
        graph=PoseGraph(
            x_m=np.arange(poses, dtype=np.float64),
            y_m=np.zeros(poses),
            yaw_rad=np.full(poses, 0.5 * np.pi),
            successors=np.array(successors, dtype=np.int32).reshape(poses, 4),
            headings=4,
        ),
        candidates=Candidates(x_m=np.arange(count, dtype=np.float64), y_m=np.ones(count), size_m=0.2),
        observability=Observability.of_rows(starts, seen, count),
    )


def corridor(*sees: Sequence[int], candidates: int | None = None) -> SearchSpace:
    """Poses in a row, forward to the next and backward to the one before; `sees`: candidates of each."""
    last = len(sees) - 1
    steps = [[pose + 1 if pose < last else NOWHERE, pose - 1, NOWHERE, NOWHERE] for pose in range(last + 1)]
    return table(steps, sees, candidates)


def maze(seed: int, poses: int = 10, candidates: int = 8) -> SearchSpace:
    """Anything at all: ways, also one-way ones, and sights by chance; every pose has a way out."""
    rng = np.random.default_rng(seed)
    count, k = int(rng.integers(2, poses + 1)), int(rng.integers(1, candidates + 1))
    ways = np.where(rng.random((count, 4)) < 0.5, rng.integers(0, count, (count, 4)), NOWHERE)
    ways[:, 0] = (np.arange(count) + 1) % count
    sees = [np.nonzero(rng.random(k) < 0.3)[0].tolist() for _ in range(count)]
    return table(ways.tolist(), sees, k)


class Spaces(NamedTuple):
    """Makers of search spaces by hand: see `table`, `corridor` and `maze`."""

    table: Callable[..., SearchSpace]
    corridor: Callable[..., SearchSpace]
    maze: Callable[..., SearchSpace]


@pytest.fixture(scope="session")
def by_hand() -> Spaces:
    return Spaces(table, corridor, maze)


def _walk_in_order(space: SearchSpace, start: int) -> dict[int, int]:
    """The pose before each that `start` reaches, nearest first, by the order of actions among equals."""
    before, queue = {start: NOWHERE}, [start]
    for pose in queue:
        for after in space.graph.successors[pose].tolist():
            if after != NOWHERE and after not in before:
                before[after] = pose
                queue.append(after)
    return before


def worth_in_plain_words(
    space: SearchSpace,
    mass: Sequence[float],
    looked: Iterable[int],
    start: int,
    way: Iterable[int],
    recall: float,
    worth: Sequence[float],
) -> float:
    """`worth_of_way` in words: take the way, then go on and on to the pose with the most gain per step."""
    mass, looked, total, step, pose, way = list(mass), set(looked), 0.0, 0, start, list(way)
    while step < len(worth) - 1:
        if not way:
            before, best = _walk_in_order(space, pose), (1e-9, NOWHERE)
            for goal in before:
                steps, at = 0, goal
                while before[at] != NOWHERE:
                    steps, at = steps + 1, before[at]
                seen = space.observability.seen_by(goal)
                if goal not in looked and steps > 0 and sum(mass[j] for j in seen) / steps > best[0] + 1e-12:
                    best = sum(mass[j] for j in seen) / steps, goal
            if best[1] == NOWHERE:
                break
            at = best[1]
            while at != pose:
                way.insert(0, at)
                at = before[at]
        pose, step = way.pop(0), step + 1
        if pose not in looked:
            looked.add(pose)
            for j in space.observability.seen_by(pose):
                total += worth[step] * recall * mass[j]
                mass[j] *= 1.0 - recall
    return total


@pytest.fixture(scope="session")
def plain_worth() -> Callable[..., float]:
    """plain_worth(space, mass, looked, start, way, recall, worth): a slow `worth_of_way` to compare with."""
    return worth_in_plain_words


def situation_at(
    space: SearchSpace,
    pose: int,
    probability: Sequence[float],
    *,
    looked: Iterable[int] = (),
    step: int = 0,
    start: int | None = None,
    graph: PoseGraph | None = None,
) -> Situation:
    """Where a decision is made: at `pose`, after looks from there and from `looked`, none of them a find.

    start: where the search began; None: at `pose`.
    """
    return Situation(
        graph=space.graph if graph is None else graph,
        sight=Sight(
            pose=pose,
            probability=np.array(probability),
            in_view=space.observability.row(pose),
            rose=np.zeros(len(space.candidates), dtype=np.bool_),
            is_new=True,
        ),
        visited=np.isin(np.arange(len(space.graph)), [pose, *looked]),
        step=step,
        start=pose if start is None else start,
    )


@pytest.fixture(scope="session")
def situation() -> Callable[..., Situation]:
    return situation_at
