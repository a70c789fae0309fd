"""The detection node: camera images in, detections out."""

import sys
from dataclasses import dataclass
from functools import partial

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.pose_history import PoseHistory
from robustnav_msgs_py.values import CameraModel, ColorImage, DepthImage, Detections, VisibleObjects
from robustnav_nodes.detection.back_ends import check_instance, make_detector, make_instance
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.dials import dials_by_class
from robustnav_nodes.detection.drawing import draw_boxes
from robustnav_nodes.detection.image_complaints import check_registered, color_complaint, depth_complaint
from robustnav_nodes.detection.latest_images import ImageParts, LatestImages
from robustnav_nodes.detection.pace import Pace
from robustnav_nodes.detection.parameters import OF_THE_MAKING, TRUTH, DetectionParameters
from robustnav_nodes.detection.placement import heights_m, place_boxes
from robustnav_nodes.detection.truth_detector import TruthDetector
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Image:
    """A whole image, when it came (`steady_s`), and the camera that took it."""

    depth: DepthImage
    color: ColorImage | None
    camera: CameraModel
    came_s: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Waiting:
    """An image whose pixels are to be looked at."""

    image: _Image
    color: ColorImage


class _Looker:
    """The back end and, where one object alone is meant, what tells it from others; for the worker."""

    def __init__(self, parameters: DetectionParameters) -> None:
        """Takes seconds. Raises what `make_detector` and `make_instance` raise."""
        self._detector = make_detector(parameters)
        self._instance = make_instance(parameters, self._detector)
        self.labels = self._detector.labels

    @property
    def told(self) -> str:
        """Which one object is meant; '': any."""
        return "" if self._instance is None else self._instance.told

    def look(self, waiting: _Waiting, parameters: DetectionParameters) -> Boxes:
        """The boxes that are sure enough and, of the class of the one object that is meant, like it."""
        image, boxes = waiting.image, self._detector.detect(waiting.color).above(parameters.score_min)
        if self._instance is None:
            return boxes
        tall_m = heights_m(boxes, image.depth, image.camera, parameters)
        return self._instance.kept(waiting.color, boxes, tall_m, parameters.instance_likeness_min)


class Detection(GraphNode[DetectionParameters]):
    """Says which objects each image shows, and where they are.

    Hears `camera/image_raw`, `camera/depth/image_raw`, `camera/camera_info` and, for the `truth` back end,
    `odom`, `truth/visible` and `truth/labels`. Says `detections` (also when it sees nothing: silence is
    evidence), `detections/labels`, `detections/vision` where vision_msgs is installed and, while somebody
    listens, `detections/boxes` and `detections/markers`.

    A back end that looks at pixels is made, and looks, in a thread of its own. It gets the latest whole image
    when it is done with the one before; those in between are dropped and counted.
    """

    executable = "detection"
    declaration = DetectionParameters

    def configure(self) -> None:
        """Open the topics. Raises BadParameterError where the back end cannot tell one object from others."""
        self._by_truth = self.parameters.back_end == TRUTH
        check_instance(self.parameters)
        self._configured = self.parameters
        self._images = LatestImages(self.parameters.image_wait, by_color=not self._by_truth)
        self._poses = PoseHistory()
        self._camera: CameraModel | None = None
        self._labels: tuple[str, ...] = ()
        self._truth: TruthDetector | None = None
        self._looker: _Looker | None = None
        self._next: _Waiting | None = None
        self._looked_ns: int | None = None
        self._unplaced = 0
        self._pace = Pace()
        self._worker = self.worker("detector", failed=self._look_on)
        self._detections = self.publisher("detections")
        self._names = self.publisher("detections/labels")
        self._boxes = self.publisher("detections/boxes")
        self._markers = self.publisher("detections/markers")
        self._vision = self.publisher("detections/vision") if wire.vision_available() else None
        self.subscribe("camera/image_raw", wire.color_from_message, self._on_color)
        self.subscribe("camera/depth/image_raw", wire.depth_from_message, self._on_depth)
        self.subscribe("camera/camera_info", wire.camera_from_message, self._on_camera)
        if self._by_truth:
            self.subscribe("odom", wire.odometry_from_message, self._poses.add)
            self.subscribe("truth/labels", wire.labels_from_message, self._on_labels)
            self.subscribe("truth/visible", wire.visible_from_message, self._on_visible)
        else:
            self.every(self.parameters.load_again_s, self._load, steady=True)

    def activate(self) -> None:
        """Say the class names again (a latched word said while inactive is lost), and make the back end."""
        if self._labels:
            self._names.publish(wire.labels_to_message(self._labels))
        if not self._by_truth:
            self._load()

    def parameters_changed(self) -> None:
        """Turn the dials while it runs."""
        if self._labels and self._by_truth:
            self._make_truth()
        for name in OF_THE_MAKING:
            now, then = getattr(self.parameters, name), getattr(self._configured, name)
            if now != then:
                self.health.problem(
                    f"parameter {name}",
                    f"{now!r} is used from the next time that the node is configured; "
                    f"until then it is {then!r}",
                )

    def _on_camera(self, camera: CameraModel) -> None:
        self._camera = camera

    def _on_labels(self, labels: tuple[str, ...]) -> None:
        self._labels = labels
        self._make_truth()
        self._names.publish(wire.labels_to_message(labels))

    def _make_truth(self) -> None:
        self._truth = TruthDetector(
            labels=self._labels,
            dials=dials_by_class(self.parameters, self._labels),
            seed=self.parameters.seed,
            view_spacing_m=self.parameters.view_spacing_m,
            view_headings=self.parameters.view_headings,
        )

    def _load(self) -> None:
        """Make the back end, unless it is there: weights may come later, or a parameter be set right."""
        if self._looker is None and not self._worker.busy:
            self._worker.submit(partial(_Looker, self._configured), self._on_looker)

    def _on_looker(self, looker: _Looker) -> None:
        self._looker, self._labels = looker, looker.labels
        if looker.told:
            self.get_logger().info(f"one object is meant: {looker.told}")
            self.health.figure("the one object that is meant", looker.told)
        self._names.publish(wire.labels_to_message(looker.labels))
        self._look_on()

    def _on_color(self, image: ColorImage) -> None:
        self._take(self._images.add(image.stamp_ns, color=image))

    def _on_depth(self, image: DepthImage) -> None:
        self._take(self._images.add(image.stamp_ns, depth=image))

    def _on_visible(self, seen: VisibleObjects) -> None:
        self._take(self._images.add(seen.stamp_ns, seen=seen))

    def _take(self, parts: ImageParts | None) -> None:
        """A whole image, if it is one."""
        if parts is None:
            return
        if self._camera is None:
            self._unplaced += 1
            if self._unplaced > self.parameters.image_wait:  # the first few may be faster
                self.health.problem(
                    "camera/camera_info",
                    f"{self._unplaced} images have come and no camera_info, without which nothing can be "
                    "placed; does the camera's driver publish it?",
                )
            return
        if parts.depth is None:
            return
        image = _Image(depth=parts.depth, color=parts.color, camera=self._camera, came_s=self.steady_s())
        if parts.seen is not None:
            self._see(image, parts.seen)
        elif parts.color is not None:
            self._wait(image, parts.color)

    # By ground truth: at once.

    def _see(self, image: _Image, seen: VisibleObjects) -> None:
        odometry = self._poses.at(seen.stamp_ns)
        if self._truth is not None and odometry is not None:
            self._say(image, self._truth.detect(seen, odometry.pose, image.camera))

    # By the pixels: in the worker.

    def _wait(self, image: _Image, color: ColorImage) -> None:
        """The image is the next to be looked at; one that waited for the same is dropped."""
        check_registered(color, image.camera)
        complaint = color_complaint(color)
        if complaint:
            self.health.problem("camera/image_raw", complaint)
        stamp_ns, rate_hz = color.stamp_ns, self.parameters.rate_max_hz
        since_ns = None if self._looked_ns is None else stamp_ns - self._looked_ns
        if since_ns is not None and rate_hz > 0.0 and 0 <= since_ns < wire.NANOSECONDS / rate_hz:
            self.health.count("images left out for the rate")
            return
        if self._next is not None and self._looker is not None:
            self.health.count("images dropped while it looked")
        self._next = _Waiting(image=image, color=color)
        self._look_on()

    def _look_on(self) -> None:
        """Look at the image that waits, if there is one and the worker is free."""
        waiting, looker = self._next, self._looker
        if waiting is None or looker is None or self._worker.busy:
            return
        self._next, self._looked_ns = None, waiting.color.stamp_ns
        look = partial(looker.look, waiting, self.parameters)
        self._worker.submit(look, partial(self._on_boxes, waiting.image))

    def _on_boxes(self, image: _Image, boxes: Boxes) -> None:
        try:
            self._say(image, boxes)
        finally:  # a bad depth image must not keep the next one waiting
            self._look_on()

    # Words.

    def _say(self, image: _Image, boxes: Boxes) -> None:
        detections, dropped = place_boxes(boxes, image.depth, image.camera, self.parameters)
        complaint = depth_complaint(image.depth)
        if dropped:
            complaint = f"{dropped} of {len(boxes)} detections have no valid depth; dropped"
        if complaint:
            self.health.problem("camera/depth/image_raw", complaint)
        self._detections.publish(wire.detections_to_message(detections))
        if self._vision is not None:
            self._vision.publish(wire.detections_to_vision(detections, self._labels, image.camera))
        self._pace.add(image.came_s, self.steady_s())
        self.health.count("images")
        self.health.figure("objects in the last image", len(detections))
        for name, value in self._pace.figures().items():
            self.health.figure(name, value)
        self._draw(image, detections)

    def _draw(self, image: _Image, detections: Detections) -> None:
        """What is to be looked at, while somebody does."""
        if self._markers.get_subscription_count():
            lifetime_s = self.parameters.marker_lifetime_s
            self._markers.publish(wire.detections_to_markers(detections, self._labels, lifetime_s))
        if image.color is not None and self._boxes.get_subscription_count():
            self._boxes.publish(wire.color_to_message(draw_boxes(image.color, detections, self._labels)))


def main() -> int:
    """Run the node until it is told to stop."""
    return run_nodes([Detection])


if __name__ == "__main__":
    sys.exit(main())
