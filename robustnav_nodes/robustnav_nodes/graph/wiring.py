"""How a node is joined to the others: over ROS, or in lock-step in one thread (`lockstep`)."""

import time
from collections.abc import Callable
from typing import Any, Protocol, TypeVar

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.lifecycle import LifecycleNode
from rclpy.qos import DurabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from robustnav_msgs_py.contract import Topic
from robustnav_nodes.graph import last_words, qos
from robustnav_nodes.graph.message_class import message_class
from robustnav_nodes.graph.worker import Worker

T = TypeVar("T")


class Outlet(Protocol):
    """Where a node publishes."""

    def publish(self, message: Any) -> None:
        """Send a message; dropped while the node is not active."""

    def get_subscription_count(self) -> int:
        """How many listen."""


class Work(Protocol):
    """Runs one long job at a time for a node."""

    @property
    def busy(self) -> bool:
        """Whether a job runs or its result has not been handed over yet."""

    def submit(self, job: Callable[[], T], done: Callable[[T], None]) -> None:
        """Start `job`; `done` gets its result in the node's own thread. Only when not busy."""


class Wiring(Protocol):
    """Makes what joins a node to the others, and takes it down again."""

    def publisher(self, row: Topic, *, managed: bool = True) -> Outlet:
        """An outlet on a topic; one that is not `managed` also speaks while the node is inactive."""

    def subscription(self, row: Topic, hear: Callable[[Any], None]) -> None:
        """Call `hear` with each message on a topic."""

    def service(self, name: str, kind: str, respond: Callable[[Any, Any], Any]) -> None:
        """Answer a service."""

    def timer(self, period_s: float, work: Callable[[], None], *, steady: bool) -> None:
        """Call `work` each `period_s` seconds of ROS time, or of wall time where `steady`."""

    def worker(
        self, guard: Callable[[Callable[[], None]], None], failed: Callable[[BaseException], None]
    ) -> Work:
        """Something that runs long jobs; `guard` runs what hands a result over."""

    def volatile_speakers(self, row: Topic) -> list[str]:
        """Nodes that speak on a topic without latching."""

    def now_ns(self) -> int:
        """ROS time."""

    def steady_s(self) -> float:
        """Wall time that never jumps, from an arbitrary start."""

    def take_down(self, silent_since_s: float) -> None:
        """Take down everything that was made; the last word was said at `silent_since_s` of `steady_s`."""


class RosWiring:
    """Joins a node to a ROS graph."""

    def __init__(self, node: LifecycleNode) -> None:
        self._node = node
        self._timers: list[Any] = []
        self._subscriptions: list[Any] = []
        self._services: list[Any] = []
        self._publishers: list[Any] = []
        self._workers: list[Worker] = []

    def publisher(self, row: Topic, *, managed: bool = True) -> Outlet:
        """See Wiring."""
        if not managed:
            kind, offered = message_class(row.type), qos.offered(row.qos)
            plain: Outlet = self._node.create_publisher(kind, row.name, offered)
            return plain
        made: Outlet = self._node.create_lifecycle_publisher(
            message_class(row.type),
            row.name,
            qos.offered(row.qos),
            # a QoS event that is still queued when its entity is destroyed raises out of the executor
            event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )
        self._publishers.append(made)
        return made

    def subscription(self, row: Topic, hear: Callable[[Any], None]) -> None:
        """See Wiring."""
        self._subscriptions.append(
            self._node.create_subscription(
                message_class(row.type),
                row.name,
                hear,
                qos.heard(row.qos),
                event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),  # see `publisher`
                qos_overriding_options=QoSOverridingOptions.with_default_policies(),
            )
        )

    def service(self, name: str, kind: str, respond: Callable[[Any, Any], Any]) -> None:
        """See Wiring."""
        self._services.append(self._node.create_service(message_class(kind), name, respond))

    def timer(self, period_s: float, work: Callable[[], None], *, steady: bool) -> None:
        """See Wiring."""
        clock = Clock(clock_type=ClockType.STEADY_TIME) if steady else self._node.get_clock()
        self._timers.append(self._node.create_timer(period_s, work, clock=clock))

    def worker(
        self, guard: Callable[[Callable[[], None]], None], failed: Callable[[BaseException], None]
    ) -> Work:
        """See Wiring."""
        made = Worker(self._call_soon, guard, failed)
        self._workers.append(made)
        return made

    def volatile_speakers(self, row: Topic) -> list[str]:
        """See Wiring."""
        publishers = self._node.get_publishers_info_by_topic(self._node.resolve_topic_name(row.name))
        return [
            publisher.node_name
            for publisher in publishers
            if publisher.qos_profile.durability is DurabilityPolicy.VOLATILE
        ]

    def now_ns(self) -> int:
        """See Wiring; simulated time where `use_sim_time` is set."""
        return int(self._node.get_clock().now().nanoseconds)

    def steady_s(self) -> float:
        """See Wiring."""
        return time.monotonic()

    def take_down(self, silent_since_s: float) -> None:
        """See Wiring; waits until what was said is received, for `RECEIVED_LIMIT_S` from then on at most."""
        for worker in self._workers:
            worker.close()
        lost = last_words.not_received(self._publishers, silent_since_s + last_words.RECEIVED_LIMIT_S)
        if lost:
            self._node.get_logger().warning(
                f"leaving, although a listener has not received all that was said on {', '.join(lost)}"
            )
        for timer in self._timers:
            self._node.destroy_timer(timer)
        for subscription in self._subscriptions:
            self._node.destroy_subscription(subscription)
        for service in self._services:
            self._node.destroy_service(service)
        for publisher in self._publishers:
            self._node.destroy_lifecycle_publisher(publisher)
        for made in (self._workers, self._timers, self._subscriptions, self._services, self._publishers):
            made.clear()

    def _call_soon(self, work: Callable[[], None]) -> None:
        """Run `work` in the executor's thread; called from a worker's."""
        executor = self._node.executor
        if executor is not None:
            executor.create_task(work)
