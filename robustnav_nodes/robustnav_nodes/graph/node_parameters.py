"""Bind a declaration of parameters (robustnav_msgs_py.parameters) to a ROS node."""

from collections.abc import Callable
from typing import Generic, TypeVar

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.parameters import ParameterSpec, build, specs

P = TypeVar("P")


class NodeParameters(Generic[P]):
    """Declares a node's parameters and keeps their checked values in `values`, also when they change.

    Raises BadParameterError when the node was started with a value that does not fit.
    """

    def __init__(self, node: Node, declaration: type[P], changed: Callable[[P], None]) -> None:
        self._node = node
        self._declaration = declaration
        self._changed = changed
        self._given = node._parameter_overrides  # noqa: SLF001 - rclpy has no public reader of them
        self._specs = {spec.name: spec for spec in specs(declaration)}
        for spec in self._specs.values():
            self._declare(spec)
        self.values: P = self._read()
        node.add_on_set_parameters_callback(self._check)
        node.add_post_set_parameters_callback(self._update)

    def unknown_overrides(self) -> list[str]:
        """Names given at start-up (a YAML file, `-p`) that the node does not have: a slip of the pen."""
        return sorted(
            name
            for name in self._given
            if not self._node.has_parameter(name) and not name.startswith("qos_overrides.")
        )

    def _declare(self, spec: ParameterSpec) -> None:
        # dynamic typing lets `-p timeout_s:=1` through to `checked`, which makes it 1.0 or says why not
        descriptor = ParameterDescriptor(
            description=spec.full_description, additional_constraints=spec.range_text, dynamic_typing=True
        )
        if spec.low is not None and spec.high is not None:
            if spec.type is float:
                limits = FloatingPointRange(from_value=float(spec.low), to_value=float(spec.high))
                descriptor.floating_point_range = [limits]
            else:
                descriptor.integer_range = [
                    IntegerRange(from_value=int(spec.low), to_value=int(spec.high), step=1)
                ]
        given = self._given.get(spec.name)
        # rcl reads an empty list in a file as "not set"
        is_given = given is not None and given.value is not None
        if given is not None and is_given:
            spec.checked(given.value)  # a clearer sentence than rclpy's exception
        self._node.declare_parameter(spec.name, spec.default, descriptor, ignore_override=not is_given)

    def _read(self) -> P:
        return build(self._declaration, {name: self._node.get_parameter(name).value for name in self._specs})

    def _check(self, parameters: list[Parameter]) -> SetParametersResult:
        for item in parameters:
            if item.name in self._specs:
                try:
                    self._specs[item.name].checked(item.value)
                except BadParameterError as error:
                    return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _update(self, parameters: list[Parameter]) -> None:
        if any(item.name in self._specs for item in parameters):
            self.values = self._read()
            self._changed(self.values)
