"""Which episodes a search benchmark has: decided by its seed alone, the same for every planner."""

import math
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import Bool
from robustnav_nodes.benchmarks.contestants import Contestant
from robustnav_nodes.benchmarks.import_pomp import import_pomp
from robustnav_nodes.benchmarks.scene_file import read_scene
from robustnav_nodes.benchmarks.search_episode import EpisodeResult, run_episode
from robustnav_nodes.benchmarks.search_scene import SearchScene, SearchTarget
from robustnav_nodes.benchmarks.search_suite import DETECTORS, DIFFICULTIES, make_scene, starts_of
from robustnav_nodes.search_space.pose_graph import NOWHERE, PoseGraph

ALL = "all"
SUITES = (*(f"{difficulty}-{detector}" for difficulty in DIFFICULTIES for detector in DETECTORS), ALL)
EPISODES_IN_SCENE = 4
SCENES_OF_SEED = 1000  # seeds 1 and 2 share no scene


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneJob:
    """All episodes in one scene, for all planners; goes from process to process.

    load: makes or reads the scene; detectors: whose word is taken, None: whoever says something about the
    scene's targets; numbers: of the episodes, which with the seed and the scene's name decide them.
    """

    load: partial[SearchScene]
    detectors: tuple[str, ...] | None
    numbers: range
    seed: int
    contestants: tuple[Contestant, ...]

    @property
    def source(self) -> str:
        """What is loaded, as the report tells it: "hard, 1003", or the path of a file."""
        return ", ".join(str(part) for part in self.load.args)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlayedEpisode:
    """What became of one planner in one episode."""

    planner: str
    difficulty: str
    detector: str
    scene: str
    number: int
    result: EpisodeResult


def suite_jobs(
    suite: str, *, seed: int, episodes: int, contestants: tuple[Contestant, ...]
) -> list[SceneJob]:
    """`episodes` for each difficulty and detector of `suite`, the slowest scenes first.

    Both detectors are asked in the same episodes. Raises BadParameterError for an unknown suite.
    """
    if suite not in SUITES:
        raise BadParameterError(f"there is no suite {suite!r}: choose of {', '.join(SUITES)}")
    difficulties: tuple[str, ...] = tuple(DIFFICULTIES)
    detectors: tuple[str, ...] = DETECTORS
    if suite != ALL:
        only, by = suite.split("-")
        difficulties, detectors = (only,), (by,)
    scenes = min(SCENES_OF_SEED, math.ceil(episodes / EPISODES_IN_SCENE))
    return [
        SceneJob(
            load=partial(make_scene, difficulty, seed * SCENES_OF_SEED + scene),
            detectors=detectors,
            numbers=numbers,
            seed=seed,
            contestants=contestants,
        )
        for difficulty in reversed(difficulties)
        for scene, numbers in enumerate(_shares(episodes, scenes))
    ]


def folder_jobs(
    folder: Path, target_id: int | None, *, seed: int, episodes: int, contestants: tuple[Contestant, ...]
) -> list[SceneJob]:
    """`episodes` for each detector, over all scene files (*.npz) in `folder` together.

    With `target_id`, `folder` is itself a scene in the text format of the released planner. Raises
    BadParameterError where there is no scene.
    """
    if target_id is not None:
        loaders = [partial(import_pomp, folder, target_id)]
    else:
        loaders = [partial(read_scene, path) for path in sorted(folder.glob("*.npz"))]
    if not loaders:
        raise BadParameterError(
            f"there is no scene file (*.npz) in {str(folder)!r}: make some with 'robustnav data import', or "
            "name the object with --target-id where it is a folder of the released POMP-BE-PD planner"
        )
    return [
        SceneJob(load=load, detectors=None, numbers=numbers, seed=seed, contestants=contestants)
        for load, numbers in zip(loaders, _shares(episodes, len(loaders)), strict=True)
        if numbers
    ]


def play(job: SceneJob) -> list[PlayedEpisode]:
    """Every episode of the job with every planner. Raises BadFileError where nothing can be looked for."""
    scene = job.load()
    played = []
    for detector in job.detectors or _detectors_in(scene):
        for number in job.numbers:
            target, start = drawn_episode(
                scene, detector, seed=job.seed, number=number, dock=job.contestants[0].planner.dock
            )
            for contestant in job.contestants:
                result = run_episode(
                    scene,
                    target,
                    detector,
                    start,
                    contestant.planner_for(target.detections[detector].statistics),
                    contestant.belief,
                    chance_of(scene, seed=job.seed, number=number),
                )
                played.append(
                    PlayedEpisode(
                        planner=contestant.name,
                        difficulty=scene.difficulty,
                        detector=detector,
                        scene=scene.name,
                        number=number,
                        result=result,
                    )
                )
    return played


def drawn_episode(
    scene: SearchScene, detector: str, *, seed: int, number: int, dock: bool
) -> tuple[SearchTarget, int]:
    """Target and start of episode `number`: a target that `detector` knows, a start with a way to it.

    With `dock` the way leads to a pose that counts as docked. Raises BadFileError where there is none.
    """
    rng = np.random.default_rng(_entropy(scene, seed, number))
    targets = [target for target in scene.targets if detector in target.detections]
    for place in rng.permutation(len(targets)):
        target = targets[place]
        ends = target.destination if dock and target.destination is not None else target.in_view
        starts = starts_of(scene, target)
        starts = starts[_can_reach(scene.space.graph, ends)[starts]]
        if len(starts):
            return target, int(rng.choice(starts))
    raise BadFileError(
        f"scene {scene.name!r} has no target that the detector {detector!r} knows and a robot can reach from "
        "a start: check its successors, its starts and in_view of its targets"
    )


def chance_of(scene: SearchScene, *, seed: int, number: int) -> np.random.Generator:
    """The chance that planners have in episode `number`: whoever plays it, wherever, and after whatever."""
    return np.random.default_rng([*_entropy(scene, seed, number), 1])


def _entropy(scene: SearchScene, seed: int, number: int) -> Sequence[int]:
    return (seed, zlib.crc32(scene.name.encode()), number)


def _shares(episodes: int, scenes: int) -> list[range]:
    """The numbers 0 .. episodes - 1 in `scenes` ranges of about the same length."""
    ends = [round(episodes * scene / scenes) for scene in range(scenes + 1)]
    return [range(first, last) for first, last in pairwise(ends)]


def _detectors_in(scene: SearchScene) -> list[str]:
    return sorted({name for target in scene.targets for name in target.detections})


def _can_reach(graph: PoseGraph, ends: Bool) -> Bool:
    """bool [n]: the poses from which a way leads to one of `ends`."""
    reaches, before = ends.copy(), 0
    while (count := int(np.count_nonzero(reaches))) > before:
        before = count
        reaches |= np.any((graph.successors != NOWHERE) & reaches[graph.successors], axis=1)
    return reaches
