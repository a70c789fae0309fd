"""A whole run in lock-step: the nodes of a plan in this thread, as fast as the machine can."""

from collections.abc import Callable, Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.lifecycle import TransitionCallbackReturn
from rclpy.signals import SignalHandlerOptions

from robustnav_msgs_py.errors import GraphError
from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.lockstep import NS_PER_S, Lockstep, Said
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.one_process import node_class
from robustnav_nodes.graph.search_graph import RunPlan

# These serve processes; in one thread there is nothing to bring up, and what is said is handed over.
NOT_IN_LOCKSTEP = ("manager", "recorder")
# Who is up and who is down is no news where they all are one.
QUIET = ("--ros-args", "--log-level", "warn")
TURN_NS = NS_PER_S // 10


class LockstepRun:
    """The nodes of a plan, up and joined. Use it in a `with` statement, from one thread.

    `watch` is called with everything that is said. Nothing leaves this process.
    """

    def __init__(
        self, plan: RunPlan, parameter_files: tuple[Path, ...], watch: Callable[[Said], None]
    ) -> None:
        """Make the nodes. Raises RobustnavError where a parameter does not fit."""
        prepare_environment(local=True)
        self.lockstep = Lockstep(watch)
        self._context = Context()
        rclpy.init(args=list(QUIET), context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        arguments = ["--ros-args", *plan.arguments(parameter_files)]
        self.nodes: list[GraphNode[Any]] = []
        try:
            for row in plan.nodes:
                if row.executable not in NOT_IN_LOCKSTEP:
                    kind = node_class(row.package, row.executable)
                    self.nodes.append(
                        kind(wiring=self.lockstep.wiring, context=self._context, cli_args=arguments)
                    )
            self._bring_up()
        except BaseException:
            self.close()
            raise

    def run(self, is_over: Callable[[], bool], limit_s: float) -> bool:
        """Let simulated time pass until `is_over` (True), or until `limit_s` has passed (False)."""
        end_ns = self.lockstep.time_ns + round(limit_s * NS_PER_S)
        while not is_over():
            if self.lockstep.time_ns >= end_ns:
                return False
            self.lockstep.advance(self.lockstep.time_ns + TURN_NS)
        return True

    def parameters(self) -> Mapping[str, Mapping[str, Any]]:
        """Every node's parameters as it has them, by the node's full name."""
        return {
            node.get_fully_qualified_name(): {
                name: node.get_parameter(name).value for name in sorted(node.list_parameters([], 0).names)
            }
            for node in self.nodes
        }

    def close(self) -> None:
        """Take every node down, last one first."""
        for node in reversed(self.nodes):
            node.trigger_shutdown()
            self.lockstep.settle()
        for node in reversed(self.nodes):
            node.destroy_node()
        self.nodes.clear()
        rclpy.try_shutdown(context=self._context)

    def __enter__(self) -> "LockstepRun":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _bring_up(self) -> None:
        for change in ("configure", "activate"):
            for node in self.nodes:
                if getattr(node, f"trigger_{change}")() is not TransitionCallbackReturn.SUCCESS:
                    raise GraphError(f"{node.executable} could not {change}; its log says why")
                self.lockstep.settle()
