"""Scenes to search in, made by seed in the manner of the Active Vision Dataset's benchmark (AVDB)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Bool
from robustnav_nodes.benchmarks.furnished_floor import FloorStyle, draw_floor
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene, SearchTarget, Sighting
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import NOWHERE
from robustnav_nodes.search_space.space import SearchSpace

PERFECT, NOISY = "perfect", "noisy"
DETECTORS = (PERFECT, NOISY)
CLASSES = 33
PLACE_SIGMA_M = 0.5  # of a detected place, noisy detector
PERFECT_SIGMA_M = 0.1
_NEGLIGIBLE = 1e-6  # densities below this are not kept
_MIN_FIRST_VIEW = 3  # actions between a start and the nearest view of the target
DESTINATION_M = 0.5  # poses within this of the nearest that sees the target are as good to stop at


@dataclass(frozen=True, slots=True, kw_only=True)
class Difficulty:
    """A kind of scene: how its floor is drawn, and how large its search space may be (inclusive bounds)."""

    style: FloorStyle
    poses: tuple[int, int]
    candidates: tuple[int, int]


DIFFICULTIES = {
    "easy": Difficulty(
        style=FloorStyle(rooms=(1, 1), area_m2=(9.0, 13.0), filled=0.40, tall=0.14),
        poses=(96, 168),
        candidates=(130, 210),
    ),
    "medium": Difficulty(
        style=FloorStyle(rooms=(3, 4), area_m2=(40.0, 50.0), filled=0.44, tall=0.14),
        poses=(500, 700),
        candidates=(500, 700),
    ),
    "hard": Difficulty(
        style=FloorStyle(rooms=(5, 7), area_m2=(102.0, 116.0), filled=0.58, tall=0.10),
        poses=(1500, 2000),
        candidates=(1150, 1600),
    ),
}
SPACE = SearchSpaceParameters(camera_forward_m=0.0, range_min_m=0.0, candidate_size_m=0.2)


def make_scene(difficulty: str, seed: int) -> SearchScene:
    """The scene number `seed` of "easy", "medium" or "hard", always the same."""
    kind = DIFFICULTIES[difficulty]
    rng = np.random.default_rng([seed, list(DIFFICULTIES).index(difficulty)])
    return hide_targets(_space_of(kind, rng), f"{difficulty}-{seed}", difficulty, rng)


def hide_targets(space: SearchSpace, name: str, difficulty: str, rng: np.random.Generator) -> SearchScene:
    """A scene on `space`: each of 33 classes hidden somewhere, and two detectors that look for them."""
    seen = np.nonzero(space.observability.seen_from_somewhere())[0]
    places = rng.choice(seen, size=CLASSES)
    targets = tuple(_target(space, int(place), number, rng) for number, place in enumerate(places))
    return SearchScene(
        name=name,
        difficulty=difficulty,
        space=space,
        targets=targets,
        starts=np.arange(len(space.graph), dtype=np.int32),
    )


def starts_of(scene: SearchScene, target: SearchTarget) -> NDArray[np.int32]:
    """The starts from which no view of the target is nearer than three actions; all, where there are none.

    Of a scene without starts, any pose is one.
    """
    starts = scene.starts if len(scene.starts) else np.arange(len(scene.space.graph), dtype=np.int32)
    near = target.in_view.copy()
    for _ in range(_MIN_FIRST_VIEW - 1):
        next_to = scene.space.graph.successors
        near |= np.any((next_to != NOWHERE) & near[next_to], axis=1)
    far = starts[~near[starts]]
    return far if len(far) else starts


def _space_of(kind: Difficulty, rng: np.random.Generator) -> SearchSpace:
    """Draw floors until one has a search space of the wanted size."""
    while True:
        floor_map, mask = draw_floor(kind.style, rng)
        try:
            everywhere = SearchSpace.build(floor_map, mask, SPACE)
        except BadMapError:  # a floor without room for anything
            continue
        if len(everywhere.graph) < kind.poses[0]:
            continue
        inside = everywhere.graph.pose(everywhere.graph.largest_part())
        space = SearchSpace.build(floor_map, mask, SPACE, inside)
        if _within(len(space.graph), kind.poses) and _within(len(space.candidates), kind.candidates):
            return space


def _within(count: int, bounds: tuple[int, int]) -> bool:
    return bounds[0] <= count <= bounds[1]


def _target(space: SearchSpace, place: int, number: int, rng: np.random.Generator) -> SearchTarget:
    statistics = ClassStatistics(precision=rng.uniform(0.7, 0.9), recall=rng.uniform(0.5, 0.7))
    in_view = space.observability.column(place)
    return SearchTarget(
        label=f"object {number}",
        in_view=in_view,
        destination=_destinations(space, place, in_view),
        detections={
            PERFECT: _perfect(space, place, in_view),
            NOISY: _noisy(space, place, in_view, statistics, rng),
        },
    )


def _destinations(space: SearchSpace, place: int, in_view: Bool) -> Bool:
    x_m, y_m = space.candidates.x_m[place], space.candidates.y_m[place]
    distance_m = np.hypot(space.graph.x_m - x_m, space.graph.y_m - y_m)
    near = distance_m <= distance_m[in_view].min() + DESTINATION_M
    return np.asarray(in_view & near, dtype=np.bool_)


def _perfect(space: SearchSpace, place: int, in_view: Bool) -> DetectionRecord:
    """Fires wherever the target is in view, and nowhere else."""
    x_m, y_m = space.candidates.x_m[place], space.candidates.y_m[place]
    sightings = [(int(pose), x_m, y_m) for pose in np.nonzero(in_view)[0]]
    return _record(space, sightings, PERFECT_SIGMA_M, ClassStatistics(precision=1.0, recall=1.0))


def _noisy(
    space: SearchSpace, place: int, in_view: Bool, statistics: ClassStatistics, rng: np.random.Generator
) -> DetectionRecord:
    """Misses and false alarms drawn once per pose; a false alarm lies at any candidate in view.

    As many false alarms as give the precision, over all poses, that the statistics promise.
    """
    count = len(space.graph)
    x_m, y_m = space.candidates.x_m, space.candidates.y_m
    sees_any = np.diff(space.observability.seen_start) > 0
    false_for_each_true = (1.0 - statistics.precision) / statistics.precision
    true_alarms = statistics.recall * np.count_nonzero(in_view)
    p_false = min(1.0, false_for_each_true * true_alarms / np.count_nonzero(sees_any))
    hit = in_view & (rng.random(count) < statistics.recall)
    false_alarm = sees_any & (rng.random(count) < p_false)
    sightings = []
    for pose in np.nonzero(hit | false_alarm)[0]:
        if hit[pose]:
            off_m = rng.normal(0.0, PLACE_SIGMA_M, size=2)
            sightings.append((int(pose), x_m[place] + off_m[0], y_m[place] + off_m[1]))
        if false_alarm[pose]:
            elsewhere = rng.choice(space.observability.seen_by(int(pose)))
            sightings.append((int(pose), x_m[elsewhere], y_m[elsewhere]))
    return _record(space, sightings, PLACE_SIGMA_M, statistics)


def _record(
    space: SearchSpace,
    sightings: list[tuple[int, float, float]],
    sigma_m: float,
    statistics: ClassStatistics,
) -> DetectionRecord:
    """Detections (pose, x_m, y_m) as normal densities over the candidates in view, the largest 1."""
    spread: list[Sighting] = []
    for pose, x_m, y_m in sightings:
        seen = space.observability.seen_by(pose)
        squared = (space.candidates.x_m[seen] - x_m) ** 2 + (space.candidates.y_m[seen] - y_m) ** 2
        weight = np.exp(-0.5 * (squared - squared.min()) / sigma_m**2)
        kept = weight > _NEGLIGIBLE
        spread.append((pose, seen[kept], weight[kept]))
    return DetectionRecord.of(statistics, spread)
