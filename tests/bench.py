"""Nodes in this process, and an executor that waits for what a test expects, never for time to pass."""

from collections.abc import Callable
from typing import Any

from rclpy.experimental import EventsExecutor
from rclpy.node import Node

from robustnav_msgs_py import contract
from robustnav_nodes.graph import qos
from robustnav_nodes.graph.message_class import message_class
from robustnav_nodes.graph.spin import Spinner

DEADLINE_S = 20.0


class Bench:
    """Nodes under test on one executor, and a plain node that talks to them from outside."""

    def __init__(self) -> None:
        self.spinner = Spinner(EventsExecutor())
        self.outside = Node("outside")
        self.nodes: list[Node] = []
        self.spinner.executor.add_node(self.outside)

    def add(self, node: Any) -> Any:
        """Take a node onto the executor."""
        self.nodes.append(node)
        self.spinner.executor.add_node(node)
        return node

    def wait(self, condition: Callable[[], Any], what: str, timeout_s: float = DEADLINE_S) -> None:
        """Spin until `condition` holds."""
        assert self.spinner.spin_until(condition, timeout_s), f"waited in vain for {what}"

    def call(self, service_type: Any, name: str, request: Any) -> Any:
        """Call a service and wait for the answer."""
        client = self.outside.create_client(service_type, name)
        self.wait(client.service_is_ready, name)
        future = client.call_async(request)
        self.wait(future.done, f"the answer of {name}")
        self.outside.destroy_client(client)
        return future.result()

    def hear(self, name: str) -> list[Any]:
        """The messages of a contract topic, as they come."""
        row, heard = contract.topic(name), []
        self.outside.create_subscription(message_class(row.type), name, heard.append, qos.heard(row.qos))
        return heard

    def speaker(self, name: str) -> Any:
        """A publisher of a contract topic, once somebody listens."""
        row = contract.topic(name)
        publisher = self.outside.create_publisher(message_class(row.type), name, qos.offered(row.qos))
        self.wait(publisher.get_subscription_count, f"a listener on {name}")
        return publisher
