"""What a report draws onto the map, and the table of decisions."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from bags.metrics_settings import MetricsSettings
from bags.report_talk import Clock
from bags.search_run import SearchRun
from robustnav_msgs_py.frames import base_from_optical, map_from_base

# A robot that stands tells its pose again and again; what moves less than this is left out.
LEAST_MOVE_M, LEAST_TURN_RAD = 0.02, 0.03
MOST_MARKS = 4000


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """A pose at a time."""

    t_s: float
    x_m: float
    y_m: float
    yaw_rad: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Thing:
    """Ground truth: an object; `wanted` where the search was for its class."""

    x_m: float
    y_m: float
    label: str
    wanted: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class Mark:
    """A detection at its place in the map; `wanted` where it is of the target's class.

    `is_false` where it is, but is far from every true instance; never where the truth was not recorded.
    """

    t_s: float
    x_m: float
    y_m: float
    label: str
    score: float
    wanted: bool
    is_false: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class ActionRow:
    """What the planner thought of one action; `value` is None where it was not tried."""

    action: str
    value: float | None
    visits: int


@dataclass(frozen=True, slots=True, kw_only=True)
class DecisionRow:
    """One decision; numbers that are not finite are None."""

    t_s: float
    step: int
    planner: str
    action: str
    reason: str
    p_in_view: float | None
    tau: float | None
    entropy: float | None
    simulations: int
    elapsed_ms: float | None
    actions: tuple[ActionRow, ...]


def way_of(run: SearchRun, clock: Clock) -> tuple[Place, ...]:
    """Where the robot was, as far as it moved; the last pose is always there."""
    way: list[Place] = []
    for index, heard in enumerate(run.odometry):
        pose = heard.value.pose
        turn_rad = math.remainder(pose.yaw_rad, math.tau)
        here = Place(
            t_s=clock(heard.log_time_ns),
            x_m=round(pose.x_m, 3),
            y_m=round(pose.y_m, 3),
            yaw_rad=round(turn_rad, 3),
        )
        is_last = index == len(run.odometry) - 1
        if not way or is_last or _moved(way[-1], here):
            way.append(here)
    return tuple(way)


def _moved(before: Place, now: Place) -> bool:
    turned_rad = abs(math.remainder(now.yaw_rad - before.yaw_rad, math.tau))
    return math.hypot(now.x_m - before.x_m, now.y_m - before.y_m) >= LEAST_MOVE_M or (
        turned_rad >= LEAST_TURN_RAD
    )


def things(run: SearchRun) -> tuple[Thing, ...]:
    """The objects of the home, where the truth was recorded."""
    return tuple(
        Thing(x_m=round(o.x_m, 3), y_m=round(o.y_m, 3), label=o.label, wanted=o.label == run.target)
        for o in run.objects or ()
    )


def marks(run: SearchRun, settings: MetricsSettings, clock: Clock) -> tuple[Mark, ...]:
    """Every detection at its place; one that is said again is marked once."""
    labels = run.detection_labels or ()
    found: list[Mark] = []
    said: set[tuple[float, float, str]] = set()
    for heard in run.detections:
        pose = run.pose_at(heard.value.stamp_ns) if len(heard.value) else None
        if pose is None:
            continue
        places_m = map_from_base(pose, base_from_optical(settings.mount, heard.value.position_m))
        for (x_m, y_m, _), number, score in zip(
            places_m.tolist(), heard.value.label.tolist(), heard.value.score.tolist(), strict=True
        ):
            label = labels[number] if number < len(labels) else f"class {number}"
            key = (round(x_m, 1), round(y_m, 1), label)
            if key in said or not math.isfinite(x_m + y_m) or len(found) >= MOST_MARKS:
                continue
            said.add(key)
            wanted = label == run.target
            is_near = run.targets is None or any(
                math.hypot(o.x_m - x_m, o.y_m - y_m) <= settings.false_alarm_distance_m for o in run.targets
            )
            found.append(
                Mark(
                    t_s=clock(heard.log_time_ns),
                    x_m=round(x_m, 2),
                    y_m=round(y_m, 2),
                    label=label,
                    score=round(score, 3),
                    wanted=wanted,
                    is_false=wanted and not is_near,
                )
            )
    return tuple(found)


def decision_rows(run: SearchRun, decided_s: Sequence[float]) -> tuple[DecisionRow, ...]:
    """The decisions, told at `decided_s`."""
    rows = []
    for heard, t_s in zip(run.decisions, decided_s, strict=True):
        told = heard.value
        rows.append(
            DecisionRow(
                t_s=t_s,
                step=told.step,
                planner=told.planner,
                action=told.action,
                reason=told.reason,
                p_in_view=_finite(told.p_in_view),
                tau=_finite(told.tau),
                entropy=_finite(told.entropy),
                simulations=told.simulations,
                elapsed_ms=_finite(told.elapsed_ms),
                actions=tuple(
                    ActionRow(action=action, value=_finite(value), visits=visits)
                    for action, value, visits in zip(told.actions, told.values, told.visits, strict=False)
                ),
            )
        )
    return tuple(rows)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
