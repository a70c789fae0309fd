"""What decides the belief, on top of the search space that it shares with the planner."""

import math
from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter
from robustnav_nodes.search_space.parameters import SearchSpaceParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class BeliefParameters(SearchSpaceParameters):
    """How an observation changes the belief, and which observations count."""

    detection_sigma_m: float = parameter(
        0.5, "standard deviation of a detected place on the floor", unit="m", low=0.05, high=5.0
    )
    evidence: str = parameter(
        "likelihood",
        "what a look is worth: a likelihood ratio, or the thesis' F1 factors",
        choices=("likelihood", "f1"),
    )
    recall_min: float = parameter(
        0.05, "likelihood: a detector's recall counts as at least this", low=0.001, high=0.999
    )
    recall_max: float = parameter(
        0.98, "likelihood: a detector's recall counts as at most this", low=0.001, high=0.9999
    )
    recall_loss: float = parameter(
        0.0,
        "likelihood: part of the recall that is lost at range_max_m, in proportion nearer by; not where the "
        "statistics tell recall by range",
        low=0.0,
        high=1.0,
    )
    false_alarms_min: float = parameter(
        1e-3,
        "likelihood: a detector counts as firing at nothing at least this often",
        unit="per look",
        low=1e-9,
        high=1.0,
    )
    detection_floor: float = parameter(
        0.02,
        "f1: weight of a place far from a detection over one at it; from 1 / (the planner's confidence) "
        "upwards, one detection alone does not end a search that has only begun",
        low=1e-6,
        high=1.0,
    )
    f1_min: float = parameter(
        0.5, "f1: a detector's F1 counts as at least this; at 0.5 its silence says nothing", low=0.5, high=1.0
    )
    f1_max: float = parameter(0.99, "f1: a detector's F1 counts as at most this", low=0.5, high=0.999999)
    probability_floor: float = parameter(
        1e-6, "no place's probability falls below this part of 1/k", low=1e-12, high=0.1
    )
    detector_statistics_file: str = parameter(
        "",
        "JSON file of precision and recall per class, as `robustnav bench detection --statistics` writes "
        "it; empty: defaults",
    )

    learn_statistics: bool = parameter(
        True, "learn how good the detector is from finds that the dock or the person confirms or refutes"
    )
    learn_pseudo_count: float = parameter(
        5.0, "the statistics at the start are worth", unit="looks", low=0.1, high=10_000.0
    )
    online_statistics_file: str = parameter(
        "", "JSON file in which what was learnt is kept from run to run; empty: forgotten at the end"
    )

    min_translation_m: float = parameter(
        0.15,
        "a view counts when the robot is this far from every view that counted",
        unit="m",
        low=0.0,
        high=5.0,
    )
    min_rotation_rad: float = parameter(
        math.radians(15.0), "or turned this far from it", unit="rad", low=0.0, high=math.pi
    )
    max_speed_m_s: float = parameter(
        0.05, "a view counts only while the robot is slower than this", unit="m/s", low=0.0, high=10.0
    )
    max_turn_rad_s: float = parameter(
        0.05, "a view counts only while the robot turns slower than this", unit="rad/s", low=0.0, high=10.0
    )

    camera_height_m: float = parameter(
        1.1, "camera above the floor, to place detections", unit="m", low=0.05, high=3.0
    )
    camera_pitch_rad: float = parameter(
        0.26, "camera turned down by", unit="rad", low=-math.pi / 2, high=math.pi / 2
    )
