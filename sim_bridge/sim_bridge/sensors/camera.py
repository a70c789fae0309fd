"""The robot's RGB-D camera: its pinhole model, its place on the robot, and its pictures.

Pixel (u, v) is a point sample: column u, row v, the centre of the first at (0, 0), as ROS counts. PyBullet's
software renderer samples in just that way once the projection is moved by half a pixel.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
import pybullet
from numpy.typing import NDArray

from robustnav_msgs_py.frames import CameraMount, base_from_optical, map_from_base
from robustnav_msgs_py.values import CameraModel, ColorImage, DepthImage, Float64, Pose2D
from sim_bridge.sensors.world import NOTHING, World

OPTICAL_FRAME = "camera_optical_frame"
NEAR_M = 0.05
FAR_M = 30.0
LIGHT_DIRECTION = (0.5, -0.8, 1.2)
AMBIENT, DIFFUSE, SPECULAR = 0.74, 0.36, 0.03
# The renderer tells body and link in one number.
BODY_MASK = (1 << 24) - 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CameraFrame:
    """One picture: colour, depth and, for tests, the body number at each pixel (int32, NOTHING: none)."""

    color: ColorImage
    depth: DepthImage
    model: CameraModel
    bodies: NDArray[np.int32]


def camera_model(width: int, height: int, horizontal_view_rad: float, stamp_ns: int = 0) -> CameraModel:
    """A camera with square pixels that looks through the middle of its image."""
    focal_px = width / (2.0 * math.tan(horizontal_view_rad / 2.0))
    return CameraModel(
        width=width,
        height=height,
        fx=focal_px,
        fy=focal_px,
        cx=(width - 1) / 2.0,
        cy=(height - 1) / 2.0,
        stamp_ns=stamp_ns,
        frame_id=OPTICAL_FRAME,
    )


def map_from_optical(mount: CameraMount, pose: Pose2D, points_m: Float64) -> Float64:
    """Move points [n, 3] from the optical frame of a robot at `pose` to `map`."""
    return map_from_base(pose, base_from_optical(mount, points_m))


class Camera:
    """Takes pictures of one world. Same thread as the world."""

    def __init__(self, world: World, model: CameraModel, mount: CameraMount, range_m: float) -> None:
        self.model = model
        self.mount = mount
        self.range_m = range_m
        self._world = world
        self._projection = _projection(model)

    def take(self, pose: Pose2D, stamp_ns: int) -> CameraFrame:
        """Render what the robot sees from `pose`: some 10 to 20 ms at 320 x 240.

        Depth is +Inf beyond the camera's range and where the picture shows no surface.
        """
        eye, ahead, up = map_from_optical(
            self.mount, pose, np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
        )
        view = pybullet.computeViewMatrix(eye.tolist(), ahead.tolist(), (up - eye).tolist())
        model = self.model
        _, _, rgba, buffer, bodies = pybullet.getCameraImage(
            model.width,
            model.height,
            viewMatrix=view,
            projectionMatrix=self._projection,
            lightDirection=LIGHT_DIRECTION,
            lightAmbientCoeff=AMBIENT,
            lightDiffuseCoeff=DIFFUSE,
            lightSpecularCoeff=SPECULAR,
            shadow=0,
            renderer=pybullet.ER_TINY_RENDERER,
            physicsClientId=self._world.client,
        )
        shape = (model.height, model.width)
        pixels = np.ascontiguousarray(np.asarray(rgba, dtype=np.uint8).reshape(*shape, 4)[:, :, :3])
        bodies = np.asarray(bodies, dtype=np.int32).reshape(shape)
        bodies = np.where(bodies >= 0, bodies & BODY_MASK, NOTHING)
        depth_m = _metres(np.asarray(buffer, dtype=np.float64).reshape(shape))
        depth_m[(bodies == NOTHING) | (depth_m > self.range_m)] = np.inf
        return CameraFrame(
            color=ColorImage(pixels=pixels, stamp_ns=stamp_ns, frame_id=OPTICAL_FRAME),
            depth=DepthImage(depth_m=depth_m.astype(np.float32), stamp_ns=stamp_ns, frame_id=OPTICAL_FRAME),
            model=replace(model, stamp_ns=stamp_ns),
            bodies=bodies.astype(np.int32),
        )


def _metres(buffer: Float64) -> Float64:
    """Depth along the optical axis from the renderer's buffer, which counts 0..1 from near to far."""
    return FAR_M * NEAR_M / (FAR_M - (FAR_M - NEAR_M) * buffer)


def _projection(model: CameraModel) -> list[float]:
    """The projection that puts pixel samples where the model says.

    The renderer samples column u at u / width of the picture's width, and row v at (v + 1) / height of its
    height from the top (measured; the tests pin it).
    """
    left = -model.cx / model.fx
    right = (model.width - model.cx) / model.fx
    top = (model.cy + 1.0) / model.fy
    bottom = -(model.height - 1.0 - model.cy) / model.fy
    matrix: list[float] = pybullet.computeProjectionMatrix(
        left * NEAR_M, right * NEAR_M, bottom * NEAR_M, top * NEAR_M, NEAR_M, FAR_M
    )
    return matrix
