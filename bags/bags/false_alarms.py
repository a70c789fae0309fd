"""Where a detector saw the target although it is not there."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bags.search_run import SearchRun
from robustnav_msgs_py.frames import CameraMount, base_from_optical, map_from_base
from robustnav_msgs_py.values import Bool, Float64, ObjectInstance


@dataclass(frozen=True, slots=True, kw_only=True)
class FalseAlarm:
    """A detection of the target where it is not: its place in the map, and the decision it came after."""

    x_m: float
    y_m: float
    score: float
    step: int


def false_alarms(run: SearchRun, mount: CameraMount, distance_m: float) -> tuple[FalseAlarm, ...] | None:
    """Detections of the target farther than `distance_m` from every true instance, in order.

    None where the bag cannot tell. `mount` is how the camera sits on the robot.

    At most one per decision: while the robot stands, every image shows the detector the same thing.
    """
    if run.targets is None or run.detection_labels is None:
        return None
    decided_ns = [heard.log_time_ns for heard in run.decisions]
    found: dict[int, FalseAlarm] = {}
    for heard in run.detections:
        pose = run.pose_at(heard.value.stamp_ns)
        fired = has_label(heard.value.label, run.detection_labels, run.target)
        if pose is None or not fired.any():
            continue
        place_m = map_from_base(pose, base_from_optical(mount, heard.value.position_m[fired]))
        away_m = _distance_to_nearest_m(place_m, run.targets)
        step = int(np.searchsorted(decided_ns, heard.log_time_ns))
        for (x_m, y_m, _), off_m, score in zip(place_m, away_m, heard.value.score[fired], strict=True):
            if off_m > distance_m and step not in found:
                found[step] = FalseAlarm(x_m=float(x_m), y_m=float(y_m), score=float(score), step=step)
    return tuple(found[step] for step in sorted(found))


def has_label(label: NDArray[np.uint32], names: Sequence[str], wanted: str) -> Bool:
    """bool [n]: which of the label numbers (uint32 [n], indices into `names`) stand for `wanted`."""
    numbers = [number for number, name in enumerate(names) if name == wanted]
    return np.isin(label, np.array(numbers, dtype=np.uint32))


def _distance_to_nearest_m(place_m: Float64, targets: Sequence[ObjectInstance]) -> Float64:
    """float64 [n]: distance on the floor from each place to the nearest target, +Inf where there is none."""
    if not targets:
        return np.full(len(place_m), math.inf)
    dx = place_m[:, 0, None] - np.array([target.x_m for target in targets])
    dy = place_m[:, 1, None] - np.array([target.y_m for target in targets])
    return np.asarray(np.hypot(dx, dy).min(axis=1), dtype=np.float64)
