import itertools
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rclpy.serialization import serialize_message

from bags.definitions import message_definition
from bags.manifest import Manifest, NamedParameter, NodeParameters
from bags.offered_qos import OfferedQos
from bags.reader import open_bag
from bags.writer import BagWriter
from robustnav_msgs_py import contract, conversions
from robustnav_msgs_py.frames import CameraMount, base_from_map, optical_from_base
from robustnav_msgs_py.records import Decision, Episode, SearchPhase, SearchState
from robustnav_msgs_py.values import (
    BeliefCloud,
    ColorImage,
    DepthImage,
    Detections,
    ObjectInstance,
    OccupancyMap,
    Odometry,
    Pose2D,
    VisibleObjects,
)
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

PREFIXES = (Path(sys.prefix),)
BEGUN_NS = 1_790_000_000 * 10**9
STEP_NS = 500_000_000
LABELS = ("book", "bottle", "mug", "plant", "remote", "vase")
MOUNT = CameraMount()

MANIFEST = Manifest(
    version="0.1.0",
    wall_start_ns=BEGUN_NS,
    commit="0123456789abcdef0123456789abcdef01234567",
    seed=7,
    scene="flat (living room, kitchen, bedroom)",
    sim_start_ns=0,
    platform="Linux x86_64, Python 3.11.7",
    nodes=(
        NodeParameters(
            node="/detection",
            parameters=(
                NamedParameter(name="backend", value="truth"),
                NamedParameter(name="threshold", value=0.5),
                NamedParameter(name="classes", value=("mug", "plant")),
            ),
        ),
    ),
    silent_nodes=("/chat",),
)


@dataclass
class Talk:
    """Writes values on the contract's topics into a bag, one after the other, a millisecond apart."""

    writer: BagWriter
    namespace: str = ""
    now_ns: int = BEGUN_NS
    channels: dict[str, int] = field(default_factory=dict)

    def say(self, topic: str, message: Any) -> None:
        row = contract.topic(topic)
        if topic not in self.channels:
            name = topic if topic.startswith("/") else f"{self.namespace}/{topic}"
            offer = OfferedQos(
                durability="transient_local" if row.qos.latched else "volatile", history="unknown", depth=0
            )
            self.channels[topic] = self.writer.add_topic(
                name, message_definition(row.type, PREFIXES), [offer]
            )
        self.now_ns += 1_000_000
        self.writer.write(
            self.channels[topic],
            log_time_ns=self.now_ns,
            publish_time_ns=self.now_ns,
            data=serialize_message(message),
        )


@dataclass
class Flat:
    """A flat drawn by hand: rooms, furniture that can hold things, and things."""

    width_m: float
    height_m: float
    walls: Sequence[tuple[float, float, float, float]]
    furniture: Sequence[tuple[float, float, float, float]]
    objects: Sequence[ObjectInstance]
    resolution_m: float = 0.05

    @property
    def floor_map(self) -> OccupancyMap:
        return self._grid([*self.walls, *self.furniture])

    @property
    def mask(self) -> OccupancyMap:
        return self._grid(self.furniture)

    def _grid(self, boxes: Sequence[tuple[float, float, float, float]]) -> OccupancyMap:
        shape = (round(self.height_m / self.resolution_m), round(self.width_m / self.resolution_m))
        cells = np.zeros(shape, dtype=np.int8)
        for x0, y0, x1, y1 in boxes:
            rows = slice(round(y0 / self.resolution_m), round(y1 / self.resolution_m))
            columns = slice(round(x0 / self.resolution_m), round(x1 / self.resolution_m))
            cells[rows, columns] = 100
        return OccupancyMap(
            cells=cells, resolution_m=self.resolution_m, origin=Pose2D(x_m=0.0, y_m=0.0), stamp_ns=0
        )


def thing(instance: int, label: str, x_m: float, y_m: float) -> ObjectInstance:
    return ObjectInstance(
        instance=instance, label=label, x_m=x_m, y_m=y_m, z_m=0.8, yaw_rad=0.0, size_m=(0.1, 0.1, 0.1)
    )


def outer_walls(width_m: float, height_m: float) -> list[tuple[float, float, float, float]]:
    return [
        (0.0, 0.0, width_m, 0.1),
        (0.0, height_m - 0.1, width_m, height_m),
        (0.0, 0.0, 0.1, height_m),
        (width_m - 0.1, 0.0, width_m, height_m),
    ]


FLAT = Flat(
    width_m=9.0,
    height_m=6.5,
    walls=[
        *outer_walls(9.0, 6.5),
        (4.5, 0.0, 4.6, 2.2),
        (4.5, 3.2, 4.6, 6.5),
        (4.6, 3.6, 6.2, 3.7),
        (7.2, 3.6, 9.0, 3.7),
    ],
    furniture=[
        (0.3, 0.3, 2.3, 1.1),
        (1.2, 2.3, 2.4, 3.1),
        (0.2, 5.7, 2.6, 6.3),
        (3.6, 5.2, 4.4, 6.2),
        (5.0, 0.2, 8.7, 0.8),
        (6.2, 1.8, 7.4, 2.6),
        (6.6, 4.9, 8.8, 6.3),
        (4.7, 5.8, 5.6, 6.3),
    ],
    objects=[
        thing(1, "mug", 7.3, 0.5),
        thing(2, "book", 0.8, 0.7),
        thing(3, "vase", 1.8, 2.7),
        thing(4, "plant", 4.0, 5.7),
        thing(5, "bottle", 5.4, 0.5),
        thing(6, "book", 7.0, 5.4),
        thing(7, "remote", 2.0, 0.6),
        thing(8, "bottle", 6.8, 2.2),
        thing(9, "book", 5.1, 6.05),
        thing(10, "vase", 1.2, 6.0),
    ],
)


@dataclass
class Told:
    """How the search that is written went."""

    target: str = "mug"
    phase: SearchPhase = SearchPhase.FOUND
    ended_at: tuple[float, float] | None = None  # the target's place where None
    false_alarms: Sequence[tuple[int, float, float]] = ((6, 1.9, 2.6), (7, 1.9, 2.6), (14, 4.0, 5.6))
    waypoints: Sequence[Pose2D] = (
        Pose2D(x_m=1.2, y_m=4.2, yaw_rad=math.pi),
        Pose2D(x_m=3.0, y_m=1.8, yaw_rad=math.pi),
        Pose2D(x_m=3.3, y_m=4.5, yaw_rad=math.pi / 2),
        Pose2D(x_m=5.4, y_m=2.7, yaw_rad=0.0),
        Pose2D(x_m=6.6, y_m=3.0, yaw_rad=math.pi / 2),
        Pose2D(x_m=6.6, y_m=1.2, yaw_rad=-math.pi / 6),
    )

    @property
    def labels(self) -> tuple[str, ...]:
        return LABELS if self.target in LABELS else (*LABELS, self.target)


@dataclass
class Corridor:
    """A corridor with a shelf at its end, and a drive straight along it."""

    flat: Flat
    told: Told


CORRIDOR = Corridor(
    flat=Flat(
        width_m=6.5,
        height_m=1.2,
        walls=outer_walls(6.5, 1.2),
        furniture=[(5.8, 0.25, 6.2, 0.65)],
        objects=[thing(1, "mug", 5.85, 0.45)],
    ),
    told=Told(
        false_alarms=(),
        waypoints=(Pose2D(x_m=0.75, y_m=0.45), Pose2D(x_m=4.95, y_m=0.45)),  # 14 steps of 0.3 m
    ),
)


def write_search(talk: Talk, flat: Flat, told: Told) -> list[Pose2D]:
    """Write one search of `flat`; returns the poses at which the planner decided, the last included."""
    space = SearchSpace.build(flat.floor_map, flat.mask, SearchSpaceParameters(), told.waypoints[0])
    path = _way(space.graph, told.waypoints)
    talk.say("truth/episode", conversions.record_to_message(_episode(told.waypoints[0])))
    talk.say("map", conversions.map_to_message(flat.floor_map))
    talk.say("search/candidates", conversions.map_to_message(flat.mask))
    talk.say("truth/objects", conversions.objects_to_message(flat.objects))
    talk.say("truth/labels", conversions.labels_to_message(told.labels))
    talk.say("detections/labels", conversions.labels_to_message(told.labels))
    talk.say("search/target", conversions.text_to_message(told.target))
    talk.say("search/state", _state(told, SearchPhase.SEARCHING, 0))
    weights = np.ones(len(space.candidates))
    for step, index in enumerate(path):
        pose = space.graph.pose(index)
        stamp_ns = step * STEP_NS
        in_view = space.visible(pose)
        last = step == len(path) - 1
        for _ in range(3):  # a robot that stands tells its pose again and again
            talk.say("odom", conversions.odometry_to_message(_odometry(pose, stamp_ns)))
        visible = _visible(flat, told, space, pose, stamp_ns)
        talk.say("truth/visible", conversions.visible_to_message(visible))
        talk.say("detections", conversions.detections_to_message(_detections(visible, pose, told, step)))
        weights = _believe(weights, space, in_view, told, step, flat if last else None)
        belief = BeliefCloud(
            position_m=space.candidates.position_m, probability=weights / weights.sum(), stamp_ns=stamp_ns
        )
        talk.say("belief/cloud", conversions.belief_to_message(belief))
        if not last:
            goal = space.graph.pose(path[step + 1])
            talk.say("planner/decision", conversions.record_to_message(_decision(step, pose, goal)))
            talk.say("search/state", _state(told, SearchPhase.SEARCHING, step + 1))
        talk.now_ns += STEP_NS
    talk.say("search/state", _state(told, told.phase, len(path) - 1, flat))
    return [space.graph.pose(index) for index in path]


def _way(graph: PoseGraph, waypoints: Sequence[Pose2D]) -> list[int]:
    nodes = [graph.nearest(pose) for pose in waypoints]
    path = [nodes[0]]
    for begin, end in itertools.pairwise(nodes):
        path.extend((graph.shortest_path(begin, end) or ())[1:])
    return path


def _episode(start: Pose2D) -> Episode:
    return Episode(
        seed=7,
        home="flat",
        rooms=("living room", "kitchen"),
        start_x_m=start.x_m,
        start_y_m=start.y_m,
        start_yaw_rad=start.yaw_rad,
    )


def _odometry(pose: Pose2D, stamp_ns: int) -> Odometry:
    return Odometry(pose=pose, linear_m_s=0.0, angular_rad_s=0.0, stamp_ns=stamp_ns)


def _state(told: Told, phase: SearchPhase, step: int, flat: Flat | None = None) -> Any:
    target = next((o for o in flat.objects if o.label == told.target), None) if flat else None
    best_x_m, best_y_m = told.ended_at or ((target.x_m, target.y_m) if target else (0.0, 0.0))
    return conversions.record_to_message(
        SearchState(
            phase=phase,
            target=told.target,
            episode=1,
            step=step,
            max_steps=200,
            best_x_m=best_x_m,
            best_y_m=best_y_m,
        )
    )


def _decision(step: int, pose: Pose2D, goal: Pose2D) -> Decision:
    return Decision(
        episode=1,
        step=step,
        planner="be-pd",
        action="forward",
        actions=("forward", "turn left"),
        values=(1.0, 0.5),
        visits=(700, 324),
        simulations=1024,
        elapsed_ms=50.0,
        p_in_view=0.01,
        tau=0.05,
        entropy=0.9,
        x_m=pose.x_m,
        y_m=pose.y_m,
        yaw_rad=pose.yaw_rad,
        goal_x_m=goal.x_m,
        goal_y_m=goal.y_m,
        goal_yaw_rad=goal.yaw_rad,
    )


def _visible(flat: Flat, told: Told, space: SearchSpace, pose: Pose2D, stamp_ns: int) -> VisibleObjects:
    seen = [o for o in flat.objects if space.visible(pose)[_nearest(space, o.x_m, o.y_m)]]
    count = len(seen)
    return VisibleObjects(
        position_m=_optical(pose, [(o.x_m, o.y_m, o.z_m) for o in seen]),
        label=np.array([told.labels.index(o.label) for o in seen], dtype=np.uint32),
        instance=np.array([o.instance for o in seen], dtype=np.uint32),
        visible_fraction=np.ones(count, dtype=np.float32),
        box_px=np.zeros((count, 4), dtype=np.float32),
        stamp_ns=stamp_ns,
    )


def _detections(visible: VisibleObjects, pose: Pose2D, told: Told, step: int) -> Detections:
    false = [(x_m, y_m, 0.8) for at, x_m, y_m in told.false_alarms if at == step]
    count = len(visible) + len(false)
    target = [told.labels.index(told.target)] * len(false)
    return Detections(
        position_m=np.concatenate([visible.position_m, _optical(pose, false)]),
        score=np.full(count, 0.7, dtype=np.float32),
        label=np.array([*visible.label.tolist(), *target], dtype=np.uint32),
        box_px=np.zeros((count, 4), dtype=np.float32),
        stamp_ns=visible.stamp_ns,
    )


def _optical(pose: Pose2D, points_m: Sequence[tuple[float, float, float]]) -> Any:
    points = np.array(points_m, dtype=np.float64).reshape(-1, 3)
    return optical_from_base(MOUNT, base_from_map(pose, points)).astype(np.float32)


def _nearest(space: SearchSpace, x_m: float, y_m: float) -> int:
    return int(np.argmin(np.hypot(space.candidates.x_m - x_m, space.candidates.y_m - y_m)))


def _believe(weights: Any, space: SearchSpace, in_view: Any, told: Told, step: int, flat: Flat | None) -> Any:
    weights = np.where(in_view, weights * 0.45, weights)
    places = [(x_m, y_m, 3.0) for at, x_m, y_m in told.false_alarms if at == step]
    places += [(o.x_m, o.y_m, 400.0) for o in (flat.objects if flat else ()) if o.label == told.target]
    for x_m, y_m, gain in places:
        offset_m = np.hypot(space.candidates.x_m - x_m, space.candidates.y_m - y_m)
        weights = weights * (1.0 + gain * np.exp(-0.5 * (offset_m / 0.25) ** 2))
    return np.maximum(weights / weights.sum(), 1e-6)


@pytest.fixture(scope="session")
def manifest() -> Manifest:
    return MANIFEST


@pytest.fixture(scope="session")
def flat_map() -> OccupancyMap:
    return FLAT.floor_map


@pytest.fixture(scope="session")
def corridor() -> Corridor:
    return CORRIDOR


@pytest.fixture
def search_bag(tmp_path: Path) -> Callable[..., Path]:
    """Writes the bag of a search through a flat; `told` says how it goes."""
    numbers = itertools.count()

    def write(
        flat: Flat = FLAT, told: Told | None = None, *, namespace: str = "", chunk_bytes: int = 1024 * 1024
    ) -> Path:
        folder = tmp_path / f"search_{next(numbers)}"
        with BagWriter(folder, manifest=MANIFEST, chunk_bytes=chunk_bytes) as writer:
            write_search(Talk(writer, namespace), flat, told or Told())
        return folder

    return write


@pytest.fixture
def make_talk() -> Callable[..., Talk]:
    return Talk


@pytest.fixture
def talk_bag(tmp_path: Path) -> Callable[..., Path]:
    """Writes a bag in which a person says `lines` and the robot answers each, and nothing else happens."""

    def write(lines: Sequence[str], answers: Sequence[str] = ()) -> Path:
        folder = tmp_path / "talk"
        with BagWriter(folder, manifest=MANIFEST) as writer:
            talk = Talk(writer)
            for line in lines:
                talk.say("chat/from_user", conversions.text_to_message(line))
            for answer in answers:
                talk.say("chat/to_user", conversions.text_to_message(answer))
        return folder

    return write


@pytest.fixture
def picture_bag(tmp_path: Path, search_bag: Callable[..., Path]) -> Callable[..., Path]:
    """Writes a search with an image of noise before each decision, and depth with it."""

    def write(width: int, height: int, **options: Any) -> Path:
        folder = tmp_path / "pictures"
        rng = np.random.default_rng(3)
        with open_bag(search_bag()) as bag, BagWriter(folder, manifest=MANIFEST, **options) as writer:
            talk = Talk(writer)
            for raw in bag.raw_messages():
                if raw.topic == "/planner/decision":
                    talk.now_ns = raw.log_time_ns - 3_000_000
                    pixels = rng.integers(0, 256, (height, width, 3), dtype=np.uint8)
                    image = ColorImage(pixels=pixels, stamp_ns=0, frame_id="camera")
                    talk.say("camera/image_raw", conversions.color_to_message(image))
                    depth_m = rng.uniform(0.5, 4.0, (height, width)).astype(np.float32)
                    depth = DepthImage(depth_m=depth_m, stamp_ns=0, frame_id="camera")
                    talk.say("camera/depth/image_raw", conversions.depth_to_message(depth))
                if raw.topic not in talk.channels:
                    kind = message_definition(raw.type, PREFIXES)
                    talk.channels[raw.topic] = writer.add_topic(raw.topic, kind)
                writer.write(
                    talk.channels[raw.topic],
                    log_time_ns=raw.log_time_ns,
                    publish_time_ns=raw.publish_time_ns,
                    data=raw.data,
                )
        return folder

    return write
