"""The observability table L: which pose of the graph has which candidate location in view."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Bool
from robustnav_nodes.search_space.camera_view import CameraView, look_from_all
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import PoseGraph

_MB = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observability:
    """Table L (thesis 3.2.1.3), l[i, j] = 1 where pose i has candidate j in view, eight to a byte.

    bits: uint8 [n, ceil(k / 8)], candidate j is bit j % 8 of byte j // 8; candidates: k.
    """

    bits: NDArray[np.uint8]
    candidates: int

    def seen_from(self, pose: int) -> Bool:
        """bool [k]: row `pose` of L."""
        return np.unpackbits(self.bits[pose], count=self.candidates, bitorder="little").astype(np.bool_)

    def seers_of(self, candidate: int) -> Bool:
        """bool [n]: column `candidate` of L, the poses that have it in view."""
        return (self.bits[:, candidate // 8] >> (candidate % 8) & 1).astype(np.bool_)

    def seen_from_somewhere(self) -> Bool:
        """bool [k]: the candidates that at least one pose has in view."""
        union = np.bitwise_or.reduce(self.bits, axis=0)
        return np.unpackbits(union, count=self.candidates, bitorder="little").astype(np.bool_)


def build_observability(
    view: CameraView, graph: PoseGraph, parameters: SearchSpaceParameters
) -> Observability:
    """Look from every pose of `graph`. Raises BadMapError where the table would be too large."""
    poses, candidates = len(graph), len(view.candidates)
    width = (candidates + 7) // 8
    if poses * width > parameters.max_observability_mb * _MB:
        raise BadMapError(
            f"{poses} poses x {candidates} candidate locations need {poses * width / _MB:.0f} MB, more than "
            f"max_observability_mb = {parameters.max_observability_mb}: crop the map, raise spacing_m or "
            "candidate_size_m, or raise max_observability_mb"
        )
    bits = np.zeros((poses, width), dtype=np.uint8)
    look_from_all(view.scene, graph.x_m, graph.y_m, graph.yaw_rad, bits)
    return Observability(bits=bits, candidates=candidates)
