"""Values go to messages and back unchanged, also through the wire; bad messages are refused."""

import dataclasses
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from rclpy.serialization import deserialize_message, serialize_message

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.records import Decision, DialogueState, Episode, SearchPhase, SearchState
from robustnav_msgs_py.values import (
    BeliefCloud,
    CameraModel,
    ColorImage,
    DepthImage,
    Detections,
    LaserScan,
    ObjectInstance,
    OccupancyMap,
    Odometry,
    Pose2D,
    StampedPose,
    Status,
    Velocity,
    VisibleObjects,
)

STAMPS = st.integers(0, 2**31 * 10**9 - 1)
NUMBERS = st.floats(-1e6, 1e6, allow_nan=False)
YAWS = st.floats(-math.pi, math.pi)
TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\x00"), max_size=30)


def same(first: Any, second: Any) -> bool:
    """Field by field; arrays element by element, NaN equal to NaN."""
    for item in dataclasses.fields(first):
        one, other = getattr(first, item.name), getattr(second, item.name)
        if isinstance(one, np.ndarray):
            if one.dtype != other.dtype or not np.array_equal(one, other, equal_nan=one.dtype.kind == "f"):
                return False
        elif dataclasses.is_dataclass(one):
            if not same(one, other):
                return False
        elif isinstance(one, float):
            if not math.isclose(one, other, rel_tol=1e-12, abs_tol=1e-12):
                return False
        elif one != other:
            return False
    return True


def through_the_wire(message: Any) -> Any:
    """What a subscriber in another process gets."""
    return deserialize_message(serialize_message(message), type(message))


def arrays(dtype: Any, *shape: int) -> st.SearchStrategy[Any]:
    kind = np.dtype(dtype).kind
    elements = st.floats(0, 1, width=32) if kind == "f" else None
    return hnp.arrays(dtype, shape, elements=elements)


@st.composite
def maps(draw: Any) -> OccupancyMap:
    shape = draw(st.tuples(st.integers(1, 12), st.integers(1, 12)))
    resolution = draw(st.sampled_from([0.05, 0.2, 0.1, 0.025, 1.0]))
    return OccupancyMap(
        cells=draw(hnp.arrays(np.int8, shape, elements=st.integers(-1, 100))),
        resolution_m=resolution,
        origin=Pose2D(x_m=draw(NUMBERS), y_m=draw(NUMBERS)),
        stamp_ns=draw(STAMPS),
    )


@st.composite
def color_images(draw: Any) -> ColorImage:
    size = draw(st.tuples(st.integers(1, 9), st.integers(1, 9)))
    return ColorImage(pixels=draw(arrays(np.uint8, *size, 3)), stamp_ns=draw(STAMPS), frame_id="c")


@st.composite
def depth_images(draw: Any) -> DepthImage:
    size = draw(st.tuples(st.integers(1, 9), st.integers(1, 9)))
    values = hnp.arrays(np.float32, size, elements=st.floats(width=32, allow_nan=True))
    return DepthImage(depth_m=draw(values), stamp_ns=draw(STAMPS), frame_id="c")


@st.composite
def detection_lists(draw: Any) -> Detections:
    count = draw(st.integers(0, 5))
    return Detections(
        position_m=draw(arrays(np.float32, count, 3)),
        score=draw(arrays(np.float32, count)),
        label=draw(hnp.arrays(np.uint32, count)),
        box_px=draw(arrays(np.float32, count, 4)),
        stamp_ns=draw(STAMPS),
    )


@st.composite
def visible_lists(draw: Any) -> VisibleObjects:
    count = draw(st.integers(0, 5))
    return VisibleObjects(
        position_m=draw(arrays(np.float32, count, 3)),
        label=draw(hnp.arrays(np.uint32, count)),
        instance=draw(hnp.arrays(np.uint32, count)),
        visible_fraction=draw(arrays(np.float32, count)),
        box_px=draw(arrays(np.float32, count, 4)),
        stamp_ns=draw(STAMPS),
    )


@st.composite
def beliefs(draw: Any) -> BeliefCloud:
    count = draw(st.integers(1, 20))
    weight = draw(hnp.arrays(np.float64, count, elements=st.floats(1e-6, 1.0)))
    return BeliefCloud(
        position_m=draw(arrays(np.float32, count, 3)),
        probability=weight / weight.sum(),
        stamp_ns=draw(STAMPS),
    )


POSES = st.builds(Pose2D, x_m=NUMBERS, y_m=NUMBERS, yaw_rad=YAWS)
PAIRS: dict[str, tuple[st.SearchStrategy[Any], Callable[[Any], Any], Callable[[Any], Any]]] = {
    "map": (maps(), wire.map_to_message, wire.map_from_message),
    "color": (color_images(), wire.color_to_message, wire.color_from_message),
    "depth": (depth_images(), wire.depth_to_message, wire.depth_from_message),
    "detections": (detection_lists(), wire.detections_to_message, wire.detections_from_message),
    "visible": (visible_lists(), wire.visible_to_message, wire.visible_from_message),
    "belief": (beliefs(), wire.belief_to_message, wire.belief_from_message),
    "pose": (
        st.builds(StampedPose, pose=POSES, stamp_ns=STAMPS),
        wire.pose_to_message,
        wire.pose_from_message,
    ),
    "odometry": (
        st.builds(Odometry, pose=POSES, linear_m_s=NUMBERS, angular_rad_s=NUMBERS, stamp_ns=STAMPS),
        wire.odometry_to_message,
        wire.odometry_from_message,
    ),
    "velocity": (
        st.builds(Velocity, linear_m_s=NUMBERS, angular_rad_s=NUMBERS),
        wire.velocity_to_message,
        wire.velocity_from_message,
    ),
    "camera": (
        st.builds(
            CameraModel,
            width=st.integers(1, 4000),
            height=st.integers(1, 4000),
            fx=st.floats(1, 1e4),
            fy=st.floats(1, 1e4),
            cx=NUMBERS,
            cy=NUMBERS,
            stamp_ns=STAMPS,
        ),
        wire.camera_to_message,
        wire.camera_from_message,
    ),
    "status": (
        st.builds(
            Status,
            name=TEXTS,
            level=st.integers(0, 3),
            message=TEXTS,
            hardware_id=TEXTS,
            values=st.dictionaries(TEXTS, TEXTS, max_size=4),
        ),
        wire.status_to_message,
        wire.status_from_message,
    ),
}


@pytest.mark.parametrize("name", sorted(PAIRS))
@given(data=st.data())
def test_a_value_comes_back_as_it_went(name: str, data: st.DataObject) -> None:
    strategy, to_message, from_message = PAIRS[name]
    value = data.draw(strategy)
    assert same(from_message(through_the_wire(to_message(value))), value)


@given(
    state=st.builds(
        SearchState,
        phase=st.sampled_from(SearchPhase),
        target=TEXTS,
        step=st.integers(0, 10**6),
        p_best=st.floats(0, 1),
        message=TEXTS,
    )
)
def test_a_search_state_comes_back_exactly(state: SearchState) -> None:
    message = through_the_wire(wire.record_to_message(state))
    assert wire.record_from_message(message, SearchState) == state


@given(values=st.lists(st.floats(-1e9, 1e9), max_size=4), visits=st.lists(st.integers(0, 10**6), max_size=4))
def test_a_decision_comes_back_exactly(values: list[float], visits: list[int]) -> None:
    decision = Decision(
        episode=1, step=2, planner="pomp", action="forward", actions=("forward", "turn left"),
        values=tuple(values), visits=tuple(visits), simulations=7, elapsed_ms=1.5, p_in_view=0.1, tau=0.2,
        entropy=0.3, x_m=1.0, y_m=2.0, yaw_rad=3.0, goal_x_m=4.0, goal_y_m=5.0, goal_yaw_rad=6.0, reason="ü",
    )  # fmt: skip
    message = through_the_wire(wire.record_to_message(decision, summary="a line"))
    assert wire.record_from_message(message, Decision) == decision


def test_other_records_come_back() -> None:
    episode = Episode(
        seed=3, home="h", rooms=("kitchen", "bath"), start_x_m=1.0, start_y_m=2.0, start_yaw_rad=0.1
    )
    assert wire.record_from_message(wire.record_to_message(episode), Episode) == episode
    talk = DialogueState(target="mug", last_heard="找到杯子")
    assert wire.record_from_message(wire.record_to_message(talk), DialogueState) == talk


def test_a_record_of_another_kind_or_with_a_hole_is_refused() -> None:
    message = wire.record_to_message(SearchState())
    with pytest.raises(BadMessageError, match="Decision"):
        wire.record_from_message(message, Decision)
    message.values = [pair for pair in message.values if pair.key != "step"]
    with pytest.raises(BadMessageError, match="step"):
        wire.record_from_message(message, SearchState)
    message = wire.record_to_message(SearchState())
    next(pair for pair in message.values if pair.key == "step").value = "three"
    with pytest.raises(BadMessageError, match="three"):
        wire.record_from_message(message, SearchState)


def test_objects_scans_paths_labels_and_text_come_back() -> None:
    objects = (
        ObjectInstance(
            instance=3, label="mug", x_m=1.0, y_m=2.0, z_m=0.8, yaw_rad=0.5, size_m=(0.1, 0.1, 0.2)
        ),
    )
    back = wire.objects_from_message(through_the_wire(wire.objects_to_message(objects)))
    assert all(same(one, other) for one, other in zip(objects, back, strict=True))
    scan = LaserScan(
        ranges_m=np.array([1.0, np.inf, 0.25], dtype=np.float32), angle_min_rad=-1.5, angle_step_rad=0.5,
        range_min_m=0.0625, range_max_m=8.0, stamp_ns=5, frame_id="laser",
    )  # fmt: skip
    assert same(wire.scan_from_message(through_the_wire(wire.scan_to_message(scan))), scan)
    path = (Pose2D(x_m=1.0, y_m=2.0, yaw_rad=0.25), Pose2D(x_m=-1.0, y_m=0.0, yaw_rad=-3.0))
    back_path = wire.path_from_message(through_the_wire(wire.path_to_message(path, 7)))
    assert all(same(one, other) for one, other in zip(path, back_path, strict=True))
    assert wire.labels_from_message(wire.labels_to_message(("mug", "coffee cup"))) == ("mug", "coffee cup")
    assert wire.labels_from_message(wire.text_to_message("")) == ()
    assert wire.text_from_message(wire.text_to_message("找")) == "找"


def test_a_bgr_image_with_padding_is_read_as_rgb() -> None:
    image = ColorImage(pixels=np.arange(18, dtype=np.uint8).reshape(2, 3, 3), stamp_ns=1, frame_id="c")
    message = wire.color_to_message(image)
    padded = np.zeros((2, 12), dtype=np.uint8)
    padded[:, :9] = image.pixels[:, :, ::-1].reshape(2, 9)
    message.encoding, message.step, message.data = "bgr8", 12, padded.tobytes()
    assert np.array_equal(wire.color_from_message(message).pixels, image.pixels)


def test_16_bit_depth_is_read_as_metres() -> None:
    message = wire.depth_to_message(DepthImage(depth_m=np.ones((1, 2), np.float32), stamp_ns=1, frame_id="c"))
    message.encoding, message.step, message.data = "16UC1", 4, np.array([0, 1500], dtype=np.uint16).tobytes()
    depth = wire.depth_from_message(message).depth_m
    assert np.isnan(depth[0, 0])
    assert depth[0, 1] == 1.5


def a_color_message() -> Any:
    return wire.color_to_message(ColorImage(pixels=np.zeros((4, 5, 3), np.uint8), stamp_ns=1, frame_id="c"))


@pytest.mark.parametrize(
    ("field", "value", "word"),
    [
        ("encoding", "yuv422", "yuv422"),
        ("encoding", "32FC1", "32FC1"),
        ("step", 3, "step 3"),
        ("height", 0, "nothing"),
        ("height", 400, "6000"),
        ("data", b"", "0 bytes"),
    ],
)
def test_a_bad_image_is_refused_with_what_is_wrong(field: str, value: Any, word: str) -> None:
    message = a_color_message()
    setattr(message, field, value)
    with pytest.raises(BadMessageError, match=word):
        wire.color_from_message(message)


def test_bad_maps_are_refused() -> None:
    good = OccupancyMap(cells=np.zeros((2, 3), np.int8), resolution_m=0.05, origin=Pose2D(x_m=0, y_m=0))
    message = wire.map_to_message(good)
    message.info.width = 0
    message.data = b""
    with pytest.raises(BadMessageError, match="0 x 2"):
        wire.map_from_message(message)
    message = wire.map_to_message(good)
    message.info.width = 7
    with pytest.raises(BadMessageError, match="7 x 2 cells has 6"):
        wire.map_from_message(message)
    message = wire.map_to_message(good)
    message.info.resolution = 0.0
    with pytest.raises(BadMessageError, match="resolution"):
        wire.map_from_message(message)
    message = wire.map_to_message(good)
    message.info.origin.orientation.z, message.info.origin.orientation.w = 1.0, 0.0
    with pytest.raises(BadMessageError, match="rotated"):
        wire.map_from_message(message)


def test_bad_clouds_are_refused() -> None:
    belief = BeliefCloud(
        position_m=np.zeros((2, 3), np.float32), probability=np.array([0.5, 0.5]), stamp_ns=1
    )
    message = wire.belief_to_message(belief)
    with pytest.raises(BadMessageError, match="score"):
        wire.detections_from_message(message)
    message.data = message.data[:-1]
    with pytest.raises(BadMessageError, match="bytes of data"):
        wire.belief_from_message(message)
    half = wire.belief_to_message(belief)
    half.data = half.data[: half.point_step]
    half.width = 1
    with pytest.raises(BadMessageError, match="sum to one"):
        wire.belief_from_message(half)


def test_bad_poses_and_cameras_are_refused() -> None:
    message = wire.pose_to_message(StampedPose(pose=Pose2D(x_m=0, y_m=0), stamp_ns=0))
    message.pose.orientation.w = 0.0
    with pytest.raises(BadMessageError, match="w = 1"):
        wire.pose_from_message(message)
    message.pose.orientation.w = 1.0
    message.pose.position.x = math.nan
    with pytest.raises(BadMessageError, match="finite"):
        wire.pose_from_message(message)
    twist = wire.velocity_to_message(Velocity(linear_m_s=0, angular_rad_s=0))
    twist.linear.x = math.inf
    with pytest.raises(BadMessageError, match="finite"):
        wire.velocity_from_message(twist)
    camera = wire.camera_to_message(CameraModel(width=4, height=3, fx=2, fy=2, cx=2, cy=1))
    camera.k[0] = 0.0
    with pytest.raises(BadMessageError, match="calibrated"):
        wire.camera_from_message(camera)


def test_labels_that_cannot_be_read_back_are_refused() -> None:
    with pytest.raises(BadMessageError, match="comma"):
        wire.labels_to_message(("mug, blue",))
