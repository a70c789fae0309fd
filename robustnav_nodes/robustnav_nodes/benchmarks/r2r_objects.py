"""From boxes in pictures to directions and positions: where the objects of a scan are.

Heading 0 is +y, clockwise positive, as in the Matterport3D simulator; 36 views of 640x480 px and 60 degrees
(vertically), every 30 degrees, looking down, level and up.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.r2r_sources import BoxedObject

WIDTH_PX, HEIGHT_PX, VIEW_RAD = 640, 480, math.radians(60.0)
STEP_RAD = math.radians(30.0)
ONE_RAY_M = 1.5
_FOCAL_PX = HEIGHT_PX / 2.0 / math.tan(VIEW_RAD / 2.0)
_PARALLEL = 0.05  # two rays 18 degrees apart


@dataclass(frozen=True, slots=True, kw_only=True)
class AngularBox:
    """Of an object as seen from a viewpoint: its middle, extents and solid angle, all in radians and sr."""

    heading_rad: float
    elevation_rad: float
    width_rad: float
    height_rad: float

    @property
    def size_sr(self) -> float:
        low, high = (self.elevation_rad + sign * self.height_rad / 2.0 for sign in (-1.0, 1.0))
        return self.width_rad * (math.sin(high) - math.sin(low))


@dataclass(frozen=True, slots=True, kw_only=True)
class Located:
    """Where an object is: by `tri`, `ray` or `near`, as the pack's README has it."""

    position_m: tuple[float, float, float]
    method: str
    residual_m: float | None


def angular_box(listed: BoxedObject) -> AngularBox | None:
    """The box around all boxes of an object, in angles; None without any."""
    if not listed.boxes:
        return None
    seen = [_directions(view, _edge_points(*box)) for view, box in listed.boxes]
    headings = np.sort(np.mod(np.concatenate([heading for heading, _ in seen]), math.tau))
    elevation = np.concatenate([elevation for _, elevation in seen])
    # All the way around, but for the widest gap between neighbours.
    gaps = np.diff(headings, append=headings[0] + math.tau)
    after = int(np.argmax(gaps))
    low, width = float(headings[(after + 1) % len(headings)]), math.tau - float(gaps[after])
    return AngularBox(
        heading_rad=(low + width / 2.0) % math.tau,
        elevation_rad=float(elevation.min() + elevation.max()) / 2.0,
        width_rad=width,
        height_rad=float(elevation.max() - elevation.min()),
    )


def locate(viewpoints: Sequence[tuple[Float64, AngularBox | None]]) -> Located:
    """Where an object is that these viewpoints list: `viewpoints` holds their positions and its boxes."""
    seen = [(origin, box) for origin, box in viewpoints if box is not None]
    if not seen:
        x, y, z = np.mean([origin for origin, _ in viewpoints], axis=0).tolist()
        return Located(position_m=(x, y, z), method="near", residual_m=None)
    origins = np.array([origin for origin, _ in seen])
    rays = np.array([direction(box.heading_rad, box.elevation_rad) for _, box in seen])
    across = np.eye(3) - rays[:, :, None] * rays[:, None, :]
    total = across.sum(axis=0)
    if len(seen) > 1 and np.linalg.eigvalsh(total)[0] > _PARALLEL:
        point = np.linalg.solve(total, (across @ origins[:, :, None]).sum(axis=0)[:, 0])
        misses = np.linalg.norm((across @ (point - origins)[:, :, None])[:, :, 0], axis=1)
        x, y, z = point.tolist()
        return Located(position_m=(x, y, z), method="tri", residual_m=float(misses.mean()))
    x, y, z = (origins[0] + ONE_RAY_M * rays[0]).tolist()
    return Located(position_m=(x, y, z), method="ray", residual_m=None)


def direction(heading_rad: float, elevation_rad: float) -> Float64:
    """Unit vector, [3]."""
    level = math.cos(elevation_rad)
    return np.array([math.sin(heading_rad) * level, math.cos(heading_rad) * level, math.sin(elevation_rad)])


def bearing(origin: Float64, position_m: Sequence[float]) -> tuple[float, float]:
    """Heading and elevation of a position as seen from `origin`."""
    x, y, z = np.subtract(position_m, origin).tolist()
    return math.atan2(x, y) % math.tau, math.atan2(z, math.hypot(x, y))


def _edge_points(x: float, y: float, width: float, height: float) -> Float64:
    """The middles of the four edges of a box, [4, 2] pixels: its corners reach too far in angles."""
    u, v = x + width / 2.0, y + height / 2.0
    return np.array([(x, v), (x + width, v), (u, y), (u, y + height)])


def _directions(view: int, pixels: Float64) -> tuple[Float64, Float64]:
    """Heading and elevation of pixels of a view."""
    heading, elevation = STEP_RAD * (view % 12), STEP_RAD * (view // 12 - 1)
    right = (pixels[:, 0] - WIDTH_PX / 2.0) / _FOCAL_PX
    up = (HEIGHT_PX / 2.0 - pixels[:, 1]) / _FOCAL_PX
    ahead = math.cos(elevation) - up * math.sin(elevation)
    height = math.sin(elevation) + up * math.cos(elevation)
    return heading + np.arctan2(right, ahead), np.arctan2(height, np.hypot(right, ahead))


def locate_all(
    positions: Mapping[str, Float64], listed: Mapping[str, Sequence[tuple[BoxedObject, AngularBox | None]]]
) -> dict[int, tuple[str, Located, int]]:
    """Name, place and number of views of each object of a scan, by its number."""
    views: dict[int, list[tuple[Float64, AngularBox | None]]] = {}
    names: dict[int, str] = {}
    for viewpoint, objects in listed.items():
        for item, box in objects:
            views.setdefault(item.number, []).append((positions[viewpoint], box))
            names.setdefault(item.number, item.name)
    return {number: (names[number], locate(views[number]), len(views[number])) for number in sorted(views)}
