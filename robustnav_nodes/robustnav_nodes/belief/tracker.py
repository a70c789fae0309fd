"""Follows one target: takes observations, judges which count, and keeps the belief."""

import numpy as np

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import Float64, Pose2D
from robustnav_nodes.belief.evidence import evidence_of
from robustnav_nodes.belief.location_belief import LocationBelief
from robustnav_nodes.belief.observation import place_densities
from robustnav_nodes.belief.online_statistics import CountedLook
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.belief.view_gate import Verdict, ViewGate
from robustnav_nodes.search_space.camera_view import CameraView


class BeliefTracker:
    """The belief about one target from the first observation to the last. Used from one thread.

    `statistics` are the detector's for the target's class. Start a new tracker for a new target, or to
    forget every observation.

    prior: weights of the view's candidates before the first look, float64 [k] (see `prior`); None: all alike.
    """

    def __init__(
        self,
        *,
        view: CameraView,
        statistics: ClassStatistics,
        parameters: BeliefParameters,
        prior: Float64 | None = None,
    ) -> None:
        self._view = view
        self._parameters = parameters
        self._statistics = statistics
        self._evidence = evidence_of(statistics, view.share_in_view(), parameters)
        self._gate = ViewGate(parameters)
        self.last_look: CountedLook | None = None  # that counted
        if prior is None:
            self.belief = LocationBelief.uniform(view.candidates)
        else:  # C4: no location begins below the floor
            self.belief = LocationBelief.weighted(view.candidates, prior, 1.0 - parameters.probability_floor)

    def move_to(self, view: CameraView) -> None:
        """Go on with what is known on another view of the same floor, whose map has grown or changed."""
        self._view = view
        self._evidence = evidence_of(self._statistics, view.share_in_view(), self._parameters)
        self.belief = self.belief.carried_to(view.candidates)

    def observe(
        self,
        robot: Pose2D,
        detected_m: Float64,
        *,
        linear_m_s: float = 0.0,
        angular_rad_s: float = 0.0,
    ) -> Verdict:
        """Take one image's detections of the target into account, unless the view does not count.

        robot: its centre when the image was taken, in the map; detected_m: float [m, 2 or 3], places of the
        target's class in the map, m = 0 where the detector was silent; the speeds are the robot's. Raises
        BadMessageError where a place is not finite.
        """
        places = np.asarray(detected_m, dtype=np.float64)
        if places.size == 0:
            places = places.reshape(0, 2)
        if places.ndim != 2 or (len(places) > 0 and places.shape[1] not in (2, 3)):
            raise BadMessageError(f"detected places must be [m, 2] or [m, 3], not {places.shape}")
        if not np.isfinite(places).all():
            raise BadMessageError("a detected place is not finite; is the depth under its box valid?")
        verdict = self._gate.judge(robot, linear_m_s, angular_rad_s)
        if verdict is not Verdict.COUNTED:
            return verdict
        limits = self._parameters
        in_view = self._view.visible(robot)
        candidates = self._view.candidates
        densities = place_densities(candidates, in_view, places[:, :2], limits.detection_sigma_m)
        self.last_look = CountedLook(in_view=in_view, densities=densities)
        distance_m = np.hypot(candidates.x_m - robot.x_m, candidates.y_m - robot.y_m)
        factor = self._evidence.factor(in_view, densities, distance_m)
        self.belief = self.belief.updated(factor, limits.probability_floor)
        return verdict
