"""The detection node: bad images give a sentence, and the next good one is looked at."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.values import (
    CameraModel,
    ColorImage,
    DepthImage,
    Odometry,
    Pose2D,
    VisibleObjects,
)
from robustnav_nodes.detection.node import Detection
from tests.bench import Bench

S = 1_000_000_000
WIDTH, HEIGHT = 32, 24
TOPICS = (
    "camera/image_raw",
    "camera/depth/image_raw",
    "camera/camera_info",
    "odom",
    "truth/labels",
    "truth/visible",
)


def camera(width: int = WIDTH) -> CameraModel:
    return CameraModel(width=width, height=HEIGHT, fx=28.0, fy=28.0, cx=15.5, cy=11.5)


def color(stamp_ns: int) -> Any:
    image = ColorImage(pixels=np.zeros((HEIGHT, WIDTH, 3), np.uint8), stamp_ns=stamp_ns, frame_id="c")
    return wire.color_to_message(image)


def depth(stamp_ns: int, value: float = 2.0) -> Any:
    image = DepthImage(depth_m=np.full((HEIGHT, WIDTH), value, np.float32), stamp_ns=stamp_ns, frame_id="c")
    return wire.depth_to_message(image)


def a_mug(stamp_ns: int) -> Any:
    return wire.visible_to_message(
        VisibleObjects(
            position_m=np.array([[0.0, 0.0, 2.0]], np.float32),
            label=np.array([0], np.uint32),
            instance=np.array([0], np.uint32),
            visible_fraction=np.ones(1, np.float32),
            box_px=np.array([[12.0, 8.0, 20.0, 16.0]], np.float32),
            stamp_ns=stamp_ns,
        )
    )


class Scene:
    """A node with a perfect detector, and what it is shown."""

    def __init__(self, bench: Bench) -> None:
        from rclpy.parameter import Parameter

        perfect = [Parameter("recall", value=1.0), Parameter("precision", value=1.0)]
        self.bench = bench
        self.node: Detection = bench.add(Detection(parameter_overrides=perfect))
        self.node.trigger_configure()
        self.node.trigger_activate()
        self.detections = bench.hear("detections")
        self.say = {name: bench.speaker(name).publish for name in TOPICS}
        self.say["truth/labels"](wire.labels_to_message(("mug",)))
        self.say["camera/camera_info"](wire.camera_to_message(camera()))
        standing = Odometry(pose=Pose2D(x_m=0, y_m=0), linear_m_s=0, angular_rad_s=0, stamp_ns=S)
        self.say["odom"](wire.odometry_to_message(standing))
        bench.wait(lambda: not set(TOPICS[2:5]) & set(self.node._waiting_for), "the first inputs")

    def show(self, stamp_ns: int, message: Any) -> None:
        """One image with a mug in it."""
        self.say["camera/depth/image_raw"](message)
        self.say["truth/visible"](a_mug(stamp_ns))

    def expect_problem(self, words: str) -> None:
        def said() -> bool:
            return any(words in value for value in self.node.health.status("n", []).values.values())

        self.bench.wait(said, f"a problem that says {words!r}")

    def expect_mug(self, stamp_ns: int) -> None:
        self.show(stamp_ns, depth(stamp_ns))

        def seen() -> bool:
            last = wire.detections_from_message(self.detections[-1]) if self.detections else None
            return last is not None and (last.stamp_ns, len(last)) == (stamp_ns, 1)

        self.bench.wait(seen, "the mug")


@pytest.fixture
def scene(bench: Bench) -> Scene:
    return Scene(bench)


def wrong_encoding(message: Any) -> None:
    message.encoding = "bayer"


def wrong_step(message: Any) -> None:
    message.step = 5


def wrong_size(message: Any) -> None:
    message.height = 1000


@pytest.mark.parametrize(
    ("spoil", "words"), [(wrong_encoding, "bayer"), (wrong_step, "step 5"), (wrong_size, "bytes of data")]
)
def test_a_bad_image_is_a_sentence(scene: Scene, spoil: Callable[[Any], None], words: str) -> None:
    for topic, message in (("camera/image_raw", color(S)), ("camera/depth/image_raw", depth(S))):
        spoil(message)
        scene.say[topic](message)
        scene.expect_problem(words)
    scene.expect_mug(S + 1)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_depth_without_a_valid_value_drops_the_detection_and_says_so(scene: Scene, value: float) -> None:
    scene.show(S, depth(S, value))
    scene.expect_problem("1 of 1 detections have no valid depth")
    scene.bench.wait(lambda: scene.detections, "the empty detections")
    assert len(wire.detections_from_message(scene.detections[-1])) == 0
    scene.expect_mug(S + 1)


def test_a_camera_that_does_not_match_is_a_sentence(scene: Scene) -> None:
    scene.say["camera/camera_info"](wire.camera_to_message(camera(width=640)))
    scene.bench.wait(lambda: scene.node._camera is not None and scene.node._camera.width == 640, "the model")
    scene.show(S, depth(S))
    scene.expect_problem("640 x 24")
    scene.say["camera/camera_info"](wire.camera_to_message(camera()))
    scene.bench.wait(
        lambda: scene.node._camera is not None and scene.node._camera.width == WIDTH, "the model"
    )
    scene.expect_mug(S + 1)
