"""All nodes of a run in this process and one executor: for tests and small computers."""

import sys
from pathlib import Path
from typing import Any

from robustnav_msgs_py.errors import GraphError
from robustnav_nodes.graph.executables import find_executable
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.search_graph import RunPlan
from robustnav_nodes.graph.spin import run_nodes


def node_class(package: str, executable: str) -> type[GraphNode[Any]]:
    """The node that an executable runs: the GraphNode of that name in its entry point's module."""
    main = find_executable(package, executable).load()
    for item in vars(sys.modules[main.__module__]).values():
        is_node = isinstance(item, type) and issubclass(item, GraphNode)
        if is_node and getattr(item, "executable", None) == executable:
            return item
    raise GraphError(f"{main.__module__} holds no GraphNode whose executable is {executable!r}")


def run_in_one_process(plan: RunPlan, parameter_files: tuple[Path, ...]) -> int:
    """Run until SIGINT or SIGTERM; returns the exit code."""
    classes = [node_class(row.package, row.executable) for row in plan.nodes]
    return run_nodes(classes, ["--ros-args", *plan.arguments(parameter_files)])
