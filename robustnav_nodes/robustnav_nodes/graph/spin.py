"""Run nodes in this process until they are told to stop, and leave cleanly."""

import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from lifecycle_msgs.msg import State
from rclpy.executors import Executor
from rclpy.experimental import EventsExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.signals import SignalHandlerOptions

from robustnav_msgs_py.errors import BadParameterError, RobustnavError
from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.node import GraphNode

RCLError = rclpy_implementation.RCLError
WRONG_USAGE = 2

STOP_SIGNALS = {signal.SIGINT, signal.SIGTERM, signal.SIGHUP}  # the last: the terminal is gone
# Work from other threads wakes the executor; the period only bounds how long a lost wake-up can last.
SPIN_PERIOD_S = 1.0
PARENT_HOLDS_STDIN = "ROBUSTNAV_PARENT_HOLDS_STDIN"


class Spinner:
    """Spins an EventsExecutor until `stop` is called, from any thread.

    The executor's own `spin()` burns a core, so it is driven by `spin_once`; see rclpy's
    EventsExecutor. `stop` goes through a task, the one thing that makes `spin_once` return at once.
    """

    def __init__(self, executor: Executor) -> None:
        self.executor = executor
        self._stopped = threading.Event()

    @property
    def stopped(self) -> bool:
        """Whether `stop` was called."""
        return self._stopped.is_set()

    def stop(self) -> None:
        """Make `spin` return soon."""
        self._stopped.set()
        self.executor.create_task(lambda: None)

    def spin(self, done: Callable[[], bool] = lambda: False) -> None:
        """Run callbacks until `stop`, or until one of them has made `done` hold."""
        while not self._stopped.is_set() and rclpy.ok() and not done():
            self.executor.spin_once(timeout_sec=SPIN_PERIOD_S)

    def listen(self, time_s: float) -> None:
        """Run callbacks for a while after `stop`."""
        end_s = time.monotonic() + time_s
        while (left_s := end_s - time.monotonic()) > 0.0:
            self.executor.spin_once(timeout_sec=left_s)

    def spin_until(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        """Run callbacks until `condition` holds (True), or the time is over or `stop` was called (False)."""
        deadline_s = time.monotonic() + timeout_s
        while not condition():
            left_s = deadline_s - time.monotonic()
            if left_s <= 0.0 or self._stopped.is_set() or not rclpy.ok():
                return False
            self.executor.spin_once(timeout_sec=min(left_s, SPIN_PERIOD_S))
        return True

    def close(self) -> None:
        """Spin no more and let go of the nodes, which are destroyed after this, not before.

        What an executor holds of a node outlives the node's destruction. The middleware's threads would go on
        while the process leaves, and it can die of that, by signal 11, after its last word.
        """
        self.executor.shutdown()


def stop_on_signals(stop: Callable[[], None]) -> None:
    """Call `stop`, from a thread of its own, when a signal to stop comes.

    Python runs its signal handlers between bytecodes of the main thread, which may wait in C++ for long;
    the wake-up descriptor is written at once, whatever thread the system delivers the signal to.
    """
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    for number in STOP_SIGNALS:
        signal.signal(number, lambda *_: None)
    signal.set_wakeup_fd(writer, warn_on_full_buffer=False)

    def wait() -> None:
        while os.read(reader, 1):
            stop()

    threading.Thread(target=wait, daemon=True, name="signals").start()


def stop_with_parent(stop: Callable[[], None]) -> None:
    """Call `stop` when the process that started this one is gone, if it set `PARENT_HOLDS_STDIN`.

    The parent holds the other end of our standard input, which ends with it, however it ends: a robot must
    not drive on when the graph that supervises it was killed.
    """
    if os.environ.pop(PARENT_HOLDS_STDIN, "") != "1":
        return

    def wait() -> None:
        while os.read(sys.stdin.fileno(), 1):
            pass
        stop()

    threading.Thread(target=wait, daemon=True, name="parent").start()


def run_nodes(factories: Sequence[Callable[[], GraphNode[Any]]], argv: Sequence[str] | None = None) -> int:
    """Run one or several nodes in one executor until SIGINT or SIGTERM; returns the exit code.

    The nodes that were not told otherwise (`autostart`) are configured and activated; at the end they are
    shut down in reverse order, and those that listen on (the recorder) hear the last words of the others.
    A node whose work is done (`exit_code`) ends it as a signal does, and its exit code is returned.
    """
    prepare_environment()
    try:
        rclpy.init(
            args=list(argv) if argv is not None else None, signal_handler_options=SignalHandlerOptions.NO
        )
    except RCLError as error:  # arguments or a parameter file that cannot be read
        print(f"robustnav: {error}", file=sys.stderr)
        return WRONG_USAGE
    spinner = Spinner(EventsExecutor())

    stop_on_signals(spinner.stop)
    stop_with_parent(spinner.stop)
    nodes: list[GraphNode[Any]] = []
    try:
        for make in factories:
            nodes.append(make())
            spinner.executor.add_node(nodes[-1])
        for node in nodes:
            if node.autostart:
                node.trigger_configure()
                if node.state_id == State.PRIMARY_STATE_INACTIVE:
                    node.trigger_activate()
        spinner.spin(lambda: any(node.exit_code is not None for node in nodes))
        leaving = [node for node in reversed(nodes) if not node.listen_on_s]
        for node in leaving:  # each may take long to clean up: first all stop what they do
            if node.is_active:
                node.trigger_deactivate()
        for node in leaving:
            _shut_down(node)
        spinner.listen(max(node.listen_on_s for node in nodes))
        return max(node.exit_code or 0 for node in nodes)
    except RobustnavError as error:
        print(f"robustnav: {error}", file=sys.stderr)
        return WRONG_USAGE if isinstance(error, BadParameterError) else 1
    finally:
        for node in reversed(nodes):
            _shut_down(node)
        spinner.close()
        for node in reversed(nodes):
            node.destroy_node()
        rclpy.try_shutdown()


def _shut_down(node: GraphNode[Any]) -> None:
    if node.state_id != State.PRIMARY_STATE_FINALIZED:
        node.trigger_shutdown()
