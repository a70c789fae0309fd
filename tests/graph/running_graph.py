"""A whole graph as processes, followed from outside, for tests."""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.publisher import Publisher

from robustnav_msgs_py import contract
from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.records import Decision, SearchPhase, SearchState
from robustnav_nodes.graph import qos
from robustnav_nodes.graph.message_class import message_class
from robustnav_nodes.graph.processes import STOPPED_FIRST, ProcessGraph
from robustnav_nodes.graph.search_graph import RunPlan
from robustnav_nodes.graph.spin import Spinner
from robustnav_nodes.graph.watcher import RunWatcher

LOOK_S = 0.1
SAY_TIMES = 10
SAY_AGAIN_S = 3.0
ENDED = (SearchPhase.FOUND, SearchPhase.NOT_FOUND, SearchPhase.STOPPED)


class RunningGraph:
    """The processes, and what the watcher heard of them."""

    def __init__(self, plan: RunPlan, folder: Path) -> None:
        self.plan = plan
        self.states: list[SearchState] = []
        self.decisions: list[Decision] = []
        self.chat: list[tuple[str, str]] = []
        self.lines: list[str] = []
        self.events: list[str] = []
        self._voice: Publisher | None = None
        self.processes = ProcessGraph(
            plan.process_plans(plan.write_parameters(folder / "parameters.yaml")),
            lambda name, line: self.lines.append(f"{name}: {line}"),
            self.events.append,
        )
        self._spinner = Spinner(EventsExecutor())
        self.watcher = RunWatcher(
            on_state=self.states.append,
            on_decision=self.decisions.append,
            on_chat=lambda who, line: self.chat.append((who, line)),
        )
        self._spinner.executor.add_node(self.watcher)

    @property
    def search(self) -> SearchState:
        """The latest state of the search."""
        return self.states[-1] if self.states else SearchState()

    def wait(self, condition: Callable[[], Any], what: str, timeout_s: float = 60.0) -> None:
        """Follow the run, bringing back what died, until `condition` holds."""
        looks = int(timeout_s / LOOK_S)
        for _ in range(looks):
            if self._spinner.spin_until(condition, LOOK_S):
                return
            self.processes.tend()
        lines = "\n".join(self.lines[-40:])
        raise AssertionError(
            f"waited in vain for {what}; {self.search}; {self.chat[-5:]}; the nodes said:\n{lines}"
        )

    def wait_until_active(self, *executables: str) -> None:
        """Until each of these has said that it is active."""
        for name in executables or [row.executable for row in self.plan.nodes]:
            self.wait(
                lambda name=name: any(f"{name} is active" in line for line in self.lines),
                f"{name} to be active",
            )

    def say(self, line: str) -> None:
        """Say a line to the robot, again if need be (its dialogue may have been killed), until it answers."""
        if self._voice is None:
            row = contract.topic("chat/from_user")
            self._voice = self.watcher.create_publisher(
                message_class(row.type), row.name, qos.offered(row.qos)
            )
        heard = len(self.chat)
        for _ in range(SAY_TIMES):
            self._voice.publish(wire.text_to_message(line))
            if self._spinner.spin_until(lambda: ("person", line) in self.chat[heard:], SAY_AGAIN_S):
                return
            self.processes.tend()
        raise AssertionError(f"the robot did not hear {line!r}; {self.chat[-5:]}")

    def search_again(self, target: str) -> None:
        """Ask for `target` when the last search has ended, until the dialogue knows so too."""
        for _ in range(SAY_TIMES):
            self.say(f"find the {target}")
            if self._spinner.spin_until(lambda: not self.has_ended(), SAY_AGAIN_S):
                return
        raise AssertionError(f"no search began again; {self.chat[-5:]}")

    def close(self) -> None:
        """Follow it no longer."""
        self._spinner.close()
        self.watcher.destroy_node()

    def has_ended(self) -> bool:
        """Whether the search is over."""
        return self.search.phase in ENDED

    def kill(self, *executables: str) -> None:
        """SIGKILL nodes, and wait until they have come back."""
        said = {name: self._times_active(name) for name in executables}
        for name in executables:
            os.kill(self.processes.pid(name), signal.SIGKILL)
        for name in executables:
            self.wait(lambda name=name: self._times_active(name) > said[name], f"{name} to come back")

    def _times_active(self, executable: str) -> int:
        return sum(f"{executable} is active" in line for line in self.lines)


@contextmanager
def running_graph(folder: Path, **settings: Any) -> Iterator[RunningGraph]:
    """A graph with a bag in `folder`/bag; stopped at the end, in order; exit codes checked."""
    speed = settings.pop("speed", 5.0)
    parameters = {"sim_bridge": {"real_time_factor": speed}, **settings.pop("parameters", {})}
    plan = RunPlan(bag=folder / "bag", parameters=parameters, **settings)
    rclpy.init(args=[])
    graph = RunningGraph(plan, folder)
    graph.processes.start()
    try:
        yield graph
    finally:
        codes = graph.processes.stop(first=STOPPED_FIRST)
        graph.close()
        rclpy.try_shutdown()
    assert set(codes.values()) == {0}, (codes, graph.lines[-20:])
