"""The belief node: detections and poses in, where the target may be out."""

import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from std_msgs.msg import Float64

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.detector_statistics import DetectorStatistics, read_detector_statistics
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.frames import CameraMount, base_from_optical, map_from_base
from robustnav_msgs_py.pose_history import PoseHistory, check_frame
from robustnav_msgs_py.records import SearchState
from robustnav_msgs_py.values import OK, WARN, Detections, OccupancyMap, Odometry
from robustnav_nodes.belief.belief_map import belief_map
from robustnav_nodes.belief.learnt_statistics import LearntStatistics, read_observed, write_observed
from robustnav_nodes.belief.online_statistics import OnlineStatistics
from robustnav_nodes.belief.parameters import BeliefParameters
from robustnav_nodes.belief.search_lesson import SearchLesson
from robustnav_nodes.belief.tracker import BeliefTracker
from robustnav_nodes.belief.verdict import read_verdict
from robustnav_nodes.belief.view_gate import Verdict
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes
from robustnav_nodes.search_space.camera_view import CameraView, build_camera_view
from robustnav_nodes.search_space.floor_inputs import FloorInputs


class Belief(GraphNode[BeliefParameters]):
    """Keeps the belief about the target of the search.

    Hears `map`, `search/candidates`, `odom`, `search/target`, `detections`, `detections/labels` and, to
    learn how good the detector is, `search/state` and `search/facts`. Says `belief/cloud` after every
    observation, whether it counted or not: its stamp is that of the last observation looked at, which is how
    the planner knows that its view is in. Says `belief/map` and `belief/entropy` when the belief changed, and
    `belief/detector`, what it believes of the detector on the target's class, when that did. Serves
    `belief/get_map` and `~/reset`.

    A map that grows or changes takes over what is known; one in another frame, or time that begins anew, does
    not.
    """

    executable = "belief"
    declaration = BeliefParameters

    def configure(self) -> None:
        """Open the topics."""
        limits = self.parameters
        path = limits.detector_statistics_file
        assumed = read_detector_statistics(Path(path)) if path else DetectorStatistics()
        kept = limits.online_statistics_file
        self._learnt = LearntStatistics(
            assumed, limits.learn_pseudo_count, read_observed(Path(kept)) if kept else None
        )
        self._lesson: SearchLesson | None = None
        self._search = SearchState()
        self._floor = FloorInputs(limits.mask_wait_s)
        self._view: CameraView | None = None
        self._tracker: BeliefTracker | None = None
        self._poses = PoseHistory()
        self._labels: tuple[str, ...] = ()
        self._target = ""
        self._stamp_ns = 0
        self._builder = self.worker("search space")
        self._cloud = self.publisher("belief/cloud")
        self._map = self.publisher("belief/map")
        self._entropy = self.publisher("belief/entropy")
        self._detector = self.publisher("belief/detector")
        self.subscribe("map", wire.map_from_message, self._on_map)
        self.subscribe("search/candidates", wire.map_from_message, self._floor.heard_mask)
        self.subscribe("odom", wire.odometry_from_message, self._on_odometry)
        self.subscribe("search/target", wire.text_from_message, self._on_target)
        self.subscribe("detections/labels", wire.labels_from_message, self._on_labels)
        self.subscribe("detections", wire.detections_from_message, self._on_detections)
        if limits.learn_statistics:
            self.subscribe(
                "search/state", partial(wire.record_from_message, kind=SearchState), self._on_search
            )
            self.subscribe("search/facts", wire.text_from_message, self._on_fact)
        self.serve("belief/get_map", self._get_map)
        self.serve("~/reset", self._reset)
        self.every(limits.floor_check_s, self._build, steady=True)

    def _on_odometry(self, odometry: Odometry) -> None:
        if self._poses.add(odometry):
            self._start()  # simulated time began anew: what was observed belongs to another run
        if self._view is not None:
            check_frame(odometry, self._view.frame_id)

    def _on_map(self, floor_map: OccupancyMap) -> None:
        self._floor.heard_map(floor_map, self.steady_s())

    def _build(self) -> None:
        inputs = None if self._builder.busy else self._floor.take(self.steady_s())
        if inputs is not None:
            self._builder.submit(partial(build_camera_view, *inputs, self.parameters), self._on_view)

    def _on_view(self, view: CameraView) -> None:
        earlier, self._view = self._view, view
        self.health.figure("candidate locations", len(view.candidates))
        if self._tracker is None or earlier is None or earlier.frame_id != view.frame_id:
            self._start()
            return
        self._tracker.move_to(view)
        if self._lesson is not None:
            self._lesson.move_to(view.candidates)
        self._say_cloud()
        self._say_summary()

    def _on_target(self, target: str) -> None:
        if target.strip() != self._target:  # said again by a dialogue that was started again
            self._target = target.strip()
            self._start()

    def _on_labels(self, labels: tuple[str, ...]) -> None:
        self._labels = labels

    def _start(self) -> None:
        """A new belief for the target: nothing has been observed."""
        self._tracker = None
        if self._view is not None and self._target:
            self._tracker = BeliefTracker(
                view=self._view, statistics=self._learnt.of(self._target), parameters=self.parameters
            )
            self._lesson = SearchLesson(
                self._target, self._learnt.online(self._target), self._view.candidates
            )
            self._on_search(self._search)  # the planner may have heard of the target first
            self._stamp_ns = 0
            self._say_detector(self._target)
            self._say_cloud()
            self._say_summary()

    def _on_detections(self, detections: Detections) -> None:
        if self._tracker is None or not self._labels:
            return
        odometry = self._poses.at(detections.stamp_ns)
        if odometry is None:
            latest = self._poses.latest
            if latest is not None:
                raise BadMessageError(
                    f"detections of {detections.stamp_ns / wire.NANOSECONDS:.2f} s and the latest odometry "
                    f"of {latest.stamp_ns / wire.NANOSECONDS:.2f} s do not belong together: do both nodes "
                    "have the same clock (use_sim_time)?"
                )
            return
        if len(detections) and int(detections.label.max()) >= len(self._labels):
            raise BadMessageError(
                f"a detection has label {int(detections.label.max())}; detections/labels names only "
                f"{len(self._labels)} classes, counted from 0"
            )
        if self._target not in self._labels:
            raise BadMessageError(
                f"the target {self._target!r} is none of the detector's classes: {', '.join(self._labels)}"
            )
        of_target = np.array([self._labels[label] == self._target for label in detections.label], dtype=bool)
        mount = CameraMount(
            x_m=self.parameters.camera_forward_m,
            z_m=self.parameters.camera_height_m,
            pitch_rad=self.parameters.camera_pitch_rad,
        )
        places = map_from_base(odometry.pose, base_from_optical(mount, detections.position_m[of_target]))
        verdict = self._tracker.observe(
            odometry.pose,
            places,
            linear_m_s=odometry.linear_m_s,
            angular_rad_s=odometry.angular_rad_s,
        )
        self._stamp_ns = detections.stamp_ns
        look = self._tracker.last_look
        if verdict is Verdict.COUNTED and self._lesson is not None and look is not None:
            self._lesson.look(look)
        self.health.count(f"observations {verdict}")
        self._say_cloud()
        if verdict is Verdict.COUNTED:
            self._say_summary()

    def _on_search(self, search: SearchState) -> None:
        self._search = search
        if self._lesson is not None:
            self._learn(self._lesson.label, self._lesson.hear(search))

    def _on_fact(self, line: str) -> None:
        label, confirmed = read_verdict(line)
        if self._lesson is not None and self._lesson.label == label:
            self._learn(label, self._lesson.hear_person(confirmed=confirmed))

    def _learn(self, label: str, online: OnlineStatistics | None) -> None:
        """Believe this of the detector from the next search on."""
        if online is None:
            return
        self._learnt.learn(label, online)
        self._say_detector(label)
        kept = self.parameters.online_statistics_file
        if kept:
            write_observed(Path(kept), self._learnt.observed)

    def _say_detector(self, label: str) -> None:
        record, complaint = self._learnt.record(label), self._learnt.complaint(label)
        self._detector.publish(
            wire.record_to_message(record, level=WARN if complaint else OK, summary=complaint)
        )
        self.health.figure(f"detector, {label}", record.summary)
        if complaint:
            self.health.problem("detector statistics", complaint)

    def _say_cloud(self) -> None:
        if self._tracker is not None and self._view is not None:
            cloud = self._tracker.belief.cloud(self._stamp_ns, self._view.frame_id)
            self._cloud.publish(wire.belief_to_message(cloud))

    def _say_summary(self) -> None:
        if self._tracker is not None:
            entropy = self._tracker.belief.normalised_entropy()
            self._entropy.publish(Float64(data=entropy))
            self._map.publish(self._map_message())
            self.health.figure("entropy", entropy)

    def _map_message(self) -> Any:
        assert self._tracker is not None
        assert self._view is not None
        cloud = self._tracker.belief.cloud(self._stamp_ns, self._view.frame_id)
        return wire.map_to_message(belief_map(cloud, self._view.candidates.size_m))

    def _get_map(self, _request: Any, response: Any) -> Any:
        if self._tracker is not None:  # an empty map says that there is no belief yet
            response.map = self._map_message()
        return response

    def _reset(self, _request: Any, response: Any) -> Any:
        self._start()
        response.success = self._tracker is not None
        response.message = "" if response.success else "there is no target or no map yet"
        return response


def main() -> int:
    """Run the node until it is told to stop."""
    return run_nodes([Belief])


if __name__ == "__main__":
    sys.exit(main())
