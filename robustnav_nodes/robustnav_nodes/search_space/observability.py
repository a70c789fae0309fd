"""The observability table L: which pose of the graph has which candidate location in view."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from robustnav_msgs_py.errors import BadMapError
from robustnav_msgs_py.values import Bool
from robustnav_nodes.search_space.camera_view import CameraView, look_from_all
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import PoseGraph

Int32 = NDArray[np.int32]
Int64 = NDArray[np.int64]

_MB = 1_000_000
_BYTES_PER_SIGHT = 2 * np.dtype(np.int32).itemsize


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observability:
    """Table L (thesis 3.2.1.3), l[i, j] = 1 where pose i has candidate j in view, kept sparse both ways.

    Pose i sees candidates seen[seen_start[i] : seen_start[i + 1]]; candidate j is seen by poses
    seers[seers_start[j] : seers_start[j + 1]]; both in ascending order.
    seen_start: int64 [n + 1]; seen: int32 [sights]; seers_start: int64 [k + 1]; seers: int32 [sights].
    """

    seen_start: Int64
    seen: Int32
    seers_start: Int64
    seers: Int32

    @classmethod
    def of_rows(cls, seen_start: Int64, seen: Int32, candidates: int) -> "Observability":
        """From the candidates that each pose sees, ascending; there are `candidates` of them in all."""
        shape = (len(seen_start) - 1, candidates)
        rows = sparse.csr_array((np.ones(len(seen), dtype=np.bool_), seen, seen_start), shape=shape)
        columns = rows.tocsc()
        return cls(
            seen_start=seen_start.astype(np.int64),
            seen=seen.astype(np.int32),
            seers_start=columns.indptr.astype(np.int64),
            seers=columns.indices.astype(np.int32),
        )

    @property
    def poses(self) -> int:
        """n."""
        return len(self.seen_start) - 1

    @property
    def candidates(self) -> int:
        """k."""
        return len(self.seers_start) - 1

    def seen_by(self, pose: int) -> Int32:
        """int32 [s]: the candidates that `pose` has in view."""
        return self.seen[self.seen_start[pose] : self.seen_start[pose + 1]]

    def seers_of(self, candidate: int) -> Int32:
        """int32 [s]: the poses that have `candidate` in view."""
        return self.seers[self.seers_start[candidate] : self.seers_start[candidate + 1]]

    def row(self, pose: int) -> Bool:
        """bool [k]: row `pose` of L."""
        row = np.zeros(self.candidates, dtype=np.bool_)
        row[self.seen_by(pose)] = True
        return row

    def column(self, candidate: int) -> Bool:
        """bool [n]: column `candidate` of L."""
        column = np.zeros(self.poses, dtype=np.bool_)
        column[self.seers_of(candidate)] = True
        return column

    def seen_from_somewhere(self) -> Bool:
        """bool [k]: the candidates that at least one pose has in view."""
        return np.asarray(np.diff(self.seers_start) > 0, dtype=np.bool_)


def build_observability(
    view: CameraView, graph: PoseGraph, parameters: SearchSpaceParameters
) -> Observability:
    """Look from every pose of `graph`. Raises BadMapError where the table would be too large."""
    limit = parameters.max_observability_mb * _MB // _BYTES_PER_SIGHT
    count, seen = look_from_all(view.scene, graph.x_m, graph.y_m, graph.yaw_rad, limit)
    if len(seen) > limit:
        raise BadMapError(
            f"{len(graph)} poses x {len(view.candidates)} candidate locations hold more than "
            f"{limit} sights, more than max_observability_mb = {parameters.max_observability_mb} can hold: "
            "crop the map, raise spacing_m or candidate_size_m, or raise max_observability_mb"
        )
    seen_start = np.concatenate([[0], np.cumsum(count)])
    return Observability.of_rows(seen_start, seen, len(view.candidates))
