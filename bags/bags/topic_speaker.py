"""Speaks on the topics of a bag, in the bytes that were recorded."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.exceptions import NameValidationException
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy
from rclpy.qos_overriding_options import QoSOverridingOptions

from bags.bag_metadata import TopicRow
from bags.definitions import TYPE_NAME
from bags.offered_qos import INFINITE_NS, OfferedQos
from bags.playback import Programme
from bags.played_qos import offer_to_play
from bags.reader import RawMessage
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.graph.last_words import RECEIVED_LIMIT_S, not_received
from robustnav_nodes.graph.message_class import message_class

# What is shorter is no message; an empty one would hold up all that follow it on its topic for good.
CDR_HEADER_BYTES = 4

RCLError = rclpy_implementation.RCLError
# Every node speaks on these, and who listens to all nodes listens to the player before it plays.
OF_EVERY_NODE = ("/rosout", "/parameter_events", "/diagnostics")


def installed_class(message_type: str) -> Any:
    """The class of a recorded type; raises BadFileError where it is not installed here."""
    # The name comes from a file: nothing but a package of messages is imported for it.
    if not TYPE_NAME.fullmatch(message_type):
        raise BadFileError(f"its type {message_type!r} is no type of ROS 2 messages")
    try:
        return message_class(message_type)
    except (ImportError, AttributeError) as error:
        raise BadFileError(f"its type {message_type} is not installed here: {error}") from error


def installed(chosen: Programme, path: Path) -> Programme:
    """What is chosen without the topics whose type is not installed here; raises where nothing remains."""
    kept, left_out = [], list(chosen.left_out)
    for row in chosen.topics:
        try:
            installed_class(row.type)
        except BadFileError as error:
            left_out.append((row.name, f"is left out, {error}"))
        else:
            kept.append(row)
    if not kept:
        topic, sentence = left_out[0]
        raise BadFileError(f"nothing of {path} can be played; {topic!r} {sentence}")
    return replace(chosen, topics=tuple(kept), left_out=tuple(left_out))


class TopicSpeaker:
    """A publisher for each of `topics`, under its recorded name unless a remapping moves it.

    The contract is not asked: a bag may hold any topic. ROS parameters `qos_overrides` reach the publishers.
    Topics that cannot be spoken on are left out, and `say(topic, sentence)` is told why. Owned by a node and
    used in its executor's thread.
    """

    def __init__(
        self, node: Node, topics: Sequence[TopicRow], *, depth: int, say: Callable[[str, str], None]
    ) -> None:
        self._node = node
        self._say = say
        self._publishers: dict[str, Publisher] = {}
        for row in topics:
            try:
                self._publishers[row.name] = self._publisher(row, offer_to_play(row, depth=depth))
            except (RCLError, NameValidationException) as error:  # or two topics of unlike types became one
                say(row.name, f"cannot be played: {' '.join(str(error).split())}")

    @property
    def topics(self) -> tuple[str, ...]:
        """Recorded names of the topics that it speaks on."""
        return tuple(self._publishers)

    def say(self, message: RawMessage) -> bool:
        """Send a message; False where its topic is left out, or where it is too short to be one."""
        publisher = self._publishers.get(message.topic)
        if publisher is None:
            return False
        if len(message.data) < CDR_HEADER_BYTES:
            self._say(message.topic, f"a message of {len(message.data)} bytes, which is none, is left out")
            return False
        publisher.publish(message.data)
        return True

    def listeners(self) -> int:
        """How many listen to the topics that are played, but for those of every node."""
        return sum(
            publisher.get_subscription_count()
            for topic, publisher in self._publishers.items()
            if topic not in OF_EVERY_NODE
        )

    def close(self) -> None:
        """Take the publishers down, when reliable listeners have received what was said."""
        for topic in not_received(self._publishers.values(), time.monotonic() + RECEIVED_LIMIT_S):
            self._say(topic, "a listener has not received all that was played")
        for publisher in self._publishers.values():
            self._node.destroy_publisher(publisher)
        self._publishers.clear()

    def _publisher(self, row: TopicRow, offer: OfferedQos) -> Publisher:
        return self._node.create_publisher(
            installed_class(row.type),
            row.name,
            _profile(offer),
            # a QoS event that is still queued when its entity is destroyed raises out of the executor
            event_callbacks=PublisherEventCallbacks(use_default_callbacks=False),
            qos_overriding_options=QoSOverridingOptions.with_default_policies(),
        )


def _profile(offer: OfferedQos) -> QoSProfile:
    latched = offer.durability == "transient_local"
    best_effort = offer.reliability == "best_effort"
    profile = QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=offer.depth,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )
    if offer.liveliness == "manual_by_topic":
        profile.liveliness = LivelinessPolicy.MANUAL_BY_TOPIC
    for name, duration_ns in (
        ("deadline", offer.deadline_ns),
        ("lifespan", offer.lifespan_ns),
        ("liveliness_lease_duration", offer.liveliness_lease_ns),
    ):
        if 0 < duration_ns < INFINITE_NS:
            setattr(profile, name, Duration(nanoseconds=duration_ns))
    return profile
