"""A place to search in, with what hides there, and everything a detector ever says about it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.search_space.space import SearchSpace

Sighting = tuple[int, NDArray[np.int32], Float64]  # a detection: its pose, candidates, and their weights


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DetectionRecord:
    """What the detector says about one target from each pose, fixed: a second look from a pose is the first.

    Detection i was made at pose pose[i] (ascending; a pose may have several, or none). It says that the
    target is near candidates candidate[start[i] : start[i + 1]], with densities weight[...], the largest 1.
    statistics: what is known of this detector beforehand, precision and recall for this target.
    pose: int32 [d]; start: int64 [d + 1]; candidate: int32 [w]; weight: float64 [w], positive.
    """

    statistics: ClassStatistics
    pose: NDArray[np.int32]
    start: NDArray[np.int64]
    candidate: NDArray[np.int32]
    weight: Float64

    @classmethod
    def of(cls, statistics: ClassStatistics, sightings: list[Sighting]) -> "DetectionRecord":
        """From detections in ascending order of their poses."""
        return cls(
            statistics=statistics,
            pose=np.array([pose for pose, _, _ in sightings], dtype=np.int32),
            start=np.cumsum([0, *(len(seen) for _, seen, _ in sightings)], dtype=np.int64),
            candidate=np.concatenate([np.zeros(0, np.int32), *(seen for _, seen, _ in sightings)]),
            weight=np.concatenate([np.zeros(0), *(weight for _, _, weight in sightings)]),
        )

    def at(self, pose: int, candidates: int) -> Float64:
        """float64 [m, candidates]: the densities of the m detections made at `pose`, 0 elsewhere."""
        first, last = np.searchsorted(self.pose, [pose, pose + 1])
        densities = np.zeros((last - first, candidates))
        for row, detection in enumerate(range(first, last)):
            span = slice(self.start[detection], self.start[detection + 1])
            densities[row, self.candidate[span]] = self.weight[span]
        return densities


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SearchTarget:
    """One thing to look for, from where it can be seen, and what each detector says about it.

    in_view: bool [n], the poses that have the target in view: a search that stops at one of them succeeded.
    destination: bool [n], the poses at which a search with docking should stop; None where nobody says.
    detections: by name of the detector, "perfect" or "noisy".
    """

    label: str
    in_view: Bool
    destination: Bool | None
    detections: dict[str, DetectionRecord]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SearchScene:
    """A place and its targets. `difficulty` is "easy", "medium", "hard", or the name of where it is from.

    starts: int32 [s], the poses where episodes begin; empty: anywhere.
    """

    name: str
    difficulty: str
    space: SearchSpace
    targets: tuple[SearchTarget, ...]
    starts: NDArray[np.int32]
