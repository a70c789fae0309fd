"""What a colour sensor does to light: few photons, its own noise, a gain, and too few pixels.

With S the perfect picture's level (0..255, taken as proportional to light, as the renderer means it):

    light      L = g S                     g = (1 - darkness)^2
    photons    variance c g (1 - g) S      c = 255 / FULL_WELL_E levels per electron
    sensor     variance noise^2, and noise * FIXED_SHARE that is the same in every frame
    gain       A = min(1 / g, MAX_GAIN)    what auto-gain can make up for
    picture    A (L + the noise of photons and sensor), rounded and clipped to 0..255

The factor 1 - g leaves out the photon noise of full light, so that a darkness of 0 with a noise of 0 changes
nothing. Up to a darkness of 1 - 1 / sqrt(MAX_GAIN) = 0.65 the picture is as bright as before and grainier;
beyond, it gets darker. With a `image_downscale`, all of this happens in the small picture's pixels.
"""

import numpy as np

from robustnav_msgs_py.values import CameraModel, ColorImage, Float32
from sim_bridge.sensors.degradations import ImageDegradation
from sim_bridge.sensors.frame_noise import frame_rng, normals
from sim_bridge.sensors.resolution import Resolution

MAX_GAIN = 8.0
# Electrons in a pixel at level 255: a small camera's.
FULL_WELL_E = 4000.0
FIXED_SHARE = 0.25
WHITE_LEVEL = 255.0
CHANNELS = 3
# Noise is looked up by level in quarters of one: averaged areas lie between whole levels.
STEPS_PER_LEVEL = 4
COLOUR_STREAM, FIXED_STREAM = 1, 2
# The fixed pattern belongs to no frame; it is drawn as if for this one, in a stream of its own.
NO_FRAME = 0


def light_left(darkness: float) -> float:
    """The share g of the light that is there."""
    return (1.0 - darkness) ** 2


def auto_gain(darkness: float) -> float:
    """The gain A by which the sensor makes up for missing light."""
    light = light_left(darkness)
    return 1.0 / light if light * MAX_GAIN >= 1.0 else MAX_GAIN


def noise_levels(degradation: ImageDegradation, levels: Float32) -> Float32:
    """Standard deviation, from frame to frame, in the picture where the perfect one has `levels`."""
    light = light_left(degradation.darkness)
    photons = WHITE_LEVEL / FULL_WELL_E * light * (1.0 - light) * levels
    return np.asarray(auto_gain(degradation.darkness) * np.sqrt(photons + degradation.image_noise**2))


class ImageSensor:
    """Makes of perfect colour images those of a worse sensor. Immutable."""

    def __init__(self, degradation: ImageDegradation, model: CameraModel, seed: int) -> None:
        self._seed = seed
        self._is_noisy = degradation.darkness > 0.0 or degradation.image_noise > 0.0
        self._resolution = (
            Resolution(model.height, model.width, CHANNELS, degradation.image_downscale)
            if degradation.image_downscale > 1
            else None
        )
        gain = auto_gain(degradation.darkness)
        self._brightness = np.float32(gain * light_left(degradation.darkness))
        every_level = np.arange(WHITE_LEVEL * STEPS_PER_LEVEL + 1).astype(np.float32)
        every_level /= STEPS_PER_LEVEL
        self._noise_of_level = noise_levels(degradation, every_level).astype(np.float32)
        shape = self._resolution.shape if self._resolution else (model.height, model.width, CHANNELS)
        pattern = normals(frame_rng(seed, NO_FRAME, FIXED_STREAM), shape)
        self._pattern = pattern * np.float32(gain * degradation.image_noise * FIXED_SHARE)

    def sensed(self, image: ColorImage, frame: int) -> ColorImage:
        """The image of frame number `frame` as this sensor has it: same size, stamp and frame id."""
        if not self._is_noisy and self._resolution is None:
            return image
        if self._resolution is None:
            noise = self._noise_of_level[::STEPS_PER_LEVEL][image.pixels]
            levels = image.pixels.astype(np.float32)
        else:
            levels = self._resolution.shrunk(image.pixels)
            noise = self._noise_of_level[(levels * STEPS_PER_LEVEL).astype(np.intp)]
        if self._is_noisy:
            noise *= normals(frame_rng(self._seed, frame, COLOUR_STREAM), levels.shape)
            levels *= self._brightness
            levels += noise
            levels += self._pattern
        if self._resolution is not None:
            # The small picture clips before it is enlarged: it is what the sensor put out.
            np.clip(levels, 0.0, WHITE_LEVEL, out=levels)
            levels = self._resolution.enlarged(levels)
        np.rint(levels, out=levels)
        np.clip(levels, 0.0, WHITE_LEVEL, out=levels)
        return ColorImage(pixels=levels.astype(np.uint8), stamp_ns=image.stamp_ns, frame_id=image.frame_id)
