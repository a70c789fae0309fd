"""Which pixels a depth camera loses: those that its projector does not reach, then the faintest.

As with structured light: a projector beside the camera lights the scene. What a nearer thing hides from the
projector is lost in its shadow, which lies on one side of each edge. The rest sends back light as cos(angle
between ray and normal) / depth^2, times how bright the surface is there, of which the scene says nothing: it
is drawn, in blobs. The faintest pixels are lost until the wanted share is.
"""

import numpy as np

from robustnav_msgs_py.values import Bool, CameraModel, Float32
from sim_bridge.sensors.frame_noise import normals
from sim_bridge.sensors.resolution import Resolution

# The projector is this far to the camera's right: shadows lie to the left of near things.
BASELINE_M = 0.075
BLOB_PX = 8
# Spread of the logarithm of the surfaces' brightness.
BLOB_SPREAD = 0.7
# What a pixel in the shadow gets of the light: so little that shadows go first.
SHADOW_LIGHT = 1e-6


class HoleMaker:
    """Chooses the pixels that get lost. Immutable."""

    def __init__(self, model: CameraModel, share: float) -> None:
        self._share = share
        self._model = model
        self._blobs = Resolution(model.height, model.width, 1, BLOB_PX)
        self._column = np.arange(model.width, dtype=np.float32)
        x = (self._column - np.float32(model.cx)) / np.float32(model.fx)
        y = (np.arange(model.height, dtype=np.float32) - np.float32(model.cy)) / np.float32(model.fy)
        self._x, self._y = x[None, :], y[:, None]
        self._ray_squared = 1.0 + self._x**2 + self._y**2

    def lost(self, depth_m: Float32, rng: np.random.Generator) -> Bool:
        """Which pixels of a perfect depth image [height, width] are lost, bool.

        The share is of the pixels that have a finite depth; others are never lost.
        """
        finite = np.isfinite(depth_m)
        # A part of a pixel is lost in that part of the frames: small images meet the share too.
        count = int(self._share * np.count_nonzero(finite) + rng.random())
        if count == 0:
            return np.zeros(depth_m.shape, dtype=np.bool_)
        inverse = np.divide(1.0, depth_m, out=np.zeros_like(depth_m), where=finite)
        light = self._light(inverse, rng)
        np.copyto(light, np.inf, where=~finite)
        faintest = np.partition(light, count - 1, axis=None)[count - 1]
        return np.asarray((light <= faintest) & finite)

    def _light(self, inverse: Float32, rng: np.random.Generator) -> Float32:
        """The square of the light that comes back, float32 [height, width], in units of no importance.

        In the image of a plane, inverse depth w is linear: w = n . (x, y, 1) for the plane's normal n over
        its distance. So the cosine is w / (|n| |ray|), and the light w^3 / (|n| |ray|).
        """
        slope_x = _slope(inverse, axis=1) * np.float32(self._model.fx)
        slope_y = _slope(inverse, axis=0) * np.float32(self._model.fy)
        ahead = inverse - self._x * slope_x
        ahead -= self._y * slope_y
        normal_squared = slope_x * slope_x
        slope_y *= slope_y
        normal_squared += slope_y
        ahead *= ahead
        normal_squared += ahead
        normal_squared *= self._ray_squared
        cube = inverse * inverse
        cube *= inverse
        cube *= cube
        light: Float32 = np.divide(cube, normal_squared, out=cube, where=normal_squared > 0.0)
        light *= self._brightness(rng)
        np.multiply(light, np.float32(SHADOW_LIGHT), out=light, where=self._in_shadow(inverse))
        return light

    def _brightness(self, rng: np.random.Generator) -> Float32:
        """How bright surfaces are, squared: blobs of a few pixels, float32 [height, width]."""
        field = normals(rng, self._blobs.shape) * np.float32(2.0 * BLOB_SPREAD)
        return self._blobs.enlarged(np.exp(field))[:, :, 0]

    def _in_shadow(self, inverse: Float32) -> Bool:
        """What the projector does not reach: its own column of it is also that of something further right.

        The projector sees what the camera has in column u in its column u - fx baseline / depth. Without
        anything in between, these grow with u.
        """
        column = self._column - inverse * np.float32(self._model.fx * BASELINE_M)
        least = np.minimum.accumulate(column[:, ::-1], axis=1)[:, ::-1]
        return np.asarray(column > least)


def _slope(values: Float32, axis: int) -> Float32:
    """The difference to the next pixel; the last one has that of the one before it."""
    if values.shape[axis] == 1:
        return np.zeros_like(values)
    last = np.take(values, [-1], axis=axis) - np.take(values, [-2], axis=axis)
    return np.concatenate([np.diff(values, axis=axis), last], axis=axis)
