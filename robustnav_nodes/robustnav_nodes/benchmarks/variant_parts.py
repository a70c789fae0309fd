"""What the variants beyond the thesis are worth: one experiment for each, played one episode at a time."""

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.values import Float64
from robustnav_nodes.belief.online_statistics import CountedLook, OnlineStatistics
from robustnav_nodes.belief.prior import RegionFact, region_prior, told
from robustnav_nodes.benchmarks.blocked_ways import with_blocked_ways
from robustnav_nodes.benchmarks.contestants import DEFAULT, Contestant, contestants
from robustnav_nodes.benchmarks.rooms import rooms_of
from robustnav_nodes.benchmarks.search_episode import BeliefMoment, EpisodeResult, Outcome, run_episode
from robustnav_nodes.benchmarks.search_plan import chance_of, drawn_episode
from robustnav_nodes.benchmarks.search_scene import SearchScene, SearchTarget
from robustnav_nodes.benchmarks.search_suite import NOISY, PERFECT, starts_of
from robustnav_nodes.benchmarks.tour_episode import TourResult, run_at_once, run_one_after_another
from robustnav_nodes.planner.parameters import PlannerParameters

DATA_SHEET = ClassStatistics(precision=0.5, recall=0.9)  # wrong: the scenes' are about 0.8 and 0.6
SEARCHES = 6
RELIABILITY = 0.8  # of a person who says which room
TARGETS = 3
BLOCKED = (0.0, 0.05, 0.1)


class Score(NamedTuple):
    """Of one episode, or the mean of several: success, SPL (NaN where it has no meaning), steps."""

    sr: float
    spl: float
    steps: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Episode:
    """A search that every variant of a part plays."""

    scene: SearchScene
    target: SearchTarget
    start: int
    seed: int
    number: int
    contestant: Contestant

    @classmethod
    def drawn(cls, scene: SearchScene, seed: int, number: int) -> "Episode":
        """Episode `number` in a scene of the suite, for the default planner."""
        target, start = drawn_episode(scene, NOISY, seed=seed, number=number, dock=False)
        contestant = contestants([DEFAULT], dock=False, simulations=PlannerParameters().simulations)[0]
        return cls(scene=scene, target=target, start=start, seed=seed, number=number, contestant=contestant)

    @property
    def place(self) -> int:
        """The candidate that holds the target: where the detector that never errs sees it."""
        record = self.target.detections[PERFECT]
        return int(record.candidate[np.argmax(record.weight)])

    def chance(self, purpose: int) -> np.random.Generator:
        """Chance for whatever is drawn on top, the same for every variant."""
        return np.random.default_rng([self.seed, self.number, self.place, purpose])

    def play(
        self,
        *,
        statistics: ClassStatistics | None = None,
        start: int | None = None,
        moments: list[BeliefMoment] | None = None,
        prior: Float64 | None = None,
        blocked: float = 0.0,
    ) -> EpisodeResult:
        """The episode, with what changes: statistics to believe in, start, prior, share of blocked ways."""
        target, graph = self.target, self.scene.space.graph
        if statistics is not None:
            record = dataclasses.replace(target.detections[NOISY], statistics=statistics)
            target = dataclasses.replace(target, detections={NOISY: record})
        return run_episode(
            self.scene,
            target,
            NOISY,
            self.start if start is None else start,
            self.contestant.planner_for(target.detections[NOISY].statistics),
            self.contestant.belief,
            chance_of(self.scene, seed=self.seed, number=self.number),
            moments,
            prior=prior,
            open_graph=with_blocked_ways(graph, blocked, self.chance(1)),
        )


def statistics_part(episode: Episode) -> dict[str, Score]:
    """The same target searched for again and again, from other starts; means without the first search.

    What is believed of the detector at first is wrong. Learning, the robot is shown the target after a find,
    or told that it is not there; it counts each pose's look once, as the detector repeats itself.
    """
    others = episode.chance(2).choice(starts_of(episode.scene, episode.target), size=SEARCHES - 1)
    starts = [episode.start, *map(int, others)]
    right = episode.target.detections[NOISY].statistics
    learnt = learnt_statistics(episode, starts)
    return {
        "wrong": _mean([episode.play(statistics=DATA_SHEET, start=start) for start in starts[1:]]),
        "learnt": _mean([result for result, _ in learnt[1:]]),
        "right": _mean([episode.play(statistics=right, start=start) for start in starts[1:]]),
    }


def learnt_statistics(episode: Episode, starts: list[int]) -> list[tuple[EpisodeResult, ClassStatistics]]:
    """A search from each start, and what is believed of the detector after it."""
    space, record = episode.scene.space, episode.target.detections[NOISY]
    online = OnlineStatistics.starting_from(DATA_SHEET)
    counted: set[int] = set()
    searches = []
    for start in starts:
        moments: list[BeliefMoment] = []
        result = episode.play(statistics=online.statistics, start=start, moments=moments)
        poses = {moment.pose for moment in moments} - counted
        looks = [
            CountedLook(
                in_view=space.observability.row(pose), densities=record.at(pose, len(space.candidates))
            )
            for pose in sorted(poses)
        ]
        last = moments[-1]
        if result.is_success:
            online = online.confirmed(looks, episode.place)
            counted |= poses
        elif result.outcome is Outcome.LOCALISATION_ERROR:
            found = np.where(space.observability.row(last.pose), last.probability, -1.0)
            online = online.refuted(looks, int(np.argmax(found)))
        searches.append((result, online.statistics))
    return searches


def prior_part(episode: Episode) -> dict[str, Score]:
    """Nothing known, and a person who names the target's room, or by mistake any other one."""
    view = episode.scene.space.view
    assert view is not None  # a scene of the suite is drawn on a map
    room = rooms_of(view)
    rooms, rng = int(room.max()) + 1, episode.chance(3)
    named = int(room[episode.place])
    if rng.random() >= RELIABILITY and rooms > 1:
        named = int(rng.choice(np.delete(np.arange(rooms), named)))
    everywhere = region_prior(room, np.bincount(room).astype(np.float64))
    prior = told(everywhere, room, RegionFact(region=named, trust=RELIABILITY))
    return {"nothing known": _mean([episode.play()]), "told the room": _mean([episode.play(prior=prior)])}


def targets_part(episode: Episode) -> dict[str, Score]:
    """Several targets one after another, and all in one search; `sr` is the share of targets found."""
    others = [target for target in episode.scene.targets if target is not episode.target]
    chosen = episode.chance(4).permutation(len(others))[: TARGETS - 1]
    targets = [episode.target, *(others[number] for number in chosen)]
    planner = episode.contestant.planner_for(episode.target.detections[NOISY].statistics)
    together = dataclasses.replace(planner, max_steps=TARGETS * planner.max_steps)
    rng = chance_of(episode.scene, seed=episode.seed, number=episode.number)
    belief = episode.contestant.belief
    return {
        "one after another": _of_tour(
            run_one_after_another(episode.scene, targets, NOISY, episode.start, planner, belief, rng)
        ),
        "at once": _of_tour(run_at_once(episode.scene, targets, NOISY, episode.start, together, belief, rng)),
    }


def blocked_part(episode: Episode) -> dict[str, Score]:
    """Shares of the ways that prove blocked when they are tried."""
    return {f"{share:.0%} blocked": _mean([episode.play(blocked=share)]) for share in BLOCKED}


PARTS: dict[str, Callable[[Episode], dict[str, Score]]] = {
    "detector statistics": statistics_part,
    "prior": prior_part,
    "several targets": targets_part,
    "blocked ways": blocked_part,
}


def _mean(results: list[EpisodeResult]) -> Score:
    scores = np.array([(result.is_success, result.spl, result.steps) for result in results], dtype=np.float64)
    return Score(*map(float, scores.mean(axis=0)))


def _of_tour(result: TourResult) -> Score:
    return Score(sr=float(np.mean(result.found)), spl=float("nan"), steps=float(result.steps))
