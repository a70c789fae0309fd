"""Which parameters of a recorded run were not at their defaults."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from types import MappingProxyType

from bags.manifest import Manifest, ParameterValue
from robustnav_msgs_py.parameters import specs

# By executable: where its parameters are declared. The manager's decide nothing about a search, and are
# declared where ROS is needed.
DECLARATIONS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "sim_bridge": ("sim_bridge.parameters", "SimParameters"),
        "detection": ("robustnav_nodes.detection.parameters", "DetectionParameters"),
        "belief": ("robustnav_nodes.belief.parameters", "BeliefParameters"),
        "planner": ("robustnav_nodes.planner.parameters", "PlannerParameters"),
        "dialogue": ("robustnav_nodes.dialogue.parameters", "DialogueParameters"),
        "simulated_user": ("robustnav_nodes.simulated_user.parameters", "SimulatedUserParameters"),
        "recorder": ("bags.parameters", "RecorderParameters"),
    }
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ChangedParameter:
    """A parameter of `node` that had another value than the one it has here by default."""

    node: str
    name: str
    value: ParameterValue
    default: ParameterValue


def changed_parameters(manifest: Manifest) -> tuple[ChangedParameter, ...]:
    """Parameters of nodes that are known here, as far as they differ from the defaults of this version."""
    found = []
    for node in manifest.nodes:
        defaults = _defaults(node.node.rpartition("/")[2])
        found += [
            ChangedParameter(node=node.node, name=item.name, value=item.value, default=defaults[item.name])
            for item in node.parameters
            if item.name in defaults and item.value != defaults[item.name]
        ]
    return tuple(found)


@cache
def _defaults(executable: str) -> Mapping[str, ParameterValue]:
    module, name = DECLARATIONS.get(executable, ("", ""))
    if not module:
        return {}
    try:
        declaration = getattr(import_module(module), name)
    except ImportError:  # a robot's machine need not have the simulator's package
        return {}
    return {
        spec.name: tuple(spec.default) if isinstance(spec.default, list) else spec.default
        for spec in specs(declaration)
    }
