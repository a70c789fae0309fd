"""Hears every topic of the graph as bytes and puts it into a recording."""

import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

from bags.definitions import ament_prefixes, message_definition
from bags.offered_qos import INFINITE_NS, OfferedQos, Request, request_for
from bags.recording import Recording
from robustnav_nodes.graph.node import message_class

Observer = Callable[[bytes], None]


@dataclass(slots=True)
class _Heard:
    """One topic with one type: where its messages go, and how it is subscribed to."""

    channel: int
    request: Request
    subscription: Subscription
    lost: int = 0


class TopicListener:
    """Subscribes to the topics whose names match `include` and not `exclude`, as they appear.

    It asks for the most that all publishers of a topic offer, and for less when one joins that offers less.
    Log times are wall-clock times at which a message was taken, as rosbag2 has them without simulated time;
    a message's source time is not known, since rclpy's EventsExecutor cannot hand it out.

    Owned by a node and used in its executor's thread. `observer_of(topic, type)` may return a function that
    is shown the bytes of each message of that topic; `say(topic, sentence)` is told what could not be heard.
    """

    def __init__(
        self,
        node: Node,
        recording: Recording,
        *,
        include: re.Pattern[str],
        exclude: re.Pattern[str] | None,
        depth: int,
        observer_of: Callable[[str, str], Observer | None],
        say: Callable[[str, str], None],
    ) -> None:
        self._node = node
        self._recording = recording
        self._include, self._exclude = include, exclude
        self._depth = depth
        self._observer_of = observer_of
        self._say = say
        self._prefixes = ament_prefixes()
        self._heard: dict[tuple[str, str], _Heard] = {}
        self._refused: set[tuple[str, str]] = set()

    def discover(self) -> None:
        """Subscribe to what is new, and ask for less where publishers now offer less."""
        for topic, types in self._node.get_topic_names_and_types():
            if not self._include.fullmatch(topic) or (self._exclude and self._exclude.fullmatch(topic)):
                continue
            publishers = self._node.get_publishers_info_by_topic(topic)
            for message_type in types:
                offers = [
                    _offer(publisher.qos_profile)
                    for publisher in publishers
                    if publisher.topic_type == message_type
                ]
                if offers and (topic, message_type) not in self._refused:
                    self._hear(topic, message_type, offers)

    def lost_in_middleware(self) -> dict[str, int]:
        """Messages per topic that the middleware says it lost on the way; topics without losses left out."""
        lost: dict[str, int] = {}
        for (topic, _), heard in self._heard.items():
            if heard.lost:
                lost[topic] = lost.get(topic, 0) + heard.lost
        return lost

    def close(self) -> None:
        """Hear nothing any more."""
        for heard in self._heard.values():
            self._node.destroy_subscription(heard.subscription)
        self._heard.clear()

    def _hear(self, topic: str, message_type: str, offers: Sequence[OfferedQos]) -> None:
        request = request_for(offers)
        known = self._heard.get((topic, message_type))
        if known is None:
            self._hear_new(topic, message_type, offers, request)
        elif (known.request.reliable and not request.reliable) or (
            known.request.latched and not request.latched
        ):
            self._node.destroy_subscription(known.subscription)
            known.request = request
            known.subscription = self._subscribe(topic, message_type, known.channel, request)
            self._say(
                topic,
                "a publisher joined that offers less than the others; it is heard from now on, and what was "
                "said at this moment may be missing",
            )

    def _hear_new(
        self, topic: str, message_type: str, offers: Sequence[OfferedQos], request: Request
    ) -> None:
        try:
            message_class(message_type)
        except (ImportError, AttributeError, ValueError) as error:
            self._refused.add((topic, message_type))
            self._say(topic, f"cannot be recorded, its type {message_type} is not installed here: {error}")
            return
        definition = message_definition(message_type, self._prefixes)
        channel = self._recording.add_topic(topic, definition, offers)
        subscription = self._subscribe(topic, message_type, channel, request)
        self._heard[topic, message_type] = _Heard(channel=channel, request=request, subscription=subscription)

    def _subscribe(self, topic: str, message_type: str, channel: int, request: Request) -> Subscription:
        put = self._recording.put
        observe = self._observer_of(topic, message_type)

        def hear(data: bytes) -> None:
            put(channel, time.time_ns(), data)
            if observe is not None:
                observe(data)

        return self._node.create_subscription(
            message_class(message_type),
            topic,
            hear,
            QoSProfile(
                history=HistoryPolicy.KEEP_LAST,
                depth=self._depth,
                reliability=ReliabilityPolicy.RELIABLE if request.reliable else ReliabilityPolicy.BEST_EFFORT,
                durability=(
                    DurabilityPolicy.TRANSIENT_LOCAL if request.latched else DurabilityPolicy.VOLATILE
                ),
            ),
            raw=True,
            event_callbacks=SubscriptionEventCallbacks(
                # Asking for less, at the next discovery, is the answer to publishers that offer less.
                incompatible_qos=lambda _: None,
                message_lost=lambda event: self._count_lost(topic, message_type, event),
            ),
        )

    def _count_lost(self, topic: str, message_type: str, event: Any) -> None:
        heard = self._heard.get((topic, message_type))
        if heard is not None:
            heard.lost += int(event.total_count_change)


def _offer(profile: QoSProfile) -> OfferedQos:
    return OfferedQos(
        reliability=profile.reliability.name.lower(),
        durability=profile.durability.name.lower(),
        history=profile.history.name.lower(),
        depth=int(profile.depth),
        deadline_ns=_duration_ns(profile.deadline),
        lifespan_ns=_duration_ns(profile.lifespan),
        liveliness=profile.liveliness.name.lower(),
        liveliness_lease_ns=_duration_ns(profile.liveliness_lease_duration),
    )


def _duration_ns(duration: Duration) -> int:
    """0 stands for "not set", which is unlimited."""
    return int(duration.nanoseconds) or INFINITE_NS
