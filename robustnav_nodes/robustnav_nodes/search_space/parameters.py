"""What decides the search space; the belief and the planner node declare these among their own."""

import math
from dataclasses import dataclass

from robustnav_msgs_py.parameters import parameter


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSpaceParameters:
    """Pose lattice, robot, camera, candidate locations and limits. Belief and planner must agree on them."""

    spacing_m: float = parameter(0.30, "distance between neighbouring poses", unit="m", low=0.05, high=2.0)
    headings: int = parameter(
        12, "headings of a pose, evenly spaced; a turn goes to the next", low=4, high=72
    )
    robot_radius_m: float = parameter(
        0.18, "radius of the circle that the robot needs", unit="m", low=0.0, high=2.0
    )

    horizontal_view_rad: float = parameter(
        math.radians(60.0), "camera's full horizontal angle of view", unit="rad", low=0.05, high=math.tau
    )
    range_min_m: float = parameter(
        0.8,
        "nearest distance at which objects are seen; nearer ones lie below the image",
        unit="m",
        low=0.0,
        high=5.0,
    )
    range_max_m: float = parameter(
        4.0, "farthest distance at which objects are seen", unit="m", low=0.2, high=30.0
    )
    camera_forward_m: float = parameter(
        0.1, "camera ahead of the robot's centre", unit="m", low=-1.0, high=1.0
    )

    candidate_size_m: float = parameter(
        0.20, "side of a candidate location; a finer mask is gathered into it", unit="m", low=0.02, high=2.0
    )
    candidate_fill: float = parameter(
        0.25, "part of a candidate location that the mask must cover", unit="of its area", low=0.0, high=1.0
    )
    occupied_threshold: int = parameter(65, "map cells from here up are occupied", low=1, high=100)
    free_threshold: int = parameter(25, "map cells from 0 up to here are free floor", low=0, high=99)

    max_start_distance_m: float = parameter(
        1.0, "farthest that the robot may start from a pose where it fits", unit="m", low=0.0, high=10.0
    )
    max_poses: int = parameter(250_000, "larger maps are refused", low=1, high=10_000_000)
    max_candidates: int = parameter(
        200_000, "maps with more candidate locations are refused", low=1, high=1_000_000
    )
    max_observability_mb: int = parameter(
        512, "larger observability tables are refused", unit="MB", low=1, high=16_384
    )

    mask_wait_s: float = parameter(
        3.0, "a map without a mask is used as it is after", unit="s", low=0.0, high=120.0
    )
    floor_check_s: float = parameter(0.1, "how often new maps are looked for", unit="s", low=0.01, high=10.0)
