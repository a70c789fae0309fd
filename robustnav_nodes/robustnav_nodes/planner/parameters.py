"""What decides a search, on top of the search space that it shares with the belief."""

import math
from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

# BE: particles from the candidates not yet ruled out. PD: the belief ends the search, not one detection.
VARIANTS = ("pomp", "pomp_be", "pomp_pd", "pomp_be_pd")


@dataclass(frozen=True, slots=True, kw_only=True)
class PlannerParameters(SearchSpaceParameters):
    """The planner's variant, POMCP, when a search ends, and docking."""

    variant: str = parameter("pomp_be_pd", "planner of the thesis or one of its parts", choices=VARIANTS)

    simulations: int = parameter(1024, "simulations for one decision", low=8, high=1_000_000)
    time_budget_s: float = parameter(
        2.0, "a decision is taken after this time with the simulations so far", unit="s", low=0.01, high=60.0
    )
    batch_simulations: int = parameter(128, "simulations between two looks at the clock", low=8, high=100_000)
    exploration: float = parameter(1000.0, "UCT constant, in units of reward", low=0.0, high=1e6)
    discount: float = parameter(0.97, "worth of a reward one step later", low=0.01, high=0.999999)
    max_depth: int = parameter(300, "steps of one simulation, tree and rollout together", low=1, high=10_000)
    reward_seen: float = parameter(1000.0, "reward for seeing the target", low=0.0, high=1e6)
    cost_step: float = parameter(1.0, "cost of a step that does not show the target", low=0.0, high=1e6)
    cost_revisit: float = parameter(10.0, "its cost where the pose was visited before", low=0.0, high=1e6)

    confidence: float = parameter(
        10.0,
        "the search ends where a location in view is this many times as likely as 1/k",
        low=1.1,
        high=1e4,
    )
    tau_max: float = parameter(0.5, "and at this probability at the latest", low=0.01, high=0.999)
    max_steps: int = parameter(200, "steps after which the target counts as not found", low=1, high=100_000)

    reinvigoration_radius_m: float = parameter(
        0.5, "how far a new particle may lie from an old one (pomp, pomp_pd)", unit="m", low=0.0, high=10.0
    )

    docking_distance_m: float = parameter(
        1.2, "preferred distance from the target at the end", unit="m", low=0.1, high=5.0
    )
    confirm_at_dock: bool = parameter(
        True, "look once more at the end, and search on if the target is not likely to be there"
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
