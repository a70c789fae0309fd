"""Ground truth: which objects the camera sees, how much of each, and where in the image.

No picture is rendered for it. For every object whose bounding box projects into the image, rays are sent
through a grid of the pixels in that projection. Where the ray meets the object alone (computed from its
primitives) the pixel is one that the object would cover; where nothing in the home stops the ray before
that point, the pixel shows it. The fraction is the share of the second among the first, within the image.
"""

from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.frames import CameraMount, base_from_map, optical_from_base
from robustnav_msgs_py.values import Bool, CameraModel, Float64, Pose2D, VisibleObjects
from sim_bridge.homes.home import Home, SmallObject
from sim_bridge.homes.shapes import first_hit_m
from sim_bridge.sensors.camera import OPTICAL_FRAME, map_from_optical
from sim_bridge.sensors.world import NOTHING, World

# At most this many rays along each axis of an object's projection: small objects get one per pixel.
RAYS_PER_AXIS = 32
# Rays end this far inside the object, so that they surely meet it when nothing else is in the way.
PROBE_M = 0.004
FIRST_LOOK, EVERY_RAY = 5, 1
NEAR_M = 0.05


@dataclass(slots=True)
class _Probe:
    """The rays at one object: pixels that it would cover, and where each ray meets it (`map`)."""

    thing: SmallObject
    pixels: Float64
    ends_m: Float64
    stride_px: Float64


class Observer:
    """A perfect observer behind the robot's camera. Same thread as the world."""

    def __init__(
        self, world: World, home: Home, model: CameraModel, mount: CameraMount, range_m: float
    ) -> None:
        self._world = world
        self._model = model
        self._mount = mount
        self._range_m = range_m
        self.look_at(home)

    def look_at(self, home: Home) -> None:
        """Objects are where this home has them."""
        self._home = home
        self._corners = {thing.instance: thing.corners_m() for thing in home.objects}
        self._centres = np.array([thing.centre_m for thing in home.objects]).reshape(-1, 3)
        self._label = {label: number for number, label in enumerate(home.labels)}

    def look(self, pose: Pose2D, stamp_ns: int) -> VisibleObjects:
        """What the camera sees from `pose`: objects of which at least one ray arrives, by instance.

        `box_px` surrounds the visible pixels, upper bounds exclusive; some 2 ms.
        """
        eye = map_from_optical(self._mount, pose, np.zeros((1, 3)))[0]
        found = (self._probe(thing, pose, eye) for thing in self._home.objects)
        probes = [probe for probe in found if probe is not None]
        seen = zip(probes, self._seen(probes, eye), strict=True)
        rows = [(probe, arrived) for probe, arrived in seen if arrived.any()]
        boxes = [_box(probe, arrived, self._model) for probe, arrived in rows]
        instances = np.array([probe.thing.instance for probe, _ in rows], dtype=np.uint32)
        centres = optical_from_base(self._mount, base_from_map(pose, self._centres[instances]))
        return VisibleObjects(
            position_m=centres.astype(np.float32),
            label=np.array([self._label[probe.thing.label] for probe, _ in rows], dtype=np.uint32),
            instance=instances,
            visible_fraction=np.array([arrived.mean() for _, arrived in rows], dtype=np.float32),
            box_px=np.array(boxes, dtype=np.float32).reshape(-1, 4),
            stamp_ns=stamp_ns,
            frame_id=OPTICAL_FRAME,
        )

    def _probe(self, thing: SmallObject, pose: Pose2D, eye: Float64) -> _Probe | None:
        """Rays through the object's projection; None where it is out of the image or the range."""
        corners = optical_from_base(self._mount, base_from_map(pose, self._corners[thing.instance]))
        depth = corners[:, 2]
        if depth.max() <= NEAR_M or depth.min() > self._range_m:
            return None
        model = self._model
        if depth.min() <= NEAR_M:
            low, high = np.zeros(2), np.array((model.width - 1.0, model.height - 1.0))
        else:
            u = model.cx + model.fx * corners[:, 0] / depth
            v = model.cy + model.fy * corners[:, 1] / depth
            low = np.ceil(np.maximum((u.min(), v.min()), 0.0))
            high = np.floor(np.minimum((u.max(), v.max()), (model.width - 1.0, model.height - 1.0)))
        if (low > high).any():
            return None
        stride_px = np.maximum(1.0, np.ceil((high - low + 1.0) / RAYS_PER_AXIS))
        columns, rows = (np.arange(low[axis], high[axis] + 1.0, stride_px[axis]) for axis in (0, 1))
        pixels = np.stack([axis.ravel() for axis in np.meshgrid(columns, rows)], axis=1)
        directions = self._directions(pose, pixels, eye)
        own_eye = _into(thing, eye[None] - (thing.x_m, thing.y_m, thing.z_m))[0]
        hit_m = first_hit_m(thing.parts, own_eye, _into(thing, directions))
        covered = np.isfinite(hit_m)
        if not covered.any():
            return None
        ends = eye + directions[covered] * (hit_m[covered] + PROBE_M)[:, None]
        return _Probe(thing=thing, pixels=pixels[covered], ends_m=ends, stride_px=stride_px)

    def _directions(self, pose: Pose2D, pixels: Float64, eye: Float64) -> Float64:
        """Unit directions in `map` of the rays through the pixels."""
        model = self._model
        x, y = (pixels[:, 0] - model.cx) / model.fx, (pixels[:, 1] - model.cy) / model.fy
        ahead = map_from_optical(self._mount, pose, np.stack([x, y, np.ones(len(x))], axis=1)) - eye
        return np.asarray(ahead / np.linalg.norm(ahead, axis=1, keepdims=True))

    def _seen(self, probes: list[_Probe], eye: Float64) -> list[Bool]:
        """For each probe, which of its rays arrive: bool [rays].

        A few rays of each go first: where all of them arrive, as is usual, the others are taken to arrive.
        """
        seen = self._arrivals(probes, eye, FIRST_LOOK)
        unsure = [at for at, arrived in enumerate(seen) if not arrived.all()]
        for at, arrived in zip(
            unsure, self._arrivals([probes[at] for at in unsure], eye, EVERY_RAY), strict=True
        ):
            seen[at] = arrived
        return [
            np.ones(len(probe.ends_m), dtype=np.bool_) if arrived.all() else arrived
            for probe, arrived in zip(probes, seen, strict=True)
        ]

    def _arrivals(self, probes: list[_Probe], eye: Float64, step: int) -> list[Bool]:
        """For each probe, whether every `step`-th of its rays arrives."""
        if not probes:
            return []
        picked = [probe.ends_m[::step] for probe in probes]
        counts = [len(ends) for ends in picked]
        ends = np.concatenate(picked)
        _, bodies = self._world.cast(np.broadcast_to(eye, ends.shape), ends)
        # Nothing met at all means that PyBullet's shape is a hair thinner there than ours: it is seen.
        met = np.array([self._world.instance_of.get(int(body), NOTHING) for body in bodies])
        arrived = np.repeat([probe.thing.instance for probe in probes], counts) == met
        return np.split(arrived | (bodies == NOTHING), np.cumsum(counts)[:-1])


def _into(thing: SmallObject, vectors: Float64) -> Float64:
    """Turn vectors [n, 3] of `map` into the object's frame."""
    cos, sin = np.cos(thing.yaw_rad), np.sin(thing.yaw_rad)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack([cos * x + sin * y, cos * y - sin * x, vectors[:, 2]], axis=1)


def _box(probe: _Probe, arrived: Bool, model: CameraModel) -> Float64:
    """The box around the pixels for which the arrived rays stand, within the image."""
    pixels = probe.pixels[arrived]
    spread = (probe.stride_px - 1.0) / 2.0
    box = np.concatenate([pixels.min(axis=0) - spread, pixels.max(axis=0) + spread + 1.0])
    return np.asarray(np.clip(box, 0.0, (model.width, model.height) * 2))
