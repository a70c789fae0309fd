"""The demo: one search in a simulated home, shown while it runs, recorded, and summed up from its bag."""

import time
from dataclasses import dataclass
from pathlib import Path

import rclpy
from rclpy.experimental import EventsExecutor
from rclpy.signals import SignalHandlerOptions
from rich.console import Console

from robustnav_msgs_py.records import Decision, SearchPhase, SearchState
from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.processes import STOPPED_FIRST, ProcessGraph
from robustnav_nodes.graph.search_graph import RunPlan
from robustnav_nodes.graph.shared_memory import clean_shared_memory
from robustnav_nodes.graph.spin import Spinner, stop_on_signals
from robustnav_nodes.graph.watcher import RunWatcher

LOOK_PERIOD_S = 0.2
STEPS_PER_LINE = 3
FAREWELL_S = 3.0  # for the person's thanks to be said, and recorded
ENDED = (SearchPhase.FOUND, SearchPhase.NOT_FOUND, SearchPhase.STOPPED)


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
        self._console = console
        self._log_folder = log_folder
        self._timeout_s = timeout_s
        self._search = SearchState()
        self._told, self._thanked = False, False
        self._restarts = 0
        self._shown_step = 0
        self._began_s = time.monotonic()

    def run(self) -> DemoEnd:
        """Run the demo to its end; raises RobustnavError where the graph cannot be started."""
        prepare_environment(local=True)
        clean_shared_memory()
        files = self._plan.write_parameters(self._log_folder / "parameters.yaml")
        logs = {row.executable: self._log_folder / f"{row.executable}.log" for row in self._plan.nodes}
        for log in logs.values():
            log.unlink(missing_ok=True)

        def on_line(executable: str, line: str) -> None:
            with logs[executable].open("a", encoding="utf-8") as log:
                log.write(line + "\n")
            if "[ERROR]" in line or "[FATAL]" in line or line.startswith("robustnav:"):
                self._say(f"[red]{executable}:[/] ", line)

        graph = ProcessGraph(self._plan.process_plans(files), on_line, self._on_event)
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        spinner = Spinner(EventsExecutor())
        stop_on_signals(spinner.stop)
        watcher = RunWatcher(on_state=self._on_state, on_decision=self._on_decision, on_chat=self._on_chat)
        spinner.executor.add_node(watcher)
        graph.start()
        try:
            timed_out = self._follow(graph, spinner)
        finally:
            self._say("[dim]closing the bag and stopping the nodes[/]", "")
            graph.stop(first=STOPPED_FIRST)
            watcher.destroy_node()
            rclpy.try_shutdown()
            clean_shared_memory()
        return DemoEnd(
            search=self._search,
            timed_out=timed_out,
            interrupted=spinner.stopped,
            wall_s=time.monotonic() - self._began_s,
            restarts=self._restarts,
        )

    def _follow(self, graph: ProcessGraph, spinner: Spinner) -> bool:
        """Until the search has ended or the time is over (True)."""
        while not spinner.stopped:
            if self._timeout_s is not None and time.monotonic() - self._began_s > self._timeout_s:
                return True
            if spinner.spin_until(self._is_over, LOOK_PERIOD_S):
                spinner.spin_until(self._is_said, FAREWELL_S)
                return False
            graph.tend()
        return False

    def _is_said(self) -> bool:
        """Whether the robot has told the end, and the person has thanked."""
        return self._told and (self._thanked or not self._plan.with_simulated_user)

    def _is_over(self) -> bool:
        return self._timeout_s is not None and self._search.phase in ENDED

    def _on_state(self, search: SearchState) -> None:
        before, self._search = self._search, search
        if search.phase != before.phase and search.phase is not SearchPhase.IDLE:
            self._say(
                f"[bold cyan]{search.phase.replace('_', ' ')}[/] ", f"{search.target}  {search.message}"
            )
        if search.episode != before.episode:
            self._shown_step = 0

    def _on_decision(self, decision: Decision) -> None:
        if decision.step - self._shown_step < STEPS_PER_LINE and decision.step > 1:
            return
        self._shown_step = decision.step
        here = f"at ({decision.x_m:4.1f}, {decision.y_m:4.1f}) m"
        best = self._search
        likely = f"likeliest p {best.p_best:.3f} at ({best.best_x_m:.1f}, {best.best_y_m:.1f})"
        self._say(
            f"step {decision.step:3d}  ",
            f"{here}  {decision.action:10s} {likely}  in view {decision.p_in_view:.3f} of {decision.tau:.3f}"
            f"  unsure {100 * decision.entropy:3.0f} %",
        )

    def _on_chat(self, who: str, line: str) -> None:
        self._say(f"[bold {'green' if who == 'person' else 'yellow'}]{who}:[/] ", line)
        if self._search.phase in ENDED:
            self._thanked = self._thanked or who == "person"
            self._told = self._told or who == "robot"

    def _on_event(self, sentence: str) -> None:
        self._restarts += 1
        self._say("[red]graph:[/] ", sentence)

    def _say(self, styled: str, text: str) -> None:
        clock = time.monotonic() - self._began_s
        self._console.print(f"[dim]{clock:5.1f} s[/] {styled}", end="")
        self._console.print(text, markup=False, highlight=False, soft_wrap=True)
