"""The belief about one target of a scene, fed by what its detector ever says."""

import numpy as np

from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.belief.evidence import evidence_of
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.benchmarks.search_scene import DetectionRecord
from robustnav_nodes.search_space.space import SearchSpace


class RecordedBelief:
    """Follows one target through one search; the detector's word is taken once for each pose.

    prior: weights of the candidates before the first look, float64 [k]; None: all alike.
    """

    def __init__(
        self,
        space: SearchSpace,
        record: DetectionRecord,
        parameters: BeliefParameters,
        prior: Float64 | None = None,
    ) -> None:
        self._space = space
        self._record = record
        self._floor = parameters.probability_floor
        self._evidence = evidence_of(record.statistics, space.observability.share_in_view(), parameters)
        self._looked: Bool = np.zeros(len(space.graph), dtype=np.bool_)
        if prior is None:
            self._belief = LocationBelief.uniform(space.candidates)
        else:
            self._belief = LocationBelief.weighted(space.candidates, prior, 1.0 - self._floor)

    @property
    def probability(self) -> Float64:
        """R, float64 [k]."""
        return self._belief.probability

    def look(self, pose: int) -> None:
        """Take in what the detector says from `pose`, if it was not asked there before."""
        if self._looked[pose]:
            return
        self._looked[pose] = True
        observability = self._space.observability
        densities = self._record.at(pose, observability.candidates)
        factor = self._evidence.factor(observability.row(pose), densities)
        self._belief = self._belief.updated(factor, self._floor)
