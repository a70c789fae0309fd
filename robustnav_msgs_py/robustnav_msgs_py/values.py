"""The values that capabilities hand to each other: frozen, keyword-only, checked when made.

Frames and units follow REP-103 and REP-105: SI units, x forward, y left, z up, yaw counter-clockwise;
optical frames have z forward, x right, y down. Depth follows REP-118: metres along the optical axis, NaN
where it is invalid, +Inf where nothing came back. Stamps are nanoseconds of ROS time.

Values that hold arrays compare by identity; compare their fields with numpy.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadMessageError

Float32 = NDArray[np.float32]
Float64 = NDArray[np.float64]
Bool = NDArray[np.bool_]


def _require(holds: bool, sentence: str) -> None:
    if not holds:
        raise BadMessageError(sentence)


@dataclass(frozen=True, slots=True, kw_only=True)
class Pose2D:
    """A place and a heading on the floor, in the frame its owner names (usually `map`)."""

    x_m: float
    y_m: float
    yaw_rad: float = 0.0

    def __post_init__(self) -> None:
        finite = math.isfinite(self.x_m) and math.isfinite(self.y_m) and math.isfinite(self.yaw_rad)
        _require(finite, f"a pose must be finite, not ({self.x_m!r}, {self.y_m!r}, {self.yaw_rad!r})")

    def distance_m(self, other: "Pose2D") -> float:
        """Straight-line distance to `other`, metres."""
        return math.hypot(other.x_m - self.x_m, other.y_m - self.y_m)

    def turn_rad(self, other: "Pose2D") -> float:
        """Smallest turn from this heading to the other's, in (-pi, pi]."""
        return -math.remainder(self.yaw_rad - other.yaw_rad, math.tau)


@dataclass(frozen=True, slots=True, kw_only=True)
class StampedPose:
    """A pose with its time and frame."""

    pose: Pose2D
    stamp_ns: int
    frame_id: str = "map"


@dataclass(frozen=True, slots=True, kw_only=True)
class Odometry:
    """Where the robot is (in `frame_id`) and how it moves (in its own frame)."""

    pose: Pose2D
    linear_m_s: float
    angular_rad_s: float
    stamp_ns: int
    frame_id: str = "map"
    child_frame_id: str = "base_link"


@dataclass(frozen=True, slots=True, kw_only=True)
class Velocity:
    """A command for a differential drive: forward (m/s) and counter-clockwise (rad/s)."""

    linear_m_s: float
    angular_rad_s: float

    def __post_init__(self) -> None:
        finite = math.isfinite(self.linear_m_s) and math.isfinite(self.angular_rad_s)
        _require(finite, f"a velocity must be finite, not ({self.linear_m_s!r}, {self.angular_rad_s!r})")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class OccupancyMap:
    """A grid of the floor: 0 free, 100 occupied, -1 unknown; row 0 lies at the origin, columns run along x.

    cells: int8 [height, width]; `origin` is the outer corner of cell (0, 0), always with yaw 0.
    """

    cells: NDArray[np.int8]
    resolution_m: float
    origin: Pose2D
    stamp_ns: int = 0
    frame_id: str = "map"

    def __post_init__(self) -> None:
        _require(self.cells.ndim == 2, f"a map has 2 dimensions, not {self.cells.ndim}")
        _require(self.cells.size > 0, f"a map needs cells; this one is {self.width} x {self.height}")
        _require(self.cells.dtype == np.int8, f"map cells are int8, not {self.cells.dtype}")
        resolution_fits = math.isfinite(self.resolution_m) and self.resolution_m > 0.0
        _require(resolution_fits, f"a map's resolution must be positive, not {self.resolution_m!r} m")
        _require(
            self.origin.yaw_rad == 0.0,
            f"a map must not be rotated; this one's origin has yaw {self.origin.yaw_rad!r} rad: "
            "publish it in a frame that is aligned with it",
        )

    @property
    def height(self) -> int:
        """Number of rows (along y)."""
        return int(self.cells.shape[0])

    @property
    def width(self) -> int:
        """Number of columns (along x)."""
        return int(self.cells.shape[1])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ColorImage:
    """An RGB image, uint8 [height, width, 3]."""

    pixels: NDArray[np.uint8]
    stamp_ns: int
    frame_id: str

    def __post_init__(self) -> None:
        shape = self.pixels.shape
        _require(len(shape) == 3 and shape[2] == 3, f"a colour image is [height, width, 3], not {shape}")
        _require(self.pixels.dtype == np.uint8, f"a colour image is uint8, not {self.pixels.dtype}")
        _require(self.pixels.size > 0, f"an image needs pixels; this one is {shape[1]} x {shape[0]}")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class DepthImage:
    """Depth along the optical axis in metres, float32 [height, width]; NaN invalid, +Inf no return."""

    depth_m: Float32
    stamp_ns: int
    frame_id: str

    def __post_init__(self) -> None:
        shape = self.depth_m.shape
        _require(len(shape) == 2, f"a depth image is [height, width], not {shape}")
        _require(self.depth_m.dtype == np.float32, f"depth is float32, not {self.depth_m.dtype}")
        _require(self.depth_m.size > 0, "a depth image needs pixels; this one has none")


@dataclass(frozen=True, slots=True, kw_only=True)
class CameraModel:
    """A pinhole camera without distortion; focal lengths and principal point in pixels."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    stamp_ns: int = 0
    frame_id: str = "camera_optical_frame"

    def __post_init__(self) -> None:
        _require(
            self.width > 0 and self.height > 0,
            f"a camera of {self.width} x {self.height} pixels sees nothing",
        )
        _require(
            self.fx > 0.0 and self.fy > 0.0,
            f"a camera's focal lengths must be positive, not {self.fx!r} and {self.fy!r}; is it calibrated?",
        )

    @property
    def horizontal_view_rad(self) -> float:
        """Full horizontal angle of view."""
        return 2.0 * math.atan(self.width / (2.0 * self.fx))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LaserScan:
    """Ranges (m) at angles that start at `angle_min_rad` and grow by `angle_step_rad`; +Inf no return."""

    ranges_m: Float32
    angle_min_rad: float
    angle_step_rad: float
    range_min_m: float
    range_max_m: float
    stamp_ns: int
    frame_id: str


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Detections:
    """What the detector says it saw in one image; n may be 0, which says that it saw nothing.

    position_m: float32 [n, 3] in the optical frame; score: float32 [n] in 0..1; label: uint32 [n], index
    into the detector's label names; box_px: float32 [n, 4] as u_min, v_min, u_max, v_max.
    """

    position_m: Float32
    score: Float32
    label: NDArray[np.uint32]
    box_px: Float32
    stamp_ns: int
    frame_id: str = "camera_optical_frame"

    def __post_init__(self) -> None:
        count = len(self.score)
        shapes = (self.position_m.shape, self.score.shape, self.label.shape, self.box_px.shape)
        expected = ((count, 3), (count,), (count,), (count, 4))
        _require(shapes == expected, f"detections have shapes {shapes}, expected {expected}")
        in_range = bool(np.all((self.score >= 0.0) & (self.score <= 1.0)))
        _require(in_range, "a detection's score must lie in 0..1")

    def __len__(self) -> int:
        return len(self.score)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class VisibleObjects:
    """Ground truth: the objects that one image shows, as a perfect observer would list them.

    position_m: float32 [n, 3], object centres in the optical frame; label and instance: uint32 [n];
    visible_fraction: float32 [n] in 0..1, the part of the object's own pixels that nothing hides;
    box_px: float32 [n, 4] around the visible pixels, as u_min, v_min, u_max, v_max.
    """

    position_m: Float32
    label: NDArray[np.uint32]
    instance: NDArray[np.uint32]
    visible_fraction: Float32
    box_px: Float32
    stamp_ns: int
    frame_id: str = "camera_optical_frame"

    def __post_init__(self) -> None:
        count = len(self.label)
        shapes = (
            self.position_m.shape,
            self.instance.shape,
            self.visible_fraction.shape,
            self.box_px.shape,
        )
        expected = ((count, 3), (count,), (count,), (count, 4))
        _require(shapes == expected, f"visible objects have shapes {shapes}, expected {expected}")

    def __len__(self) -> int:
        return len(self.label)


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectInstance:
    """Ground truth: one object of the home; the centre in `map`, the size along its own axes.

    `attributes` are what a person could say about it, by name: colour, material, pattern, size, what it
    stands on, room.
    """

    instance: int
    label: str
    x_m: float
    y_m: float
    z_m: float
    yaw_rad: float
    size_m: tuple[float, float, float]
    attributes: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BeliefCloud:
    """Where the target may be: k candidate locations in `map` and a probability each, summing to one.

    position_m: float32 [k, 3]; probability: float64 [k]. `stamp_ns` is the stamp of the last observation
    that was taken into account, so that a planner knows whether it was its latest view.
    """

    position_m: Float32
    probability: Float64
    stamp_ns: int
    frame_id: str = "map"

    def __post_init__(self) -> None:
        count = len(self.probability)
        _require(count > 0, "a belief needs at least one candidate location")
        _require(
            self.position_m.shape == (count, 3) and self.probability.shape == (count,),
            f"a belief has {self.position_m.shape} positions and {self.probability.shape} probabilities",
        )
        sound = bool(np.all(np.isfinite(self.probability)) and np.all(self.probability >= 0.0))
        _require(sound, "a belief's probabilities must be finite and not negative")
        total = float(self.probability.sum())
        _require(abs(total - 1.0) < 1e-6, f"a belief must sum to one, not {total!r}")


OK, WARN, ERROR, STALE = 0, 1, 2, 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Status:
    """A named state with a level (OK, WARN, ERROR, STALE), one line of text and key-value pairs."""

    name: str
    level: int = OK
    message: str = ""
    hardware_id: str = ""
    values: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        _require(self.level in (OK, WARN, ERROR, STALE), f"a status level is 0..3, not {self.level!r}")
