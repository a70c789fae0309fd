"""What a node says before it ends reaches those that lag: here a process that stands still for a while."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import pytest
import rclpy
from lifecycle_msgs.msg import State
from rclpy.node import Node
from std_msgs.msg import String

from robustnav_msgs_py import conversions as wire
from robustnav_nodes.graph import last_words
from robustnav_nodes.graph.node import GraphNode
from tests.bench import DEADLINE_S, Bench

HEAR = Path(__file__).parent / "hear_from_outside.py"
WORDS = [*(f"word{number}" for number in range(8)), "goodbye"]
LAG_S = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class NoParameters:
    """Of the node under test."""


class Talker(GraphNode[NoParameters]):
    """Speaks as the dialogue would."""

    executable: ClassVar[str] = "dialogue"
    declaration: ClassVar[type] = NoParameters

    def configure(self) -> None:
        self.mouth = self.publisher("chat/to_user")

    def say_all(self) -> None:
        for word in WORDS:
            self.mouth.publish(wire.text_to_message(word))


@pytest.fixture
def listener() -> Iterator["subprocess.Popen[str]"]:
    process = subprocess.Popen([sys.executable, str(HEAR), WORDS[-1]], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline() == "listening\n"
    yield process
    process.send_signal(signal.SIGCONT)
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=DEADLINE_S)


def talker_with_a_listener(bench: Bench) -> Talker:
    node: Talker = bench.add(Talker())
    node.trigger_configure()
    node.trigger_activate()
    bench.wait(lambda: node.mouth.get_subscription_count() == 1, "the listener to be found")
    return node


@contextmanager
def standing_still(process: "subprocess.Popen[str]", lag_s: float) -> Iterator[Callable[[], bool]]:
    """`process` stands still for `lag_s`; tells whether it has gone on."""
    process.send_signal(signal.SIGSTOP)
    os.waitid(os.P_PID, process.pid, os.WSTOPPED | os.WNOWAIT)
    went_on = threading.Event()

    def go_on() -> None:
        went_on.set()
        process.send_signal(signal.SIGCONT)

    timer = threading.Timer(lag_s, go_on)
    timer.start()
    try:
        yield went_on.is_set
    finally:
        timer.cancel()
        timer.join()


def test_a_node_ends_when_those_that_lag_have_its_last_words(
    bench: Bench, listener: "subprocess.Popen[str]"
) -> None:
    node = talker_with_a_listener(bench)
    with standing_still(listener, LAG_S) as has_gone_on:
        node.say_all()
        node.trigger_shutdown()
        assert has_gone_on()
    said, _ = listener.communicate(timeout=DEADLINE_S)
    assert said.split() == WORDS


def test_a_listener_that_is_stuck_holds_a_node_no_longer_than_the_limit(
    bench: Bench, listener: "subprocess.Popen[str]", monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(last_words, "RECEIVED_LIMIT_S", LAG_S)
    node = talker_with_a_listener(bench)
    with standing_still(listener, DEADLINE_S) as has_gone_on:
        node.say_all()
        begun_s = time.monotonic()
        node.trigger_shutdown()
        assert time.monotonic() - begun_s >= LAG_S
        assert not has_gone_on()
    assert node.state_id == State.PRIMARY_STATE_FINALIZED


def test_the_limit_counts_from_the_last_word(bench: Bench, monkeypatch: pytest.MonkeyPatch) -> None:
    """So nodes that fell silent together wait together, however many clean up one after the other."""
    deadlines: list[float] = []

    def not_received(_publishers: object, deadline_s: float) -> list[str]:
        deadlines.append(deadline_s)
        return []

    monkeypatch.setattr(last_words, "not_received", not_received)
    node = bench.add(Talker())
    node.trigger_configure()
    node.trigger_activate()
    node.trigger_deactivate()
    silent_s = time.monotonic()
    node.trigger_cleanup()
    assert len(deadlines) == 1
    assert deadlines[0] <= silent_s + last_words.RECEIVED_LIMIT_S


def test_where_ros_was_shut_down_nobody_is_waited_for() -> None:
    context = rclpy.Context()
    rclpy.init(context=context)
    node = Node("speaker", context=context)
    publisher = node.create_publisher(String, "said", 1)
    rclpy.shutdown(context=context)
    assert last_words.not_received([publisher], time.monotonic() + DEADLINE_S) == ["said"]
    node.destroy_node()
