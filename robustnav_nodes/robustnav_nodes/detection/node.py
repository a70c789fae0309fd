"""The detection node: camera images in, detections out."""

import sys
import time

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.pose_history import PoseHistory
from robustnav_msgs_py.values import CameraModel, ColorImage, DepthImage, VisibleObjects
from robustnav_nodes.detection.dials import dials_by_class
from robustnav_nodes.detection.drawing import draw_boxes
from robustnav_nodes.detection.latest_images import ImageParts, LatestImages
from robustnav_nodes.detection.parameters import DetectionParameters
from robustnav_nodes.detection.placement import place_boxes
from robustnav_nodes.detection.truth_detector import TruthDetector
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes


class Detection(GraphNode[DetectionParameters]):
    """Says which objects each image shows, and where they are.

    Hears `camera/image_raw`, `camera/depth/image_raw`, `camera/camera_info`, `odom` and, for the `truth`
    back end, `truth/visible` and `truth/labels`. Says `detections` (also when it sees nothing: silence is
    evidence), `detections/labels` and, while somebody listens, `detections/boxes` and `detections/markers`.
    """

    executable = "detection"
    declaration = DetectionParameters

    def configure(self) -> None:
        """Open the topics."""
        self._images = LatestImages(self.parameters.image_wait)
        self._poses = PoseHistory()
        self._camera: CameraModel | None = None
        self._labels: tuple[str, ...] = ()
        self._detector: TruthDetector | None = None
        self._detections = self.publisher("detections")
        self._names = self.publisher("detections/labels")
        self._boxes = self.publisher("detections/boxes")
        self._markers = self.publisher("detections/markers")
        self.subscribe("camera/image_raw", wire.color_from_message, self._on_color)
        self.subscribe("camera/depth/image_raw", wire.depth_from_message, self._on_depth)
        self.subscribe("camera/camera_info", wire.camera_from_message, self._on_camera)
        self.subscribe("odom", wire.odometry_from_message, self._poses.add)
        self.subscribe("truth/labels", wire.labels_from_message, self._on_labels)
        self.subscribe("truth/visible", wire.visible_from_message, self._on_visible)

    def activate(self) -> None:
        """Say the class names again: a latched word said while inactive is lost."""
        if self._labels:
            self._names.publish(wire.labels_to_message(self._labels))

    def parameters_changed(self) -> None:
        """Turn the dials while it runs."""
        if self._labels:
            self._make_detector()

    def _on_camera(self, camera: CameraModel) -> None:
        self._camera = camera

    def _on_labels(self, labels: tuple[str, ...]) -> None:
        self._labels = labels
        self._make_detector()
        self._names.publish(wire.labels_to_message(labels))

    def _make_detector(self) -> None:
        self._detector = TruthDetector(
            labels=self._labels,
            dials=dials_by_class(self.parameters, self._labels),
            seed=self.parameters.seed,
            view_spacing_m=self.parameters.view_spacing_m,
            view_headings=self.parameters.view_headings,
        )

    def _on_color(self, image: ColorImage) -> None:
        self._look(self._images.add(image.stamp_ns, color=image))

    def _on_depth(self, image: DepthImage) -> None:
        self._look(self._images.add(image.stamp_ns, depth=image))

    def _on_visible(self, seen: VisibleObjects) -> None:
        self._look(self._images.add(seen.stamp_ns, seen=seen))

    def _look(self, parts: ImageParts | None) -> None:
        if parts is None or parts.seen is None or parts.depth is None:
            return
        odometry = self._poses.at(parts.stamp_ns)
        if self._detector is None or self._camera is None or odometry is None:
            return
        began_s = time.perf_counter()
        boxes = self._detector.detect(parts.seen, odometry.pose, self._camera)
        detections, dropped = place_boxes(
            boxes,
            parts.depth,
            self._camera,
            part=self.parameters.depth_part,
            samples_min=self.parameters.depth_samples_min,
        )
        if dropped:
            self.health.problem(
                "camera/depth/image_raw", f"{dropped} of {len(boxes)} detections have no valid depth; dropped"
            )
        self._detections.publish(wire.detections_to_message(detections))
        self.health.count("images")
        self.health.figure("objects in the last image", len(detections))
        self.health.figure("last image took ms", (time.perf_counter() - began_s) * 1e3)
        if self._markers.get_subscription_count():
            lifetime_s = self.parameters.marker_lifetime_s
            self._markers.publish(wire.detections_to_markers(detections, self._labels, lifetime_s))
        if parts.color is not None and self._boxes.get_subscription_count():
            self._boxes.publish(wire.color_to_message(draw_boxes(parts.color, detections, self._labels)))


def main() -> int:
    """Run the node until it is told to stop."""
    return run_nodes([Detection])


if __name__ == "__main__":
    sys.exit(main())
