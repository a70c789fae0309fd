"""The demo: one search in a simulated home, shown while it runs, recorded, and summed up from its bag."""

from dataclasses import dataclass
from pathlib import Path

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from rich.console import Console

from robustnav_msgs_py.records import SearchState
from robustnav_nodes.graph.demo_screen import DemoScreen
from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.processes import STOPPED_FIRST, ProcessGraph
from robustnav_nodes.graph.search_graph import RunPlan
from robustnav_nodes.graph.shared_memory import clean_shared_memory
from robustnav_nodes.graph.spin import Spinner, stop_on_signals
from robustnav_nodes.graph.watcher import RunWatcher

LOOK_PERIOD_S = 0.2
FAREWELL_S = 3.0  # for the person's thanks to be said, and recorded


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoEnd:
    """How the demo ended: the last state of the search, and whether it was the end or the time was over."""

    search: SearchState
    timed_out: bool
    interrupted: bool
    wall_s: float
    restarts: int


class Demo:
    """Starts the graph as processes, shows what the robot does and believes, stops it when the search ends.

    With `timeout_s` None it goes on, search after search, until it is interrupted.
    """

    def __init__(self, plan: RunPlan, *, console: Console, log_folder: Path, timeout_s: float | None) -> None:
        self._plan = plan
        self._screen = DemoScreen(console)
        self._log_folder = log_folder
        self._timeout_s = timeout_s
        self._restarts = 0

    def run(self) -> DemoEnd:
        """Run the demo to its end; raises RobustnavError where the graph cannot be started."""
        prepare_environment(local=True)
        clean_shared_memory()
        screen = self._screen
        files = self._plan.write_parameters(self._log_folder / "parameters.yaml")
        logs = {row.executable: self._log_folder / f"{row.executable}.log" for row in self._plan.nodes}
        for log in logs.values():
            log.unlink(missing_ok=True)

        def on_line(executable: str, line: str) -> None:
            with logs[executable].open("a", encoding="utf-8") as log:
                log.write(line + "\n")
            if "[ERROR]" in line or "[FATAL]" in line or line.startswith("robustnav:"):
                screen.say(f"[red]{executable}:[/] ", line)

        graph = ProcessGraph(self._plan.process_plans(files), on_line, self._on_event)
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        spinner = Spinner(EventsExecutor())
        stop_on_signals(spinner.stop)
        watcher = RunWatcher(on_state=screen.on_state, on_decision=screen.on_decision, on_chat=screen.on_chat)
        spinner.executor.add_node(watcher)
        graph.start()
        try:
            timed_out = self._follow(graph, spinner)
        finally:
            screen.say("[dim]closing the bag and stopping the nodes[/]", "")
            graph.stop(first=STOPPED_FIRST)
            spinner.close()
            watcher.destroy_node()
            rclpy.try_shutdown()
            clean_shared_memory()
        return DemoEnd(
            search=screen.search,
            timed_out=timed_out,
            interrupted=spinner.stopped,
            wall_s=screen.elapsed_s,
            restarts=self._restarts,
        )

    def _follow(self, graph: ProcessGraph, spinner: Spinner) -> bool:
        """Until the search has ended or the time is over (True)."""
        screen, with_person = self._screen, self._plan.with_simulated_user
        while not spinner.stopped:
            if self._timeout_s is not None and screen.elapsed_s > self._timeout_s:
                return True
            if spinner.spin_until(self._is_over, LOOK_PERIOD_S):
                spinner.spin_until(lambda: screen.is_said(with_person=with_person), FAREWELL_S)
                return False
            graph.tend()
        return False

    def _is_over(self) -> bool:
        return self._timeout_s is not None and self._screen.is_over

    def _on_event(self, sentence: str) -> None:
        self._restarts += 1
        self._screen.say("[red]graph:[/] ", sentence)
