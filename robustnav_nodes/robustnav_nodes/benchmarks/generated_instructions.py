"""Instructions in simulated homes as a pack: homes by seed, walks, many writers, errors put in."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from robustnav_msgs_py.errors import BadFileError, BadParameterError, BadSceneError
from robustnav_nodes.benchmarks.dwelling_of_home import dwelling_of
from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.generated.pack_rows import (
    Line,
    graph_line,
    object_lines,
    room_lines,
    viewpoint_lines,
    walk_lines,
)
from robustnav_nodes.instruction.generated.survey import Survey, instructions_of, survey
from robustnav_nodes.instruction.pack_errors import TRAIN, write_errors
from robustnav_nodes.instruction.pack_writing import PackWriter
from robustnav_nodes.worker_pool import worker_pool

VAL_SEEN, VAL_UNSEEN = "val_seen", "val_unseen"
# Every data seed has two stretches of home seeds of its own: one to train in, one that nobody trains in.
MOST_HOMES = 100_000
_FIRST_HOME = 1_000_000  # those below are homes of other benchmarks
SPLITS = (TRAIN, VAL_SEEN, VAL_UNSEEN)
# A hallway joins rooms from five on: walks of several rooms, with doors at both sides.
ROOMS = (5, 6, 7, 8, 9, 10)
_HOMES_A_JOB = 4
_TOLD_EVERY = 20  # homes


@dataclass(frozen=True, slots=True, kw_only=True)
class GenerationPlan:
    """`homes` homes are trained in; `unseen` others, which no other plan trains in, are for val_unseen alone.

    Plans of different `seed` share no home. `walks` of each home in train and in val_unseen, `walks_seen`
    more of those for val_seen; each is told by `writers`. Raises BadParameterError for more than MOST_HOMES.
    """

    seed: int
    homes: int
    unseen: int
    walks: int = 12
    walks_seen: int = 2
    writers: int = 2

    def __post_init__(self) -> None:
        if max(self.homes, self.unseen) > MOST_HOMES:
            raise BadParameterError(
                f"{self.homes} homes and {self.unseen} unseen ones are too many for one seed; it has "
                f"{MOST_HOMES} of each"
            )

    def seed_of(self, home: int) -> int:
        """Of the home that is `home` numbers after the first."""
        first = _FIRST_HOME + 2 * MOST_HOMES * self.seed
        return first + home + (0 if home < self.homes else MOST_HOMES - self.homes)

    def splits_of(self, home: int) -> dict[str, int]:
        """How many walks of each split the home has that is `home` numbers after the first."""
        if home < self.homes:
            return {TRAIN: self.walks, VAL_SEEN: self.walks_seen}
        return {VAL_UNSEEN: self.walks}


def survey_home(plan: GenerationPlan, home: int) -> Survey | None:
    """Build and survey one home of the plan; None where its seed gives no home that holds together."""
    from sim_bridge.homes.generator import generate_home

    seed = plan.seed_of(home)
    try:
        built = generate_home(seed, rooms=ROOMS[seed % len(ROOMS)])
    except BadSceneError:
        return None
    dwelling = dwelling_of(built, np.random.default_rng([seed, 0]))
    return survey(dwelling, seed, plan.splits_of(home), plan.writers, seed)


def generated_instructions(
    plan: GenerationPlan, split: str, workers: int, say: Callable[[str], object] = lambda told: None
) -> Iterator[Instruction]:
    """The instructions of one split, home by home, without files between; in so many processes.

    `say` is told now and then how many homes are made.
    """
    homes = [home for home in range(plan.homes + plan.unseen) if plan.splits_of(home).get(split)]
    instructions_at = partial(_instructions_at, plan, split)
    if workers == 1:
        yield from _told(map(instructions_at, homes), len(homes), say)
        return
    with worker_pool(workers) as pool:
        yield from _told(pool.map(instructions_at, homes, chunksize=_HOMES_A_JOB), len(homes), say)


def _told(
    made: Iterable[list[Instruction]], homes: int, say: Callable[[str], object]
) -> Iterator[Instruction]:
    for number, of_home in enumerate(made, start=1):
        yield from of_home
        if number % _TOLD_EVERY == 0 or number == homes:
            say(f"made {number} of {homes} homes and what is said in them")


def _instructions_at(plan: GenerationPlan, split: str, home: int) -> list[Instruction]:
    surveyed = survey_home(plan, home)
    return [] if surveyed is None else list(instructions_of(surveyed, split))


def write_generated_pack(
    plan: GenerationPlan,
    folder: Path,
    workers: int,
    advanced: Callable[[int], object] = lambda homes: None,
) -> dict[str, int]:
    """Write a pack into `folder`; `advanced` is told how many more homes are done.

    Returns walks and instructions by split, and homes. Raises BadFileError, and leaves nothing, where the
    folder holds anything or cannot be written, or a split came out empty.
    """
    with PackWriter(folder) as writer:
        lines = _surveyed(plan, workers, advanced)
        counts = lines.write(writer, plan)
        write_errors(writer, [split for split in SPLITS if lines.walks[split]], plan.seed)
    return counts


def _surveyed(plan: GenerationPlan, workers: int, advanced: Callable[[int], object]) -> "_Lines":
    lines = _Lines()
    numbers = range(plan.homes + plan.unseen)
    jobs = [(plan, numbers[at : at + _HOMES_A_JOB]) for at in range(0, len(numbers), _HOMES_A_JOB)]
    with worker_pool(workers) as pool:
        for done in pool.map(_survey_homes, jobs) if workers > 1 else map(_survey_homes, jobs):
            lines.add(done)
            advanced(_HOMES_A_JOB)
    for split in SPLITS:
        wanted = {TRAIN: plan.homes, VAL_SEEN: plan.homes * plan.walks_seen, VAL_UNSEEN: plan.unseen}[split]
        if wanted and not lines.walks[split]:
            raise BadFileError(f"no walk of {split} came out of seed {plan.seed}; ask for more homes")
    return lines


class _Lines:
    """The lines of all homes so far."""

    def __init__(self) -> None:
        self.viewpoints: list[Line] = []
        self.objects: list[Line] = []
        self.rooms: list[Line] = []
        self.graphs: list[Line] = []
        self.walks: dict[str, list[Line]] = {split: [] for split in SPLITS}

    def add(self, other: "_Lines") -> None:
        self.viewpoints += other.viewpoints
        self.objects += other.objects
        self.rooms += other.rooms
        self.graphs += other.graphs
        for split in SPLITS:
            self.walks[split] += other.walks[split]

    def take(self, surveyed: Survey) -> None:
        self.viewpoints += viewpoint_lines(surveyed)
        self.objects += object_lines(surveyed)
        self.rooms += room_lines(surveyed)
        self.graphs.append(graph_line(surveyed))
        for split in SPLITS:
            self.walks[split] += walk_lines(surveyed, split)

    def write(self, writer: PackWriter, plan: GenerationPlan) -> dict[str, int]:
        counts = {"homes": len(self.graphs)}
        for split in SPLITS:
            counts[f"{split} walks"] = len(self.walks[split])
            counts[f"{split} instructions"] = sum(len(line["instructions"]) for line in self.walks[split])
        writer.meta(
            source="simulated homes",
            seed=plan.seed,
            plan={"walks": plan.walks, "walks_seen": plan.walks_seen, "writers": plan.writers},
            scans=[line["scan"] for line in self.graphs],
            counts=counts,
        )
        writer.rows("viewpoints.jsonl.gz", self.viewpoints)
        writer.rows("objects3d.jsonl.gz", self.objects)
        writer.rows("rooms.jsonl.gz", self.rooms)
        writer.rows("graph.jsonl.gz", self.graphs)
        for split in SPLITS:
            if self.walks[split]:
                writer.rows(f"r2r_{split}.jsonl.gz", self.walks[split])
        return counts


def _survey_homes(job: tuple[GenerationPlan, Iterable[int]]) -> _Lines:
    plan, homes = job
    lines = _Lines()
    for home in homes:
        surveyed = survey_home(plan, home)
        if surveyed is not None:
            lines.take(surveyed)
    return lines
