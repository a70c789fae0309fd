"""Run the nodes of the graph as processes: start them, bring back those that die, stop them in order."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from robustnav_nodes.graph.spin import PARENT_HOLDS_STDIN, WRONG_USAGE

# The others notice one to three seconds after a kill that the killed one's port in shared memory is dead. A
# new process that takes the same port just then can lose it to a race in Fast DDS, and is deaf from then on.
FIRST_BACK_OFF_S = 4.0
LONGEST_BACK_OFF_S = 16.0
STEADY_AFTER_S = 30.0  # a process that has run this long has recovered: its next back-off is the first again
STOP_TIMEOUT_S = 40.0  # longer than the recorder takes at most to close its bag
STOPPED_FIRST = ("planner", "recorder")  # the robot stands; that goes into the bag; then the others


@dataclass(frozen=True, slots=True, kw_only=True)
class ProcessPlan:
    """One node to run: package, executable, and the arguments after `--ros-args`."""

    package: str
    executable: str
    ros_arguments: tuple[str, ...] = ()

    @property
    def command(self) -> list[str]:
        """The command line; the interpreter is this one, whatever PATH says."""
        run = [sys.executable, "-m", "robustnav_nodes", "run", self.package, self.executable]
        return [*run, "--ros-args", *self.ros_arguments] if self.ros_arguments else run


@dataclass(slots=True)
class _Running:
    plan: ProcessPlan
    process: "subprocess.Popen[str]"
    started_s: float
    back_off_s: float = FIRST_BACK_OFF_S
    restart_at_s: float | None = None
    reader: threading.Thread | None = None
    given_up: bool = False


@dataclass(slots=True)
class ProcessGraph:
    """The processes of one graph; owned by the thread that calls `start`, `tend` and `stop`.

    `on_line(executable, line)` gets each line a process prints (called from reader threads);
    `on_event(sentence)` hears when a process died or came back.
    """

    plans: Sequence[ProcessPlan]
    on_line: Callable[[str, str], None]
    on_event: Callable[[str], None]
    _running: list[_Running] = field(default_factory=list)

    def start(self) -> None:
        """Start every process."""
        self._running = [_Running(plan, self._spawn(plan), time.monotonic()) for plan in self.plans]
        for running in self._running:
            self._read(running)

    def tend(self) -> None:
        """Bring back what has died, after its back-off; call it a few times a second."""
        now = time.monotonic()
        for running in self._running:
            code = running.process.poll()
            if code is None:
                continue
            if code == WRONG_USAGE:  # it would only say the same again
                if not running.given_up:
                    running.given_up = True
                    self.on_event(f"{running.plan.executable} cannot run as it was told to; it stays away")
                continue
            if running.restart_at_s is None:
                if now - running.started_s > STEADY_AFTER_S:
                    running.back_off_s = FIRST_BACK_OFF_S
                running.restart_at_s = now + running.back_off_s
                self.on_event(
                    f"{running.plan.executable} {_end(code)}; it starts again in {running.back_off_s:g} s"
                )
            elif now >= running.restart_at_s:
                running.process, running.started_s = self._spawn(running.plan), now
                running.back_off_s = min(2.0 * running.back_off_s, LONGEST_BACK_OFF_S)
                running.restart_at_s = None
                self._read(running)

    def pid(self, executable: str) -> int:
        """Process id of a running executable."""
        return next(item.process.pid for item in self._running if item.plan.executable == executable)

    def stop(self, first: Sequence[str] = ()) -> dict[str, int]:
        """Stop `first` one after the other, then the rest all at once; returns exit codes.

        A process that does not leave on SIGINT in `STOP_TIMEOUT_S` is killed, and said to have been.
        """
        for name in first:
            self._stop([item for item in self._running if item.plan.executable == name])
        self._stop([item for item in self._running if item.plan.executable not in first])
        codes = {item.plan.executable: item.process.returncode for item in self._running}
        self._running = []
        return codes

    def _stop(self, leaving: Sequence[_Running]) -> None:
        for running in leaving:
            if running.process.poll() is None:
                running.process.send_signal(signal.SIGINT)
        deadline = time.monotonic() + STOP_TIMEOUT_S
        for running in leaving:
            try:
                running.process.wait(timeout=max(0.0, deadline - time.monotonic()))
            except subprocess.TimeoutExpired:
                self.on_event(f"{running.plan.executable} did not leave in {STOP_TIMEOUT_S:g} s; killing it")
                with contextlib.suppress(ProcessLookupError):  # it may have left just now
                    os.killpg(running.process.pid, signal.SIGKILL)
                running.process.wait()
            if running.process.stdin is not None:
                running.process.stdin.close()
            if running.reader is not None:
                running.reader.join()

    def _spawn(self, plan: ProcessPlan) -> "subprocess.Popen[str]":
        # a session of its own: Ctrl-C in the terminal reaches us alone, and we stop the nodes in order
        return subprocess.Popen(
            plan.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            start_new_session=True,
            env={**os.environ, PARENT_HOLDS_STDIN: "1"},
        )

    def _read(self, running: _Running) -> None:
        stream, name = running.process.stdout, running.plan.executable
        assert stream is not None

        def read() -> None:
            with stream:
                for line in stream:
                    self.on_line(name, line.rstrip("\n"))

        running.reader = threading.Thread(target=read, daemon=True, name=f"output of {name}")
        running.reader.start()


def _end(code: int) -> str:
    return f"was ended by {signal.Signals(-code).name}" if code < 0 else f"left with code {code}"
