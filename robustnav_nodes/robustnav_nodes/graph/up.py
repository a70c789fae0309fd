"""`robustnav up`: the graph until it is stopped."""

import signal
import threading
from pathlib import Path

from rich.console import Console

from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.one_process import run_in_one_process
from robustnav_nodes.graph.processes import STOPPED_FIRST, ProcessGraph
from robustnav_nodes.graph.search_graph import RunPlan
from robustnav_nodes.graph.shared_memory import clean_shared_memory
from robustnav_nodes.graph.spin import stop_on_signals

TEND_PERIOD_S = 0.2


def run_graph(plan: RunPlan, console: Console, *, log_folder: Path, one_process: bool) -> int:
    """Run the nodes of `plan` until SIGINT or SIGTERM, each line they print with their name; returns 0 or 1.

    1 means that a process did not leave cleanly.
    """
    prepare_environment()
    clean_shared_memory()
    files = plan.write_parameters(log_folder / "parameters.yaml")
    if one_process:
        return run_in_one_process(plan, files)

    def show(executable: str, line: str) -> None:
        console.print(f"[dim]{executable:>14}[/] ", end="")
        console.print(line, markup=False, soft_wrap=True)

    graph = ProcessGraph(plan.process_plans(files), show, lambda sentence: show("graph", sentence))
    stopped = threading.Event()
    stop_on_signals(stopped.set)
    graph.start()
    try:
        while not stopped.wait(TEND_PERIOD_S):
            graph.tend()
    finally:
        codes = graph.stop(first=STOPPED_FIRST)
        clean_shared_memory()
    # one that was still starting had nothing to end cleanly
    return 0 if all(code in (0, -signal.SIGINT) for code in codes.values()) else 1
