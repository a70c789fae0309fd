"""How bad the camera's pictures are: the parameters, and the settings that benchmarks compare.

The parts that do it each have a file: `motion_blur`, `image_noise`, `resolution`, `depth_noise`,
`depth_holes`; `degraded_camera` puts them together.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from robustnav_msgs_py.parameters import parameter, specs

# Khoshelham & Elberink, "Accuracy and Resolution of Kinect Depth Data for Indoor Mapping Applications",
# Sensors 12(2), 2012: depth from a disparity that is off by half a step and told in whole steps.
KINECT_NOISE_PER_M = 1.425e-3
KINECT_STEP_PER_M = 2.85e-3


@dataclass(frozen=True, slots=True, kw_only=True)
class ImageDegradation:
    """What is wrong with the camera; the defaults are a perfect one.

    The first four are about colour, the others about depth. Raises BadParameterError where a value is out
    of its range.
    """

    exposure_s: float = parameter(
        0.0, "the shutter is open this long: motion smears", unit="s", low=0.0, high=0.1
    )
    darkness: float = parameter(0.0, "light that is missing; 1: pitch dark", low=0.0, high=1.0)
    image_noise: float = parameter(
        0.0, "std of the sensor's noise before its gain, in 8-bit levels", low=0.0, high=30.0
    )
    image_downscale: int = parameter(
        1, "the picture is sharp for this many times fewer pixels", low=1, high=16
    )
    depth_noise: float = parameter(
        0.0, "std of depth at 1 m; it grows with the square of depth", unit="1/m", low=0.0, high=0.02
    )
    depth_step: float = parameter(
        0.0, "depth comes in steps of this inverse depth; 0: without steps", unit="1/m", low=0.0, high=0.02
    )
    depth_holes: float = parameter(0.0, "share of the depth pixels that are lost", low=0.0, high=1.0)

    def __post_init__(self) -> None:
        for spec in specs(ImageDegradation):
            spec.checked(getattr(self, spec.name))


DEGRADATIONS: Mapping[str, ImageDegradation] = MappingProxyType(
    {
        "none": ImageDegradation(),
        "blur": ImageDegradation(exposure_s=0.03),
        "dark": ImageDegradation(darkness=0.8, image_noise=1.0),
        "noise": ImageDegradation(
            image_noise=8.0, depth_noise=KINECT_NOISE_PER_M, depth_step=KINECT_STEP_PER_M
        ),
        "half resolution": ImageDegradation(image_downscale=2),
        "holes": ImageDegradation(depth_holes=0.2),
    }
)
