"""Hears every topic of the graph as bytes and puts it into a recording."""

import heapq
import re
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from operator import itemgetter

from rclpy.duration import Duration
from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.subscription import Subscription

from bags.definitions import ament_prefixes, message_definition
from bags.offered_qos import INFINITE_NS, OfferedQos, Request, request_for
from bags.recording import Recording
from robustnav_nodes.graph.message_class import message_class

Observer = Callable[[bytes], None]

# A publisher that is replaced, as by a node that starts again, need not find its topic unheard.
FORSAKEN_AFTER_S = 1.0


@dataclass(slots=True)
class _Heard:
    """One topic with one type: where its messages go, and how it is subscribed to.

    `subscription` is None, and `forsaken_since_s` set, while nobody speaks on it.
    """

    channel: int
    request: Request
    subscription: Subscription | None
    forsaken_since_s: float | None = None


class TopicListener:
    """Subscribes to the topics whose names match `include` and not `exclude`, as they appear.

    It asks for the most that all publishers of a topic offer, and for less when one joins that offers less.
    A volatile topic that has lost all its publishers is let go after `FORSAKEN_AFTER_S`, and heard again, in
    the same channel, when one appears. Who speaks only once (`ros2 topic pub --once`) does so as soon as one
    listener is found: a recorder that still listens since an earlier speaker could be that one, and the node
    that was spoken to would not hear a word. Latched topics are kept: whoever comes late has them anyway.
    For the same reason topics that match `patient` are heard only `patience_s` after their first speaker
    appeared; what is said in one breath before that is not recorded (the dialogue tells what it heard).

    Log times are wall-clock times at which a message was taken, as rosbag2 has them without simulated time;
    a message's source time is not recorded, since rclpy's EventsExecutor cannot hand it out.

    Owned by a node and used in its executor's thread. `observer_of(topic, type)` may return a function that
    is shown the bytes of each message of that topic; `say(topic, sentence)` is told what could not be heard;
    `clock` tells monotonic seconds.
    """

    def __init__(
        self,
        node: Node,
        recording: Recording,
        *,
        include: re.Pattern[str],
        exclude: re.Pattern[str] | None,
        patient: re.Pattern[str],
        patience_s: float,
        depth: int,
        observer_of: Callable[[str, str], Observer | None],
        say: Callable[[str, str], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._node = node
        self._recording = recording
        self._include, self._exclude = include, exclude
        self._patient, self._patience_s = patient, patience_s
        self._depth = depth
        self._observer_of = observer_of
        self._say = say
        self._clock = clock
        self._prefixes = ament_prefixes()
        self._heard: dict[tuple[str, str], _Heard] = {}
        self._refused: set[tuple[str, str]] = set()
        self._spoken_on_since_s: dict[tuple[str, str], float] = {}

    def discover(self) -> None:
        """Subscribe to what is new, ask for less where publishers now offer less, let go what is forsaken."""
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
                if not offers:
                    self._spoken_on_since_s.pop((topic, message_type), None)
                    self._forsake(topic, message_type)
                elif (topic, message_type) not in self._refused and self._is_due(topic, message_type):
                    self._hear(topic, message_type, offers)

    def close(self) -> None:
        """Hear nothing any more; what has arrived until now is taken first."""
        self._unsubscribe(*self._heard.values())
        self._heard.clear()

    def _is_due(self, topic: str, message_type: str) -> bool:
        """False while those that a patient topic is meant for are left the time to be found first."""
        since_s = self._spoken_on_since_s.setdefault((topic, message_type), self._clock())
        return not self._patient.fullmatch(topic) or self._clock() - since_s >= self._patience_s

    def _hear(self, topic: str, message_type: str, offers: Sequence[OfferedQos]) -> None:
        request = request_for(offers)
        known = self._heard.get((topic, message_type))
        if known is None:
            self._hear_new(topic, message_type, offers, request)
            return
        known.forsaken_since_s = None
        if known.subscription is None:
            known.request = request
            known.subscription = self._subscribe(topic, message_type, known.channel, request)
        elif (known.request.reliable and not request.reliable) or (
            known.request.latched and not request.latched
        ):
            self._unsubscribe(known)
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

    def _forsake(self, topic: str, message_type: str) -> None:
        """Nobody speaks on a topic now; let it go when that has lasted."""
        heard = self._heard.get((topic, message_type))
        if heard is None or heard.request.latched:
            return
        if heard.forsaken_since_s is None:
            heard.forsaken_since_s = self._clock()
        elif self._clock() - heard.forsaken_since_s >= FORSAKEN_AFTER_S:
            self._unsubscribe(heard)

    def _unsubscribe(self, *topics: _Heard) -> None:
        """Let topics go when what has arrived of them is taken, in the order in which it was said.

        A busy machine may leave the executor no time for the last words of a run.
        """
        heard = [topic.subscription for topic in topics if topic.subscription is not None]
        try:
            for _, subscription, data in heapq.merge(*map(self._waiting_in, heard), key=itemgetter(0)):
                subscription.callback(data)
        finally:
            for topic in topics:
                topic.subscription = None
            for subscription in heard:
                self._node.destroy_subscription(subscription)

    def _waiting_in(self, subscription: Subscription) -> Iterator[tuple[int, Subscription, bytes]]:
        """The messages that a subscription keeps, which are at most `depth`, each with its source time."""
        for _ in range(self._depth):
            with subscription.handle:
                taken = subscription.handle.take_message(subscription.msg_type, True)
            if taken is None:
                return
            data, info = taken
            yield info["source_timestamp"], subscription, data

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
            # An event that is still queued when its subscription is destroyed, as those that hear too much
            # are, would raise out of rclpy's EventsExecutor and end the node.
            event_callbacks=SubscriptionEventCallbacks(use_default_callbacks=False),
        )


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
