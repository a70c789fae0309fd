"""`robustnav chat`: talk to the robot from a terminal, over the chat topics."""

import sys
import threading
import time
from collections.abc import Callable

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rich.console import Console

from robustnav_msgs_py import contract
from robustnav_msgs_py import conversions as wire
from robustnav_nodes.graph import qos
from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.last_words import RECEIVED_LIMIT_S, not_received
from robustnav_nodes.graph.message_class import message_class
from robustnav_nodes.graph.spin import Spinner, stop_on_signals

LAST_ANSWERS_S = 2.0
LAST_LINE_S = 0.1


class Terminal(Node):
    """Says what is typed on `chat/from_user`, shows what comes on `chat/to_user`."""

    def __init__(self, show: Callable[[str], None]) -> None:
        super().__init__("chat_terminal")
        spoken, heard = contract.topic("chat/from_user"), contract.topic("chat/to_user")
        self._lines = self.create_publisher(message_class(spoken.type), spoken.name, qos.offered(spoken.qos))
        self.create_subscription(
            message_class(heard.type),
            heard.name,
            lambda message: show(wire.text_from_message(message)),
            qos.heard(heard.qos),
        )

    def say(self, line: str) -> None:
        """Say one line to the robot."""
        self._lines.publish(wire.text_to_message(line))

    def wait_until_received(self) -> None:
        """Wait until the robot has received the lines, for `RECEIVED_LIMIT_S` at most."""
        not_received([self._lines], time.monotonic() + RECEIVED_LIMIT_S)

    def is_heard(self) -> bool:
        """Whether a dialogue listens."""
        return self._lines.get_subscription_count() > 0


def chat(console: Console) -> int:
    """Talk until the end of input or Ctrl-C; returns the exit code."""
    prepare_environment()
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    spinner = Spinner(EventsExecutor())
    stop_on_signals(spinner.stop)

    def show(line: str) -> None:
        console.print("[bold yellow]robot:[/] ", end="")
        console.print(line, markup=False)

    terminal = Terminal(show)
    spinner.executor.add_node(terminal)
    console.print("[dim]waiting for the robot's dialogue ...[/]")
    if not spinner.spin_until(terminal.is_heard, timeout_s=float("inf")):
        return _leave(spinner, terminal)
    console.print("[dim]talk to the robot; Ctrl-D ends[/]")
    ended = threading.Event()

    def read() -> None:
        for line in sys.stdin:
            spinner.executor.create_task(lambda line=line: terminal.say(line.rstrip("\n")))
        ended.set()

    threading.Thread(target=read, daemon=True, name="keyboard").start()
    spinner.spin_until(ended.is_set, timeout_s=float("inf"))
    end_s = time.monotonic() + LAST_ANSWERS_S
    spinner.spin_until(lambda: time.monotonic() > end_s, LAST_ANSWERS_S)
    return _leave(spinner, terminal)


def _leave(spinner: Spinner, terminal: Terminal) -> int:
    spinner.listen(LAST_LINE_S)  # a line that was typed a moment ago is still to be said
    terminal.wait_until_received()
    spinner.close()
    terminal.destroy_node()
    rclpy.try_shutdown()
    return 0
