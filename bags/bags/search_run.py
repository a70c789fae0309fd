"""One search as a bag tells it: what was said between its begin and its end, in values."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from bags.episodes import ACTIVE
from bags.reader import Bag
from bags.recorded_values import RecordedValue, namespace_of, recorded_values
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.records import Decision, SearchState
from robustnav_msgs_py.values import (
    BeliefCloud,
    Detections,
    ObjectInstance,
    OccupancyMap,
    Odometry,
    Pose2D,
    VisibleObjects,
)

T = TypeVar("T")

TOPICS = (
    "map",
    "search/candidates",
    "odom",
    "search/target",
    "search/state",
    "planner/decision",
    "belief/cloud",
    "truth/objects",
    "truth/visible",
    "truth/labels",
    "detections",
    "detections/labels",
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Heard(Generic[T]):
    """A value and the wall-clock time at which the recorder heard it."""

    log_time_ns: int
    value: T


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SearchRun:
    """One search, from its first `searching` to its end, or to the end of the bag where it had none.

    What was never recorded is None or empty. `final` is the last state that the planner told. `floor_map`,
    `candidates`, `belief` and `visible` are the last that were told before the end. `lockstep`: log times are
    those of the run's own clock, and tell nothing of the wall's.
    """

    namespace: str
    episode: int
    target: str
    begin_ns: int
    end_ns: int
    lockstep: bool
    final: SearchState | None
    floor_map: OccupancyMap | None
    candidates: OccupancyMap | None
    belief: BeliefCloud | None
    odometry: tuple[Heard[Odometry], ...]
    decisions: tuple[Heard[Decision], ...]
    objects: tuple[ObjectInstance, ...] | None
    visible: VisibleObjects | None
    visible_labels: tuple[str, ...] | None
    detections: tuple[Heard[Detections], ...]
    detection_labels: tuple[str, ...] | None

    @property
    def targets(self) -> tuple[ObjectInstance, ...] | None:
        """The objects that the search is for; None where ground truth was not recorded."""
        return None if self.objects is None else tuple(o for o in self.objects if o.label == self.target)

    @property
    def start(self) -> Pose2D | None:
        """Where the robot was when the search began."""
        return self.odometry[0].value.pose if self.odometry else None

    @property
    def end(self) -> Pose2D | None:
        """Where the robot was when the search ended."""
        return self.odometry[-1].value.pose if self.odometry else None

    def pose_at(self, stamp_ns: int, tolerance_s: float = 0.5) -> Pose2D | None:
        """The recorded pose whose stamp is nearest to `stamp_ns`; None where none is near enough."""
        if not self.odometry:
            return None
        stamps = np.array([heard.value.stamp_ns for heard in self.odometry])
        nearest = int(np.argmin(np.abs(stamps - stamp_ns)))
        return (
            self.odometry[nearest].value.pose
            if abs(stamps[nearest] - stamp_ns) <= tolerance_s * 1e9
            else None
        )


def read_search(bag: Bag, *, namespace: str | None = None, episode: int | None = None) -> SearchRun:
    """Read the search number `episode` (the last one where None) of the robot in `namespace`.

    Raises BadFileError where the bag holds no such search, or holds several robots and none was chosen.
    """
    if namespace is None:
        namespace = namespace_of(bag, "search/state") or namespace_of(bag, "odom")
    namespace = f"/{namespace.strip('/')}" if namespace.strip("/") else ""
    heard: dict[str, list[RecordedValue]] = {topic: [] for topic in TOPICS}
    for value in recorded_values(bag, TOPICS, namespace=namespace):
        heard[value.topic].append(value)
    if not any(heard.values()):
        raise BadFileError(f"{bag.path} holds no search: none of {', '.join(TOPICS)} was recorded")

    states: list[Heard[SearchState]] = _all(heard["search/state"])
    chosen, begin_ns, end_ns, final = _bounds(bag, states, heard, episode)
    in_time = {
        topic: [value for value in values if value.log_time_ns <= end_ns] for topic, values in heard.items()
    }
    odometry: list[Heard[Odometry]] = _all(in_time["odom"])
    decisions: list[Heard[Decision]] = _all(in_time["planner/decision"])
    detections: list[Heard[Detections]] = _all(in_time["detections"])
    told_target = _last(in_time["search/target"]) or ""
    return SearchRun(
        namespace=namespace,
        episode=chosen,
        target=final.target if final else told_target,
        begin_ns=begin_ns,
        end_ns=end_ns,
        lockstep=bag.manifest is not None and bag.manifest.lockstep,
        final=final,
        floor_map=_last(in_time["map"]),
        candidates=_last(in_time["search/candidates"]),
        belief=_last(in_time["belief/cloud"]),
        odometry=tuple(_since(odometry, begin_ns)),
        decisions=tuple(item for item in decisions if item.value.episode == chosen or not states),
        objects=_last(in_time["truth/objects"]),
        visible=_last(in_time["truth/visible"]),
        visible_labels=_last(in_time["truth/labels"]),
        detections=tuple(item for item in detections if item.log_time_ns >= begin_ns),
        detection_labels=_last(in_time["detections/labels"]),
    )


def _bounds(
    bag: Bag, states: Sequence[Heard[SearchState]], heard: dict[str, list[RecordedValue]], episode: int | None
) -> tuple[int, int, int, SearchState | None]:
    """Episode, begin, end (log times) and last state of the search that is asked for."""
    times = [value.log_time_ns for values in heard.values() for value in values]
    begun = sorted({state.value.episode for state in states if state.value.phase in ACTIVE})
    if not begun and episode is None:
        return 0, min(times), max(times), states[-1].value if states else None
    chosen = begun[-1] if episode is None else episode
    if chosen not in begun:
        raise BadFileError(
            f"{bag.path} holds no search number {chosen}; it holds {begun or 'none that began'}"
        )
    own = [state for state in states if state.value.episode == chosen]
    begin = next(state for state in own if state.value.phase in ACTIVE)
    after = [state for state in own if state.log_time_ns >= begin.log_time_ns]
    ended = next((state for state in after if state.value.phase not in ACTIVE), None)
    if ended is None:
        return chosen, begin.log_time_ns, max(times), after[-1].value
    return chosen, begin.log_time_ns, ended.log_time_ns, ended.value


def _all(values: Sequence[RecordedValue]) -> list[Heard[T]]:
    return [Heard(log_time_ns=value.log_time_ns, value=value.value) for value in values]


def _last(values: Sequence[RecordedValue]) -> T | None:
    return values[-1].value if values else None


def _since(odometry: Sequence[Heard[Odometry]], begin_ns: int) -> Sequence[Heard[Odometry]]:
    """From the last one before `begin_ns` on: a robot that stands still tells where it was."""
    before = sum(1 for item in odometry if item.log_time_ns < begin_ns)
    return odometry[max(0, before - 1) :]
