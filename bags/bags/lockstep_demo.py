"""The demo in lock-step: one process, as fast as the machine can, the same messages each time."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console

from bags.lockstep_recording import LockstepRecording
from robustnav_msgs_py.conversions import record_from_message, text_from_message
from robustnav_msgs_py.records import Decision, SearchState
from robustnav_nodes.graph.demo import FAREWELL_S, DemoEnd
from robustnav_nodes.graph.demo_screen import DemoScreen
from robustnav_nodes.graph.lockstep import NS_PER_S, Said
from robustnav_nodes.graph.lockstep_run import LockstepRun
from robustnav_nodes.graph.search_graph import RunPlan


def run_lockstep_demo(
    plan: RunPlan, *, bag: Path, console: Console, log_folder: Path, limit_s: float
) -> DemoEnd:
    """Run one search of `plan` in this process and record it; `limit_s` is simulated time.

    Raises RobustnavError where the bag cannot be written or a node does not come up.
    """
    files = plan.write_parameters(log_folder / "parameters.yaml")
    with LockstepRecording(bag) as recording:
        now_s = 0.0
        screen = DemoScreen(console, lambda: now_s)
        show: Mapping[str, Callable[[Any], None]] = {
            "search/state": lambda message: screen.on_state(record_from_message(message, SearchState)),
            "planner/decision": lambda message: screen.on_decision(record_from_message(message, Decision)),
            "chat/from_user": lambda message: screen.on_chat("person", text_from_message(message)),
            "chat/to_user": lambda message: screen.on_chat("robot", text_from_message(message)),
        }

        def watch(said: Said) -> None:
            nonlocal now_s
            now_s = said.time_ns / NS_PER_S
            recording.take(said)
            show.get(said.row.name, lambda _: None)(said.message)

        with LockstepRun(plan, files, watch) as run:
            recording.note_parameters(run)
            in_time = run.run(lambda: screen.is_over, limit_s)
            run.run(partial(screen.is_said, with_person=plan.with_simulated_user), FAREWELL_S)
    return DemoEnd(
        search=screen.search,
        timed_out=not in_time,
        interrupted=False,
        wall_s=screen.elapsed_s,
        restarts=0,
    )
