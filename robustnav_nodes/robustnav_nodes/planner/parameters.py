"""What decides a search, on top of the search space that it shares with the belief."""

import math
from dataclasses import dataclass, replace

from robustnav_msgs_py.parameters import parameter
from robustnav_nodes.planner.pomcp_parameters import PomcpParameters
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

# The baselines, the thesis' four, and ours. BE: particles from the candidates not yet ruled out. PD: the
# belief ends the search, not one detection. belief: particles follow R. guided: rollouts go where R is.
VARIANTS = (
    "random",
    "greedy",
    "greedy_gain",
    "pomp",
    "pomp_be",
    "pomp_pd",
    "pomp_be_pd",
    "pomp_belief",
    "pomp_guided",
    "lookahead",
)


LEAST_RECALL = 0.01  # a planner that expects to detect nothing would go nowhere


@dataclass(frozen=True, kw_only=True)
class PlannerParameters(SearchSpaceParameters, PomcpParameters):
    """The planner's variant, its search, when a search ends, and docking."""

    variant: str = parameter("lookahead", "baseline, planner of the thesis, or ours", choices=VARIANTS)

    reward_seen: float = parameter(1000.0, "pomp...: reward for seeing the target", low=0.0, high=1e6)
    cost_step: float = parameter(
        1.0, "pomp...: cost of a step that does not show the target", low=0.0, high=1e6
    )
    cost_revisit: float = parameter(
        10.0, "pomp...: its cost where the pose was visited before", low=0.0, high=1e6
    )

    guidance: float = parameter(
        0.8, "pomp_guided: part of the rollouts' steps that go where the belief is", low=0.0, high=1.0
    )
    recall: float = parameter(
        0.6,
        "lookahead: how likely a target in view is detected, as far as planning goes",
        low=LEAST_RECALL,
        high=1.0,
    )
    detector_statistics_file: str = parameter(
        "",
        "lookahead: JSON file that tells recall per class instead, as the belief reads it; empty: as above",
    )
    goals: int = parameter(20, "lookahead: viewpoints tried for one decision", low=1, high=10_000)
    lookahead_steps: int = parameter(60, "lookahead: steps thought ahead", low=1, high=10_000)
    worth: str = parameter(
        "ratio",
        "lookahead: a find is worth the shortest way over the way taken, or discount ^ steps",
        choices=("ratio", "discount"),
    )

    ending: str = parameter(
        "variant",
        "what ends a search: a detection, a likely location in view, or that the target is likely in view; "
        "variant: as the variant is defined",
        choices=("variant", "detection", "location", "view"),
    )
    p_found: float = parameter(
        0.92, "view: the search ends where the target is in view with this probability", low=0.01, high=0.9999
    )
    views_to_commit: int = parameter(
        1, "location: views in which its probability must have risen", low=1, high=100
    )
    confidence: float = parameter(
        10.0,
        "location: the search ends where one in view is this many times as likely as 1/k",
        low=1.1,
        high=1e4,
    )
    tau_max: float = parameter(0.5, "location: and at this probability at the latest", low=0.01, high=0.999)
    max_steps: int = parameter(200, "steps after which the target counts as not found", low=1, high=100_000)

    reinvigoration_radius_m: float = parameter(
        0.5, "how far a new particle may lie from an old one (pomp, pomp_pd)", unit="m", low=0.0, high=10.0
    )

    dock: bool = parameter(True, "go up to the target at the end")
    docking_distance_m: float = parameter(
        1.2, "preferred distance from the target at the end", unit="m", low=0.1, high=5.0
    )
    confirm_at_dock: bool = parameter(
        True, "look once more at the end, and search on if the target is not likely to be there"
    )

    search_space_cache: bool = parameter(
        True, "keep what sees what of large maps on disk, in the user's cache folder"
    )
    seed: int = parameter(1, "decides the simulations", low=0, high=2**31 - 1)
    arrival_distance_m: float = parameter(
        0.06, "a goal is reached within this distance", unit="m", low=0.005, high=1.0
    )
    arrival_turn_rad: float = parameter(0.1, "and within this turn", unit="rad", low=0.005, high=math.pi)
    standing_m_s: float = parameter(0.02, "the robot stands below this speed", unit="m/s", low=0.0, high=1.0)
    standing_rad_s: float = parameter(0.02, "and below this turning speed", unit="rad/s", low=0.0, high=1.0)
    drive_timeout_s: float = parameter(
        15.0, "a way that takes longer is blocked; longer ways in proportion", unit="s", low=1.0, high=600.0
    )
    goal_repeat_s: float = parameter(
        3.0, "an unreached goal is said again after", unit="s", low=0.5, high=600.0
    )
    look_timeout_s: float = parameter(
        10.0, "a belief that is silent for longer is reported", unit="s", low=0.5, high=600.0
    )
    settle_s: float = parameter(
        0.5, "of ROS time, between a new target and the first view that counts", unit="s", low=0.0, high=60.0
    )
    check_period_s: float = parameter(0.2, "how often time-outs are looked at", unit="s", low=0.02, high=10.0)


def with_recall(parameters: PlannerParameters, recall: float) -> PlannerParameters:
    """The same with this recall, LEAST_RECALL at least."""
    return replace(parameters, recall=min(max(recall, LEAST_RECALL), 1.0))
