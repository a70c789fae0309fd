"""`robustnav chat`: what is typed reaches the robot, what it says is shown, and it leaves when told to."""

import signal
import subprocess
import sys
import threading
from collections.abc import Iterator

import pytest

from robustnav_msgs_py import conversions as wire
from tests.bench import DEADLINE_S, Bench


@pytest.fixture
def terminal() -> Iterator["subprocess.Popen[str]"]:
    """The command; killed if a test leaves it running."""
    command, pipe = [sys.executable, "-m", "robustnav_nodes.cli", "chat"], subprocess.PIPE
    process = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, text=True)
    watchdog = threading.Timer(2 * DEADLINE_S, process.kill)
    watchdog.start()
    yield process
    watchdog.cancel()
    process.kill()
    process.communicate()


def read_line(process: "subprocess.Popen[str]") -> str:
    assert process.stdout is not None
    return process.stdout.readline().strip()


def type_in(process: "subprocess.Popen[str]", line: str) -> None:
    assert process.stdin is not None
    process.stdin.write(f"{line}\n")
    process.stdin.flush()


def test_lines_go_to_the_robot_and_its_answers_are_shown(
    bench: Bench, terminal: "subprocess.Popen[str]"
) -> None:
    heard, mouth = bench.hear("chat/from_user"), bench.speaker("chat/to_user")
    assert read_line(terminal) == "waiting for the robot's dialogue ..."
    assert read_line(terminal) == "talk to the robot; Ctrl-D ends"
    type_in(terminal, "find the mug")
    bench.wait(lambda: [wire.text_from_message(line) for line in heard] == ["find the mug"], "the line")
    mouth.publish(wire.text_to_message("I look for the [red] mug."))
    assert read_line(terminal) == "robot: I look for the [red] mug."
    terminal.send_signal(signal.SIGINT)
    assert terminal.wait(timeout=DEADLINE_S) == 0


def test_what_was_typed_before_the_end_of_input_is_heard(
    bench: Bench, terminal: "subprocess.Popen[str]"
) -> None:
    heard = bench.hear("chat/from_user")
    rest, _ = terminal.communicate("find the mug\nstop\n", timeout=DEADLINE_S)
    assert terminal.returncode == 0, rest
    bench.wait(lambda: len(heard) == 2, "both lines")
    assert [wire.text_from_message(line) for line in heard] == ["find the mug", "stop"]


def test_it_can_be_left_while_no_robot_listens(bench: Bench, terminal: "subprocess.Popen[str]") -> None:
    assert read_line(terminal) == "waiting for the robot's dialogue ..."
    terminal.send_signal(signal.SIGINT)
    assert terminal.wait(timeout=DEADLINE_S) == 0
