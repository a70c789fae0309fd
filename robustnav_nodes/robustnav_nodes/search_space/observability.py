"""The observability table L: which pose of the graph has which candidate location in view."""

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadMapError, BadMessageError
from robustnav_msgs_py.values import Bool
from robustnav_nodes.search_space.camera_view import CameraView
from robustnav_nodes.search_space.compiled import compiled
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import PoseGraph
from robustnav_nodes.search_space.sight import look_from_all

Int32 = NDArray[np.int32]
Int64 = NDArray[np.int64]

_MB = 1_000_000
_BYTES_PER_SIGHT = 2 * np.dtype(np.int32).itemsize
_POSES_AT_ONCE = 1024  # one thread's turn: milliseconds to tenths of a second


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
        """From the candidates that each pose sees, ascending; there are `candidates` of them in all.

        Raises BadMessageError where the rows do not follow each other or name a candidate that is not there.
        """
        seen_start = np.asarray(seen_start, dtype=np.int64)
        seen = np.asarray(seen, dtype=np.int32)
        ends_fit = len(seen_start) > 0 and seen_start[0] == 0 and seen_start[-1] == len(seen)
        if not ends_fit or bool(np.any(np.diff(seen_start) < 0)):
            raise BadMessageError(
                f"the rows of an observability table must begin at 0, ascend and end at {len(seen)}, the "
                "number of its sights"
            )
        if len(seen) and not 0 <= int(seen.min()) <= int(seen.max()) < candidates:
            raise BadMessageError(
                f"an observability table of {candidates} candidate locations names candidates "
                f"{seen.min()} .. {seen.max()}; they count from 0"
            )
        seers_start, seers = _columns(seen_start, seen, candidates)
        return cls(seen_start=seen_start, seen=seen, seers_start=seers_start, seers=seers)

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

    def share_in_view(self) -> float:
        """Part of the candidates that a pose has in view on average, in 0..1."""
        return len(self.seen) / (self.poses * self.candidates)

    def seen_from_somewhere(self) -> Bool:
        """bool [k]: the candidates that at least one pose has in view."""
        return np.asarray(np.diff(self.seers_start) > 0, dtype=np.bool_)


def build_observability(
    view: CameraView, graph: PoseGraph, parameters: SearchSpaceParameters, *, threads: int | None = None
) -> Observability:
    """Look from every pose of `graph`, with as many threads as there are processors unless told otherwise.

    The table is the same whatever the number of threads. Raises BadMapError where it would be too large.
    """
    limit = parameters.max_observability_mb * _MB // _BYTES_PER_SIGHT
    count, seen = _look_in_turns(view, graph, limit, threads or os.cpu_count() or 1)
    if len(seen) > limit:
        raise BadMapError(
            f"{len(graph)} poses x {len(view.candidates)} candidate locations hold more than "
            f"{limit} sights, more than max_observability_mb = {parameters.max_observability_mb} can hold: "
            "crop the map, raise spacing_m or candidate_size_m, or raise max_observability_mb"
        )
    seen_start = np.concatenate([[0], np.cumsum(count)])
    return Observability.of_rows(seen_start, seen, len(view.candidates))


def _look_in_turns(view: CameraView, graph: PoseGraph, limit: int, threads: int) -> tuple[Int64, Int32]:
    """What `look_from_all` says of the poses of `graph`, some at a time; stops soon after `limit`."""
    counts, seen, total = [], [], 0
    with ThreadPoolExecutor(threads, thread_name_prefix="look") as pool:
        turns = [
            pool.submit(look_from_all, view.scene, graph.x_m[i:j], graph.y_m[i:j], graph.yaw_rad[i:j], limit)
            for i, j in pairwise([*range(0, len(graph), _POSES_AT_ONCE), len(graph)])
        ]
        for turn in turns:
            count, of_these = turn.result()
            counts.append(count)
            seen.append(of_these)
            total += len(of_these)
            if total > limit:
                pool.shutdown(cancel_futures=True)
                break
    return np.concatenate(counts), np.concatenate(seen)


@compiled
def _columns(seen_start: Int64, seen: Int32, candidates: int) -> tuple[Int64, Int32]:
    """The other way round: where the seers of each candidate start (int64 [k + 1]), and which they are."""
    start = np.zeros(candidates + 1, dtype=np.int64)
    for j in seen:
        start[j + 1] += 1
    for j in range(candidates):
        start[j + 1] += start[j]
    seers = np.empty(len(seen), dtype=np.int32)
    filled = start[:-1].copy()
    for pose in range(len(seen_start) - 1):
        for at in range(seen_start[pose], seen_start[pose + 1]):
            j = seen[at]
            seers[filled[j]] = pose
            filled[j] += 1
    return start, seers
