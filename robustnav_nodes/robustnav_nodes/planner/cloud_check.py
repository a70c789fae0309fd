"""Whether a belief that was heard is about the planner's own map."""

import numpy as np

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import BeliefCloud
from robustnav_nodes.search_space.space import SearchSpace


def check_cloud(space: SearchSpace, cloud: BeliefCloud) -> None:
    """Raises BadMessageError where `cloud` is not about the candidates of `space`."""
    frame_id, position_m = space.frame_id, space.candidates.position_m
    if cloud.frame_id != frame_id:
        raise BadMessageError(
            f"the belief is in frame {cloud.frame_id!r}, the planner's map in {frame_id!r}: "
            "both nodes must hear the same map"
        )
    if cloud.position_m.shape != position_m.shape:
        raise BadMessageError(
            f"the belief is about {len(cloud.probability)} candidate locations, the planner's map has "
            f"{len(position_m)}: both nodes must hear the same map and mask and have the same parameters"
        )
    off_m = float(np.max(np.abs(cloud.position_m - position_m)))
    if off_m > 0.5 * space.candidates.size_m:
        raise BadMessageError(
            f"the belief's candidate locations lie up to {off_m:.2f} m from the planner's: "
            "both nodes must hear the same map and mask and have the same parameters"
        )
