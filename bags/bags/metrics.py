"""How a recorded search went: the thesis' metrics (METHODS 1) for one episode."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from bags.false_alarms import false_alarms, has_label
from bags.metrics_settings import MetricsSettings, settings_of
from bags.reader import Bag
from bags.search_run import SearchRun, read_search
from bags.shortest_way import shortest_way_m
from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import Pose2D


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchMetrics:
    """One search. What the bag does not tell is None.

    `phase` is the last that the planner told, `found` whether that is `found`; `success` whether an instance
    of the target was then in view and near. `steps` are the planner's, docking included. `false_alarms` are
    the robot's poses at which the target was detected where it is not, without the search ending there.
    """

    target: str
    episode: int
    phase: str | None
    found: bool | None
    success: bool | None
    steps: int | None
    path_length_m: float | None
    shortest_path_m: float | None
    spl: float | None
    false_alarms: int | None
    wall_duration_s: float | None
    sim_duration_s: float | None


def search_metrics(
    bag: Bag,
    *,
    namespace: str | None = None,
    episode: int | None = None,
    settings: MetricsSettings | None = None,
) -> SearchMetrics:
    """Measure search number `episode` (the last one where None) of the robot in `namespace`.

    Settings that are not given are those of the recorded run. Raises what `read_search` and `settings_of`
    raise.
    """
    run = read_search(bag, namespace=namespace, episode=episode)
    return measure(run, settings or settings_of(bag.manifest, run.namespace))


def measure(run: SearchRun, settings: MetricsSettings) -> SearchMetrics:
    """Measure a search that is already read."""
    found = run.final.phase == SearchPhase.FOUND if run.final else None
    success = _success(run, found, settings)
    walked_m = path_length_m([heard.value.pose for heard in run.odometry], settings.noise_m)
    shortest_m = _shortest_m(run, settings)
    return SearchMetrics(
        target=run.target,
        episode=run.episode,
        phase=str(run.final.phase) if run.final else None,
        found=found,
        success=success,
        steps=run.final.step if run.final else (len(run.decisions) or None),
        path_length_m=walked_m,
        shortest_path_m=shortest_m,
        spl=spl(success, walked_m, shortest_m),
        false_alarms=_survived(run, settings),
        wall_duration_s=None if run.lockstep else (run.end_ns - run.begin_ns) / 1e9,
        sim_duration_s=_sim_duration_s(run),
    )


def path_length_m(poses: Sequence[Pose2D], noise_m: float) -> float | None:
    """Length of the way through `poses`; None where there are none.

    A pose counts once it is `noise_m` away from the last that counted, so that the jitter of a robot that
    stands still adds nothing.
    """
    if not poses:
        return None
    length_m, last = 0.0, poses[0]
    for pose in poses[1:]:
        moved_m = last.distance_m(pose)
        if moved_m >= noise_m:
            length_m, last = length_m + moved_m, pose
    return length_m


def spl(success: bool | None, walked_m: float | None, shortest_m: float | None) -> float | None:
    """Success weighted by path length, eq. 3.3 for one episode: S l / max(p, l); None where unknown."""
    if success is None:
        return None
    if not success:
        return 0.0
    if walked_m is None or shortest_m is None:
        return None
    longer_m = max(walked_m, shortest_m)
    return shortest_m / longer_m if longer_m > 0.0 else 1.0


def _survived(run: SearchRun, settings: MetricsSettings) -> int | None:
    alarms = false_alarms(run, settings.mount, settings.false_alarm_distance_m)
    if alarms is None or run.final is None:
        return None
    if run.final.phase != SearchPhase.FOUND:
        return len(alarms)
    near_m = settings.false_alarm_distance_m
    end = run.final
    return sum(math.hypot(a.x_m - end.best_x_m, a.y_m - end.best_y_m) > near_m for a in alarms)


def _success(run: SearchRun, found: bool | None, settings: MetricsSettings) -> bool | None:
    if found is None or not found:
        return found
    if run.targets is None or run.visible is None or run.visible_labels is None or run.end is None:
        return None
    in_view = set(run.visible.instance[has_label(run.visible.label, run.visible_labels, run.target)].tolist())
    return any(
        target.instance in in_view
        and math.hypot(target.x_m - run.end.x_m, target.y_m - run.end.y_m) <= settings.success_distance_m
        for target in run.targets
    )


def _shortest_m(run: SearchRun, settings: MetricsSettings) -> float | None:
    if run.floor_map is None or not run.targets or run.start is None:
        return None
    return shortest_way_m(
        run.floor_map, run.candidates, settings.space, run.start, run.targets, settings.success_distance_m
    )


def _sim_duration_s(run: SearchRun) -> float | None:
    if not run.odometry:
        return None
    return (run.odometry[-1].value.stamp_ns - run.odometry[0].value.stamp_ns) / 1e9
