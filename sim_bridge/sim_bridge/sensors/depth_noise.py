"""What a depth camera makes of perfect depth: noise that grows with the distance, steps, and holes.

Depth from triangulation is f b / disparity, so that an error in the disparity counts with the square of
depth: std = depth_noise z^2 (Khoshelham & Elberink 2012: 1.425e-3 z^2 m for the first Kinect, with steps of
2.85e-3 z^2 m; Nguyen, Izadi & Lovell 2012 fit 1.2 mm + 1.9e-3 (z - 0.4 m)^2 to it).
"""

import numpy as np

from robustnav_msgs_py.values import CameraModel, DepthImage, Float32
from sim_bridge.sensors.degradations import ImageDegradation
from sim_bridge.sensors.depth_holes import HoleMaker
from sim_bridge.sensors.frame_noise import frame_rng, normals

DEPTH_STREAM, HOLE_STREAM = 3, 4


class DepthSensor:
    """Makes of perfect depth images those of a worse camera. Immutable."""

    def __init__(self, degradation: ImageDegradation, model: CameraModel, seed: int) -> None:
        self._seed = seed
        self._noise_per_m = np.float32(degradation.depth_noise)
        self._step_per_m = np.float32(degradation.depth_step)
        self._holes = HoleMaker(model, degradation.depth_holes) if degradation.depth_holes > 0.0 else None

    def sensed(self, image: DepthImage, frame: int) -> DepthImage:
        """The image of frame number `frame` as this camera has it: same size, stamp and frame id.

        NaN and +Inf stay; NaN is also what is lost, and what noise would put behind the camera or the steps
        cannot tell from infinity.
        """
        depth_m = image.depth_m
        if self._noise_per_m > 0.0 or self._step_per_m > 0.0:
            depth_m = self._noisy(depth_m, frame)
        if self._holes is not None:
            lost = self._holes.lost(image.depth_m, frame_rng(self._seed, frame, HOLE_STREAM))
            depth_m = np.where(lost, np.float32(np.nan), depth_m)
        return DepthImage(depth_m=depth_m, stamp_ns=image.stamp_ns, frame_id=image.frame_id)

    def _noisy(self, depth_m: Float32, frame: int) -> Float32:
        finite = np.isfinite(depth_m)
        known_m = np.where(finite, depth_m, np.float32(1.0))
        if self._noise_per_m > 0.0:
            noise = normals(frame_rng(self._seed, frame, DEPTH_STREAM), depth_m.shape)
            noise *= self._noise_per_m
            noise *= known_m
            noise *= known_m
            known_m += noise
        if self._step_per_m > 0.0:
            known_m = self._stepped(known_m)
        known_m[known_m <= 0.0] = np.nan
        return np.where(finite, known_m, depth_m)

    def _stepped(self, depth_m: Float32) -> Float32:
        """Depth in whole steps of inverse depth; 0 where it is nearer to no step than to infinity."""
        nothing = np.zeros_like(depth_m)
        steps = np.divide(1.0 / self._step_per_m, depth_m, out=nothing, where=depth_m > 0.0)
        np.rint(steps, out=steps)
        steps *= self._step_per_m
        return np.divide(np.float32(1.0), steps, out=np.zeros_like(steps), where=steps > 0.0)
