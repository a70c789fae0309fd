"""The detection node with a back end that looks at pixels: latest image only, and it outlives bad input."""

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lifecycle_msgs.msg import State
from rclpy.parameter import Parameter

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.values import CameraModel, ColorImage, DepthImage, Float32
from robustnav_nodes.detection import node as detection_node
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.node import Detection
from tests.bench import Bench

S = 1_000_000_000
WIDTH, HEIGHT = 32, 24
MUG = np.array([[12.0, 8.0, 20.0, 16.0]], np.float32)


class Watchful:
    """Sees a mug in every image that is not black; waits for leave before it answers."""

    labels = ("mug",)

    def __init__(self) -> None:
        self.leave = threading.Semaphore(0)
        self.seen_ns: list[int] = []

    def detect(self, image: ColorImage) -> Boxes:
        self.seen_ns.append(image.stamp_ns)
        assert self.leave.acquire(timeout=20.0)
        count = int(image.pixels.max() > 0)
        scores = np.full(count, 0.9, np.float32)
        return Boxes(box_px=MUG[:count], score=scores, label=np.zeros(count, np.uint32))


def color(stamp_ns: int, *, width: int = WIDTH, value: int = 200) -> Any:
    pixels = np.full((HEIGHT, width, 3), value, np.uint8)
    return wire.color_to_message(ColorImage(pixels=pixels, stamp_ns=stamp_ns, frame_id="c"))


def depth(stamp_ns: int, value: float = 2.0) -> Any:
    image = DepthImage(depth_m=np.full((HEIGHT, WIDTH), value, np.float32), stamp_ns=stamp_ns, frame_id="c")
    return wire.depth_to_message(image)


def camera() -> Any:
    return wire.camera_to_message(CameraModel(width=WIDTH, height=HEIGHT, fx=28.0, fy=28.0, cx=15.5, cy=11.5))


class Scene:
    """A node whose back end is `detector`, and what it is shown."""

    def __init__(self, bench: Bench, **parameters: Any) -> None:
        chosen = {"back_end": "onnx", "load_again_s": 0.5} | parameters
        self.bench = bench
        overrides = [Parameter(name, value=value) for name, value in chosen.items()]
        self.node: Detection = bench.add(Detection(parameter_overrides=overrides))
        self.node.trigger_configure()
        self.node.trigger_activate()
        self.labels = bench.hear("detections/labels")
        self.heard = bench.hear("detections")
        self.topics = {
            name: bench.speaker(f"camera/{name}").publish
            for name in ("image_raw", "depth/image_raw", "camera_info")
        }

    def show(self, stamp_ns: int, *, with_color: Any = None, with_depth: Any = None) -> None:
        """One image, and wait until the node has it."""
        self.topics["image_raw"](with_color or color(stamp_ns))
        self.topics["depth/image_raw"](with_depth or depth(stamp_ns))
        done = self.node._images
        self.bench.wait(lambda: (done._done_ns or 0) >= stamp_ns, "the image")

    def give_camera(self) -> None:
        self.topics["camera_info"](camera())
        self.bench.wait(lambda: self.node._camera, "the camera")

    def said(self) -> list[tuple[int, int]]:
        """Stamp and number of detections, of all that was said."""
        values = map(wire.detections_from_message, self.heard)
        return [(value.stamp_ns, len(value)) for value in values]

    def figures(self) -> Any:
        return self.node.health.status("n", []).values

    def expect_problem(self, words: str) -> None:
        self.bench.wait(
            lambda: any(words in value for value in self.figures().values()),
            f"a problem that says {words!r}",
        )


@pytest.fixture
def detector(monkeypatch: pytest.MonkeyPatch) -> Iterator[Watchful]:
    made = Watchful()
    monkeypatch.setattr(detection_node, "make_detector", lambda _parameters: made)
    yield made
    for _ in range(100):
        made.leave.release()


def test_only_the_latest_image_is_looked_at_next(bench: Bench, detector: Watchful) -> None:
    """Of four images that come while the first is looked at, the last one is the next; three are dropped."""
    scene = Scene(bench)
    scene.give_camera()
    scene.show(S)
    bench.wait(lambda: detector.seen_ns, "the first look")
    for number in range(2, 6):
        scene.show(number * S)
    for _ in range(2):
        detector.leave.release()
    bench.wait(lambda: len(scene.heard) == 2, "two answers")
    assert scene.said() == [(S, 1), (5 * S, 1)]
    assert scene.figures()["images dropped while it looked"] == "3"
    assert {"latency ms, median", "latency ms, 95 %", "images a second"} <= scene.figures().keys()
    assert wire.labels_from_message(scene.labels[-1]) == ("mug",)


def test_the_rate_is_limited_by_stamps(bench: Bench, detector: Watchful) -> None:
    scene = Scene(bench, rate_max_hz=1.0)
    scene.give_camera()
    for number, stamp_ns in enumerate((S, S + S // 2, 2 * S, 2 * S + 1)):
        detector.leave.release()
        scene.show(stamp_ns)
        bench.wait(lambda seen=1 + number // 2: len(scene.heard) == seen, "an answer")
    assert [stamp for stamp, _ in scene.said()] == [S, 2 * S]
    assert scene.figures()["images left out for the rate"] == "2"


def test_a_low_score_is_dropped(bench: Bench, detector: Watchful) -> None:
    detector.leave.release()
    scene = Scene(bench, score_min=0.95)
    scene.give_camera()
    scene.show(S)
    bench.wait(lambda: scene.heard, "an answer")
    assert scene.said() == [(S, 0)]


def test_ground_truth_is_not_listened_to(bench: Bench, detector: Watchful) -> None:
    scene = Scene(bench)
    assert {"truth/visible", "truth/labels"}.isdisjoint(scene.node._waiting_for)


def test_bad_images_are_sentences_and_the_next_good_one_is_looked_at(
    bench: Bench, detector: Watchful
) -> None:
    for _ in range(9):
        detector.leave.release()
    scene = Scene(bench, image_wait=1)
    for stamp_ns in (1, 2):
        scene.show(stamp_ns)
    scene.expect_problem("no camera_info")
    scene.give_camera()
    scene.show(S, with_color=color(S, width=31))
    scene.expect_problem("31 x 24 pixels")
    scene.show(2 * S, with_color=color(2 * S, value=0))
    scene.expect_problem("black")
    scene.show(3 * S, with_depth=depth(3 * S, np.nan))
    scene.expect_problem("1 of 1 detections have no valid depth")
    scene.show(4 * S)
    bench.wait(lambda: (4 * S, 1) in scene.said(), "the mug")


def test_an_error_of_the_back_end_does_not_keep_the_next_image_waiting(
    bench: Bench, detector: Watchful, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = Scene(bench)
    scene.give_camera()
    fine = detector.detect
    monkeypatch.setattr(detector, "detect", lambda _image: 1 / 0)
    scene.show(S)
    scene.expect_problem("ZeroDivisionError")
    monkeypatch.setattr(detector, "detect", fine)
    detector.leave.release()
    scene.show(2 * S)
    bench.wait(lambda: scene.said() == [(2 * S, 1)], "the mug")


def test_a_missing_model_is_a_sentence_and_is_taken_when_it_comes(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "model.onnx"
    scene = Scene(bench, model=str(path), class_names=["mug"])
    scene.give_camera()
    scene.expect_problem("there is no")
    scene.show(S)
    assert not scene.heard
    made = Watchful()
    made.leave.release()
    monkeypatch.setattr(detection_node, "make_detector", lambda _parameters: made)
    bench.wait(lambda: scene.said() == [(S, 1)], "the image that waited")


class OfHeight:
    """Keeps what is as tall as it should be."""

    told = "the mug in the picture"

    def __init__(self) -> None:
        self.asked: list[tuple[list[float], float]] = []

    def kept(self, _image: ColorImage, boxes: Boxes, heights_m: Float32, likeness_min: float) -> Boxes:
        self.asked.append((heights_m.tolist(), likeness_min))
        return boxes[np.isclose(heights_m, 0.6, atol=0.2)]


def test_one_object_alone_is_reported_where_it_is_meant(
    bench: Bench, detector: Watchful, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a box of 8 px at a focal length of 28 px, 2 m away and 8 m away."""
    wanted = OfHeight()
    monkeypatch.setattr(detection_node, "make_instance", lambda *_: wanted)
    scene = Scene(bench, instance_likeness_min=0.5)
    scene.give_camera()
    for _ in range(3):
        detector.leave.release()
    for number, metres in enumerate((2.0, 8.0, float("nan")), start=1):
        scene.show(number * S, with_depth=depth(number * S, metres))
        bench.wait(lambda number=number: len(scene.heard) == number, "what was seen")
    assert scene.said() == [(S, 1), (2 * S, 0), (3 * S, 0)]
    (near,), (far,), (unknown,) = (heights_m for heights_m, _ in wanted.asked)
    assert near == pytest.approx(2.0 * 8 / 28, rel=0.1)
    assert far == pytest.approx(8.0 * 8 / 28, rel=0.1)
    assert np.isnan(unknown)
    assert {likeness_min for _, likeness_min in wanted.asked} == {0.5}
    assert scene.figures()["the one object that is meant"] == "the mug in the picture"


@pytest.mark.parametrize("back_end", ["truth", "onnx"])
def test_a_back_end_that_knows_no_instances_is_refused_one_at_once(bench: Bench, back_end: str) -> None:
    asked = {"back_end": back_end, "instance_picture": "mug.png"}
    node = bench.add(
        Detection(parameter_overrides=[Parameter(name, value=value) for name, value in asked.items()])
    )
    node.trigger_configure()
    assert node.state_id == State.PRIMARY_STATE_UNCONFIGURED
    told = node.health.status("n", []).values.values()
    assert any("cannot tell two objects of a class apart" in value for value in told)


def test_what_takes_configuring_says_so(bench: Bench, detector: Watchful) -> None:
    scene = Scene(bench)
    scene.node.set_parameters([Parameter("instance_class", value="mug")])
    scene.expect_problem("'mug' is used from the next time that the node is configured; until then it is ''")
