"""All that a report shows of one search, as values that go into a page; what the bag lacks is said."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from bags.changed_parameters import ChangedParameter, changed_parameters
from bags.episodes import EpisodeSpan, episode_spans
from bags.manifest import Manifest
from bags.metrics import measure
from bags.metrics_settings import MetricsSettings, settings_of
from bags.picture import headline
from bags.reader import Bag
from bags.recorded_values import RecordedValue, recorded_values
from bags.report_belief import BeliefFilm, belief_film
from bags.report_camera import CameraFrame, Moment, camera_frames, chosen_moments
from bags.report_facts import Fact, manifest_facts, search_facts
from bags.report_floor import FloorPicture, floor_picture
from bags.report_marks import DecisionRow, Mark, Place, Thing, decision_rows, marks, things, way_of
from bags.report_talk import CHAT, Clock, Complaint, Line, complaints, conversation
from bags.search_run import TOPICS, Heard, SearchRun, read_search
from robustnav_msgs_py.errors import BadFileError, BadMessageError, BadParameterError
from robustnav_msgs_py.values import Pose2D

CAMERA, BELIEF, GOAL = "camera/image_raw", "belief/cloud", "goal_pose"
MARGIN_M = 1.0  # shown around what was told, where no map was


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportData:
    """One search. Times are seconds of the robot's clock since the search began; places are in the map.

    `verdict` is "good", "bad" or "open"; `missing` are sentences about what the bag does not hold.
    `shown_m` is what of the map is drawn: left, right, bottom, top; None where there is nothing to draw.
    """

    title: str
    verdict: str
    source: str
    facts: tuple[Fact, ...]
    missing: tuple[str, ...]
    end_s: float
    half_view_rad: float
    floor: FloorPicture | None
    belief: BeliefFilm | None
    shown_m: tuple[float, float, float, float] | None
    way: tuple[Place, ...]
    goals: tuple[Place, ...]
    things: tuple[Thing, ...]
    marks: tuple[Mark, ...]
    decisions: tuple[DecisionRow, ...]
    frames: tuple[CameraFrame, ...]
    chat: tuple[Line, ...]
    complaints: tuple[Complaint, ...]
    run: tuple[Fact, ...]
    changed: tuple[ChangedParameter, ...]


def read_report(bag: Bag, *, namespace: str | None = None, episode: int | None = None) -> ReportData:
    """Gather what a report shows of search number `episode` (the last one where None).

    Raises BadFileError where the bag holds no such search, holds several robots and none was chosen, or is
    damaged inside. Where it holds no search at all, the report shows what else there is.
    """
    missing = [f"The recording was cut. {bag.cut}."] if bag.cut else []
    run = _search(bag, namespace, episode, missing)
    settings = _settings(bag.manifest, run, missing)
    span = _span(bag, run)
    clock = _clock(bag, run)
    said = [value for topic in CHAT for value in _told(bag, topic, run, missing)]
    chat = conversation([value for value in said if span is None or span.holds(value.log_time_ns)], clock)
    if run is None:
        return _without_search(bag, missing, chat, complaints(bag, span, clock))
    metrics = measure(run, settings)
    decided_s = [clock(heard.log_time_ns) for heard in run.decisions]
    film = _film(bag, run, settings, clock, missing)
    frames = _frames(bag, run, clock, missing)
    goals = [
        value for value in _told(bag, GOAL, run, missing) if run.begin_ns <= value.log_time_ns <= run.end_ns
    ]
    missing += _lacking(run, film, frames)
    floor = floor_picture(run.floor_map) if run.floor_map else None
    way, drawn, objects = way_of(run, clock), marks(run, settings, clock), things(run)
    return ReportData(
        title=headline(metrics),
        verdict={True: "good", False: "bad" if metrics.found else "open", None: "open"}[metrics.success],
        source=bag.path.name,
        facts=search_facts(metrics),
        missing=tuple(missing),
        end_s=max(clock(run.end_ns), 0.0),
        half_view_rad=settings.space.horizontal_view_rad / 2.0,
        floor=floor,
        belief=film,
        shown_m=_shown(floor, film, [*way, *drawn, *objects]),
        way=way,
        goals=tuple(_place(clock(value.log_time_ns), value.value.pose) for value in goals),
        things=objects,
        marks=drawn,
        decisions=decision_rows(run, decided_s),
        frames=frames,
        chat=chat,
        complaints=complaints(bag, span, clock),
        run=manifest_facts(bag.manifest),
        changed=changed_parameters(bag.manifest) if bag.manifest else (),
    )


def _search(bag: Bag, namespace: str | None, episode: int | None, missing: list[str]) -> SearchRun | None:
    told = {row.name for row in bag.topics if row.message_count}
    if not any(name.endswith(f"/{topic}") for name in told for topic in TOPICS):
        missing.append("The bag holds no search: no map, pose, belief, target or decision was recorded.")
        return None
    try:
        return read_search(bag, namespace=namespace, episode=episode)
    except BadMessageError as error:
        missing.append(f"The search cannot be shown: {error}.")
        return None


def _settings(manifest: Manifest | None, run: SearchRun | None, missing: list[str]) -> MetricsSettings:
    try:
        return settings_of(manifest, run.namespace if run else "")
    except BadParameterError as error:
        missing.append(f"Camera and search space are taken to be the default ones: {error}.")
        return MetricsSettings()


def _span(bag: Bag, run: SearchRun | None) -> EpisodeSpan | None:
    spans = episode_spans(bag, run.namespace) if run else ()
    return next((span for span in spans if run and span.episode == run.episode), None)


def _clock(bag: Bag, run: SearchRun | None) -> Clock:
    """Seconds of the robot's clock since the search began; where no pose tells it, of the recorder's."""
    if run is None or not run.odometry:
        begin_ns = run.begin_ns if run else (bag.span_ns or (0, 0))[0]
        return lambda log_time_ns: round((log_time_ns - begin_ns) / 1e9, 3)
    first_ns = run.odometry[0].log_time_ns
    heard_s = np.array([(heard.log_time_ns - first_ns) / 1e9 for heard in run.odometry])
    begun_ns = run.odometry[0].value.stamp_ns
    told_s = np.array([(heard.value.stamp_ns - begun_ns) / 1e9 for heard in run.odometry])

    def clock(log_time_ns: int) -> float:
        at_s = (log_time_ns - first_ns) / 1e9
        outside_s = min(at_s, 0.0) + max(at_s - float(heard_s[-1]), 0.0)
        return round(float(np.interp(at_s, heard_s, told_s)) + outside_s, 3)

    return clock


def _told(bag: Bag, topic: str, run: SearchRun | None, missing: list[str]) -> list[RecordedValue]:
    """Everything on `topic`, up to a message that does not hold what it should."""
    found: list[RecordedValue] = []
    try:
        found.extend(recorded_values(bag, [topic], namespace=run.namespace if run else ""))
    except (BadMessageError, BadFileError) as error:
        missing.append(f"Of {topic}, only what came before a bad message is shown: {error}.")
    return found


def _film(
    bag: Bag, run: SearchRun, settings: MetricsSettings, clock: Clock, missing: list[str]
) -> BeliefFilm | None:
    told = [value for value in _told(bag, BELIEF, run, missing) if value.log_time_ns <= run.end_ns]
    before = sum(value.log_time_ns < run.begin_ns for value in told)
    beliefs = [
        Heard(log_time_ns=value.log_time_ns, value=value.value) for value in told[max(0, before - 1) :]
    ]
    if not beliefs:
        return None
    times_s = [max(clock(heard.log_time_ns), 0.0) for heard in beliefs]
    size_m = settings.space.candidate_size_m
    film = belief_film(beliefs, times_s, run.floor_map, run.candidates, size_m)
    if len(film.frames) < film.told:
        missing.append(f"The belief is shown at {len(film.frames)} of the {film.told} moments it changed at.")
    return film


def _frames(bag: Bag, run: SearchRun, clock: Clock, missing: list[str]) -> tuple[CameraFrame, ...]:
    """At each decision and at the end; where nothing was decided, evenly over the time."""
    times_ns: Collection[int] = [heard.log_time_ns for heard in run.decisions]
    if not times_ns:
        times_ns = [int(time) for time in np.linspace(run.begin_ns, run.end_ns, 21)[1:-1]]
    moments = [
        Moment(log_time_ns=time_ns, t_s=clock(time_ns), decision=index if run.decisions else None)
        for index, time_ns in enumerate(times_ns)
    ]
    moments.append(Moment(log_time_ns=run.end_ns, t_s=clock(run.end_ns), decision=None))
    images = recorded_values(bag, [CAMERA], namespace=run.namespace)
    try:
        return camera_frames(
            images, chosen_moments(moments), run.detections, run.detection_labels or (), run.target
        )
    except (BadMessageError, BadFileError) as error:
        missing.append(f"The camera's images cannot be shown: {error}.")
        return ()


def _shown(
    floor: FloorPicture | None, film: BeliefFilm | None, places: Sequence[Place | Mark | Thing]
) -> tuple[float, float, float, float] | None:
    if floor is not None:
        return floor.shown_m
    x_m, y_m = [place.x_m for place in places], [place.y_m for place in places]
    for layout in film.layouts if film else ():
        x_m += [layout.left_m, layout.left_m + layout.columns * layout.cell_m]
        y_m += [layout.bottom_m, layout.bottom_m + layout.rows * layout.cell_m]
    if not x_m:
        return None
    return min(x_m) - MARGIN_M, max(x_m) + MARGIN_M, min(y_m) - MARGIN_M, max(y_m) + MARGIN_M


def _lacking(run: SearchRun, film: BeliefFilm | None, frames: Sequence[CameraFrame]) -> list[str]:
    lacking = {
        "the map": run.floor_map is None,
        "the robot's pose": not run.odometry,
        "the belief": film is None,
        "how the search stood": run.final is None,
        "the planner's decisions": not run.decisions,
        "the camera's images": not frames,
        "detections": not run.detections,
        "the truth (where the objects were)": run.objects is None,
    }
    absent = [name for name, is_absent in lacking.items() if is_absent]
    return [f"Not recorded, or not in what is left: {', '.join(absent)}."] if absent else []


def _without_search(
    bag: Bag, missing: Sequence[str], chat: tuple[Line, ...], complained: tuple[Complaint, ...]
) -> ReportData:
    span = bag.span_ns or (0, 0)
    return ReportData(
        title="No search was recorded",
        verdict="open",
        source=bag.path.name,
        facts=(),
        missing=tuple(missing),
        end_s=(span[1] - span[0]) / 1e9,
        half_view_rad=0.0,
        floor=None,
        belief=None,
        shown_m=None,
        way=(),
        goals=(),
        things=(),
        marks=(),
        decisions=(),
        frames=(),
        chat=chat,
        complaints=complained,
        run=manifest_facts(bag.manifest),
        changed=changed_parameters(bag.manifest) if bag.manifest else (),
    )


def _place(t_s: float, pose: Pose2D) -> Place:
    turn_rad = math.remainder(pose.yaw_rad, math.tau)
    return Place(t_s=t_s, x_m=round(pose.x_m, 3), y_m=round(pose.y_m, 3), yaw_rad=round(turn_rad, 3))
