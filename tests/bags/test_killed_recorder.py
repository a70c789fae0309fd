"""A recorder that is killed at any moment leaves a bag that opens, and less than two seconds are missing."""

import random
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
import rclpy
from rclpy.executors import Executor
from rclpy.experimental import EventsExecutor
from rclpy.publisher import Publisher
from rosbags.rosbag2 import Reader
from std_msgs.msg import String

from bags.manifest import Manifest
from bags.reader import open_bag
from bags.writer import BagWriter

LIMIT_S = 60.0
MOST_MISSING_S = 2.0
TOPIC = "words"


# Large words fill chunks, which are written at once; small ones wait in theirs for the flush.
LARGE, SMALL = 10_000, 10


def word(number: int, random_bytes: int) -> str:
    """A text that begins with a number and cannot be compressed much."""
    return f"{number} " + random.Random(number).randbytes(random_bytes).hex()


class Speaker:
    """Says numbered words, and remembers when."""

    def __init__(self) -> None:
        self.said_s: list[float] = []
        self.word_bytes = LARGE
        self._node = rclpy.create_node("talker")
        self._publisher: Publisher = self._node.create_publisher(String, TOPIC, 100)
        self._executor: Executor = EventsExecutor()
        self._executor.add_node(self._node)

    @property
    def is_heard(self) -> bool:
        return bool(self._publisher.get_subscription_count())

    def speak_until(self, holds: Callable[[], bool]) -> None:
        deadline = time.monotonic() + LIMIT_S
        while not holds():
            assert time.monotonic() < deadline, "what the test waits for did not come"
            if self.is_heard:
                self.said_s.append(time.monotonic())
                self._publisher.publish(String(data=word(len(self.said_s) - 1, self.word_bytes)))
            self._executor.spin_once(timeout_sec=0.01)

    def close(self) -> None:
        self._executor.shutdown()  # it holds the nodes, which would stay in the graph
        self._node.destroy_node()


@pytest.fixture
def speaker() -> Iterator[Speaker]:
    rclpy.init()
    made = Speaker()
    yield made
    made.close()
    rclpy.try_shutdown()


def record_and_kill(speaker: Speaker, folder: Path, after_s: float, split_s: float) -> float:
    """Have a recorder of its own process killed `after_s` seconds after it heard the first word."""
    parameters = {"folder": folder.parent, "name": folder.name, "split_duration_s": split_s}
    given = [part for name, value in parameters.items() for part in ("-p", f"{name}:={value}")]
    with subprocess.Popen([sys.executable, "-m", "bags.recorder", "--ros-args", *given]) as recorder:
        try:
            speaker.speak_until(lambda: speaker.is_heard)
            heard_s = time.monotonic()
            speaker.speak_until(lambda: time.monotonic() >= heard_s + after_s)
            assert recorder.poll() is None
        finally:
            recorder.kill()
        return time.monotonic()


def kept_numbers(path: Path) -> list[int]:
    with open_bag(path) as bag:
        return [int(recorded.message.data.split()[0]) for recorded in bag.messages([f"/{TOPIC}"])]


def assert_little_is_missing(folder: Path, speaker: Speaker, killed_s: float, manifest: Manifest) -> None:
    kept = kept_numbers(folder)  # as the kill left it
    with BagWriter(folder, manifest=manifest, resume=True) as after:
        assert after.join_earlier_files().problems == ()
    assert kept_numbers(folder) == kept
    assert kept == list(range(len(kept)))
    if len(kept) < len(speaker.said_s):
        assert killed_s - speaker.said_s[len(kept)] <= MOST_MISSING_S
    with open_bag(folder) as bag:
        assert bag.cut == ""
        total = sum(row.message_count for row in bag.topics)
    with Reader(folder) as reader:
        assert reader.message_count == total == sum(1 for _ in reader.messages())


@pytest.mark.parametrize(
    ("after_s", "split_s", "word_bytes"), [(0.4, 0.0, LARGE), (1.9, 0.0, SMALL), (1.9, 0.5, LARGE)]
)
def test_a_kill_costs_less_than_two_seconds(
    tmp_path: Path, speaker: Speaker, manifest: Manifest, after_s: float, split_s: float, word_bytes: int
) -> None:
    speaker.word_bytes = word_bytes
    killed_s = record_and_kill(speaker, tmp_path / "run", after_s, split_s)
    assert_little_is_missing(tmp_path / "run", speaker, killed_s, manifest)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_a_kill_at_any_moment_costs_less_than_two_seconds(
    tmp_path: Path, speaker: Speaker, manifest: Manifest, seed: int
) -> None:
    chance = random.Random(seed)
    split_s = chance.choice((0.0, 0.3))
    speaker.word_bytes = chance.choice((LARGE, SMALL))
    killed_s = record_and_kill(speaker, tmp_path / "run", chance.uniform(0.0, 4.0), split_s)
    assert_little_is_missing(tmp_path / "run", speaker, killed_s, manifest)
