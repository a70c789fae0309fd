"""A topic whose speakers have all left is let go, and heard again when one comes; nothing said is lost."""

import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
import rclpy
from rclpy.duration import Duration
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from bags.manifest import Manifest
from bags.reader import open_bag
from bags.recording import Recording
from bags.topic_listener import FORSAKEN_AFTER_S, TopicListener
from bags.writer import BagWriter

LIMIT_S = 20.0
TOPIC = "/chat/from_user"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@dataclass
class Room:
    """A node that listens by a clock that the test sets, and one that speaks."""

    listener: TopicListener
    recording: Recording
    ears: Node
    mouth: Node
    executor: EventsExecutor
    now_s: list[float]
    said: list[str] = field(default_factory=list)

    def until(self, holds: Callable[[], bool]) -> None:
        deadline = time.monotonic() + LIMIT_S
        while not holds():
            assert time.monotonic() < deadline, "what the test waits for did not come"
            self.executor.spin_once(timeout_sec=0.01)
            self.listener.discover()

    def speaker(self, qos: QoSProfile | int = 10) -> Publisher:
        """A publisher that is heard."""
        made = self.mouth.create_publisher(String, TOPIC, qos)
        self.until(lambda: made.get_subscription_count() == 1)
        return made

    def say(self, speaker: Publisher, word: str) -> None:
        self.said.append(word)
        speaker.publish(String(data=word))
        self.until(lambda: sum(count.messages for count in self.recording.counts()) == len(self.said))

    def leave(self, speaker: Publisher) -> None:
        """Take a publisher down, and see that the listener knows."""
        self.mouth.destroy_publisher(speaker)
        self.until(lambda: not self.ears.get_publishers_info_by_topic(TOPIC))
        self.listener.discover()

    @property
    def is_heard(self) -> bool:
        return bool(self.ears.get_subscriptions_info_by_topic(TOPIC))


@pytest.fixture
def nodes() -> Iterator[tuple[Node, Node]]:
    rclpy.init()
    try:
        made = rclpy.create_node("ears"), rclpy.create_node("mouth")
        yield made
        for node in made:
            node.destroy_node()
    finally:
        rclpy.try_shutdown()


@pytest.fixture
def room(nodes: tuple[Node, Node], tmp_path: Path, manifest: Manifest) -> Iterator[Room]:
    now_s = [0.0]
    ears, mouth = nodes
    executor = EventsExecutor()
    for node in nodes:
        executor.add_node(node)
    writer = BagWriter(tmp_path / "bag", manifest=manifest)
    recording = Recording(writer, queue_bytes=10**6, flush_period_s=1.0)
    listener = TopicListener(
        ears,
        recording,
        include=re.compile(TOPIC),
        exclude=None,
        patient=re.compile("/patient"),
        patience_s=FORSAKEN_AFTER_S,
        depth=100,
        observer_of=lambda *_: None,
        say=lambda *_: None,
        clock=lambda: now_s[0],
    )
    yield Room(listener, recording, ears, mouth, executor, now_s)
    listener.close()
    executor.shutdown()  # it holds the nodes, which would stay in the graph
    recording.finish()
    recording.wait(LIMIT_S)


def words(room: Room) -> list[str]:
    room.recording.finish()
    assert room.recording.wait(LIMIT_S)
    with open_bag(room.recording.folder) as bag:
        assert len(bag.topics) == 1
        return [recorded.message.data for recorded in bag.messages()]


def test_a_topic_whose_speaker_comes_back_is_heard_again(room: Room) -> None:
    for word in ("find", "the", "mug"):
        speaker = room.speaker()
        room.say(speaker, word)
        room.leave(speaker)
        room.now_s[0] += FORSAKEN_AFTER_S
        room.until(lambda: not room.is_heard)
    assert [(count.topic, count.messages) for count in room.recording.counts()] == [(TOPIC, 3)]
    assert words(room) == ["find", "the", "mug"]


def test_a_speaker_that_is_replaced_at_once_does_not_find_its_topic_unheard(room: Room) -> None:
    room.leave(room.speaker())
    for _ in range(3):
        room.now_s[0] += 0.9 * FORSAKEN_AFTER_S
        room.listener.discover()
        assert room.is_heard
        room.leave(room.speaker())  # it counts from here again
    room.now_s[0] += FORSAKEN_AFTER_S
    room.until(lambda: not room.is_heard)


def test_one_speaker_that_stays_is_enough(room: Room) -> None:
    staying, leaving = room.speaker(), room.speaker()
    room.mouth.destroy_publisher(leaving)
    room.until(lambda: len(room.ears.get_publishers_info_by_topic(TOPIC)) == 1)
    room.now_s[0] += 10 * FORSAKEN_AFTER_S
    for _ in range(3):
        room.listener.discover()
    room.say(staying, "still here")
    assert words(room) == ["still here"]


def test_a_latched_topic_is_kept(room: Room) -> None:
    room.leave(room.speaker(LATCHED))
    room.now_s[0] += 10 * FORSAKEN_AFTER_S
    for _ in range(3):
        room.listener.discover()
    assert room.is_heard


def test_a_patient_listener_lets_others_be_found_first(room: Room) -> None:
    room.listener._patient, room.listener._patience_s = re.compile(TOPIC), 1.0
    speaker = room.mouth.create_publisher(String, TOPIC, 10)
    room.until(lambda: bool(room.ears.get_publishers_info_by_topic(TOPIC)))
    room.listener.discover()
    room.now_s[0] += 0.9
    room.listener.discover()
    assert not room.is_heard
    room.now_s[0] += 0.2
    room.until(lambda: speaker.get_subscription_count() == 1)
    room.say(speaker, "heard")
    assert words(room) == ["heard"]


def test_what_waits_when_the_listener_closes_is_in_the_bag_in_the_order_it_was_said(room: Room) -> None:
    room.listener._include = re.compile(f"{TOPIC}|/chat/to_user")
    asking = room.speaker()
    answering = room.mouth.create_publisher(String, "/chat/to_user", 10)
    room.until(lambda: answering.get_subscription_count() == 1)
    for word in ("find", "the", "mug"):
        asking.publish(String(data=word))
        answering.publish(String(data=f"{word}?"))
    assert asking.wait_for_all_acked(Duration(seconds=LIMIT_S))
    assert answering.wait_for_all_acked(Duration(seconds=LIMIT_S))
    assert sum(count.messages for count in room.recording.counts()) == 0
    room.listener.close()
    for _ in range(10):  # the executor still knows of messages that are taken by now
        room.executor.spin_once(timeout_sec=0.01)
    room.recording.finish()
    assert room.recording.wait(LIMIT_S)
    with open_bag(room.recording.folder) as bag:
        said = [recorded.message.data for recorded in bag.messages()]
    assert said == ["find", "find?", "the", "the?", "mug", "mug?"]
