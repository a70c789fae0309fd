"""What counts in the metrics, and what of it a bag tells by itself."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from bags.manifest import Manifest
from robustnav_msgs_py.frames import CameraMount
from robustnav_msgs_py.parameters import build
from robustnav_nodes.search_space.parameters import SearchSpaceParameters

PLANNER, BELIEF = "planner", "belief"
# The belief's parameters that say how the camera sits on the robot.
MOUNT = {"x_m": "camera_forward_m", "z_m": "camera_height_m", "pitch_rad": "camera_pitch_rad"}


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricsSettings:
    """What counts.

    A search succeeds with the target in view within `success_distance_m` of the robot; a detection farther
    than `false_alarm_distance_m` from every true instance is false; moves below `noise_m` are noise.
    `mount` is how the camera sits on the robot, `space` where the robot can drive and what it can see.
    """

    success_distance_m: float = 2.0
    false_alarm_distance_m: float = 0.75
    noise_m: float = 0.02
    mount: CameraMount = field(default_factory=CameraMount)
    space: SearchSpaceParameters = field(default_factory=SearchSpaceParameters)


def settings_of(manifest: Manifest | None, namespace: str = "") -> MetricsSettings:
    """The settings with the camera and the search space of the run that `manifest` tells of.

    What it does not tell, of the robot in `namespace`, keeps its default. Raises BadParameterError where it
    tells a value that is out of range now.
    """
    planner = _parameters(manifest, f"{namespace}/{PLANNER}")
    belief = _parameters(manifest, f"{namespace}/{BELIEF}")
    known = {item.name for item in fields(SearchSpaceParameters)}
    space = build(SearchSpaceParameters, {name: value for name, value in planner.items() if name in known})
    mount = {part: float(belief[name]) for part, name in MOUNT.items() if name in belief}
    return MetricsSettings(mount=CameraMount(**mount), space=space)


def _parameters(manifest: Manifest | None, node: str) -> Mapping[str, Any]:
    for told in manifest.nodes if manifest else ():
        if told.node == node:
            return {parameter.name: parameter.value for parameter in told.parameters}
    return {}
