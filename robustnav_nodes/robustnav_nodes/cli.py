"""The command `robustnav`. Exit codes: 0 done, 1 the run failed (with one sentence), 2 wrong usage."""

import signal
import sys
import time
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from robustnav_msgs_py.errors import BadParameterError, RobustnavError
from robustnav_nodes.benchmarks.bench_commands import bench_app
from robustnav_nodes.benchmarks.data_commands import data_app
from robustnav_nodes.benchmarks.instruction_commands import instruction_app
from robustnav_nodes.benchmarks.train_commands import train_app

app = typer.Typer(
    help="Ask a robot to find an object; it works although the detector lies.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
app.add_typer(bench_app, name="bench")
app.add_typer(data_app, name="data")
app.add_typer(train_app, name="train")
app.add_typer(instruction_app, name="instruction")

DEMO_SPEED = 4.0
DEMO_LIMIT_S = 110.0  # at that speed; slower ones take longer
FIRST_COMPILE_S = 130.0  # on a busy machine
LOCKSTEP_LIMIT_S = 600.0  # of simulated time
MAX_SEED = 2**31 - 1


class Scenario(StrEnum):
    """What the demo shows."""

    SEARCH = "search"


class User(StrEnum):
    """Who talks to the robot."""

    SIMULATED = "simulated"
    HUMAN = "human"


def _console() -> Console:
    return Console(highlight=False)


@app.command()
def demo(
    scenario: Annotated[Scenario, typer.Option(help="what to show")] = Scenario.SEARCH,
    user: Annotated[
        User, typer.Option(help="who asks: a simulated person, or you (robustnav chat)")
    ] = User.SIMULATED,
    seed: Annotated[
        int, typer.Option(min=0, max=MAX_SEED, help="decides the home, the object and the detector's errors")
    ] = 1,
    bag: Annotated[Path | None, typer.Option(help="folder of the bag; default runs/demo_DATE")] = None,
    target: Annotated[str, typer.Option(help="class of the object to ask for; default: by seed")] = "",
    speed: Annotated[float, typer.Option(min=0.1, max=20.0, help="simulated seconds a second")] = DEMO_SPEED,
    params: Annotated[Path | None, typer.Option(help="ROS parameter file (YAML)")] = None,
    lockstep: Annotated[
        bool,
        typer.Option("--lockstep", help="in one process, as fast as it goes, the same each time"),
    ] = False,
) -> None:
    """Run one search in a simulated home, record it, and sum it up from the bag."""
    from bags.demo_summary import show_summary
    from robustnav_nodes.graph.demo import Demo
    from robustnav_nodes.graph.search_graph import RunPlan

    console = _console()
    folder = _new_bag(bag, "demo")
    logs = folder.parent / f"{folder.name}_logs"
    human = user is User.HUMAN
    if human and lockstep:
        raise BadParameterError("a person cannot keep step with --lockstep; leave one of the two out")
    plan = RunPlan(
        seed=seed,
        with_simulated_user=not human,
        bag=folder,
        user_parameters=params,
        parameters={
            "sim_bridge": {"real_time_factor": 1.0 if lockstep else speed},
            "simulated_user": {"target": target},
        },
    )
    if lockstep:
        from bags.lockstep_demo import run_lockstep_demo

        console.print(f"robustnav demo: {scenario.value} in a simulated home, seed {seed}, in lock-step")
        end = run_lockstep_demo(plan, bag=folder, console=console, log_folder=logs, limit_s=LOCKSTEP_LIMIT_S)
        if not show_summary(console, end, folder, logs):
            raise typer.Exit(1)
        return
    console.print(
        f"robustnav demo: {scenario.value} in a simulated home, seed {seed}, {speed:g} times real time"
    )
    if human:
        console.print(
            "talk to the robot from another terminal: [bold]robustnav chat[/]   (Ctrl-C here ends the demo)"
        )
    else:
        console.print("[dim]starting 8 nodes, a process each; the first time, numba compiles the planner[/]")
    limit_s = FIRST_COMPILE_S + DEMO_LIMIT_S * max(1.0, DEMO_SPEED / speed)
    end = Demo(plan, console=console, log_folder=logs, timeout_s=None if human else limit_s).run()
    if not show_summary(console, end, folder, logs):
        raise typer.Exit(1)


@app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})
def up(
    context: typer.Context,
    params: Annotated[Path | None, typer.Option(help="ROS parameter file (YAML)")] = None,
    one_process: Annotated[bool, typer.Option("--one-process", help="all nodes in this process")] = False,
    no_record: Annotated[bool, typer.Option("--no-record", help="record nothing")] = False,
    sim: Annotated[bool, typer.Option(help="with the simulated home; --no-sim on a robot")] = True,
    user: Annotated[User, typer.Option(help="who asks")] = User.HUMAN,
    seed: Annotated[
        int | None, typer.Option(min=0, max=MAX_SEED, help="decides the home and all else left to chance")
    ] = None,
    bag: Annotated[Path | None, typer.Option(help="folder of the bag; default runs/run_DATE")] = None,
) -> None:
    """Run the graph until stopped (Ctrl-C).

    What follows --ros-args goes to every node: robustnav up --ros-args -r __ns:=/robot1 -r odom:=pose.
    """
    from robustnav_nodes.graph.search_graph import RunPlan
    from robustnav_nodes.graph.up import run_graph

    folder = _new_bag(bag, "run")
    if context.args and context.args[0] != "--ros-args":
        raise BadParameterError(f"what is {context.args[0]!r}? Arguments for the nodes follow --ros-args")
    plan = RunPlan(
        seed=seed,
        with_simulation=sim,
        with_simulated_user=user is User.SIMULATED,
        bag=None if no_record else folder,
        user_parameters=params,
        parameters={},
        ros_arguments=tuple(context.args[1:]),
    )
    code = run_graph(
        plan, _console(), log_folder=folder.parent / f"{folder.name}_logs", one_process=one_process
    )
    raise typer.Exit(code)


@app.command(
    context_settings={"allow_extra_args": True, "ignore_unknown_options": True, "help_option_names": []}
)
def run(context: typer.Context, package: str, executable: str) -> None:
    """Start one node, as `ros2 run PACKAGE EXECUTABLE` does."""
    raise typer.Exit(_run(package, executable, context.args))


@app.command()
def chat() -> None:
    """Talk to the robot from this terminal."""
    from robustnav_nodes.chat.terminal import chat as talk

    raise typer.Exit(talk(_console()))


@app.command()
def doctor() -> None:
    """Say what is missing, mismatched or slow on this machine, and the remedy."""
    from robustnav_nodes.graph.doctor import Finding, examine
    from robustnav_nodes.graph.environment import prepare_environment

    prepare_environment()
    table = Table("", "what", "found", "remedy")
    findings = examine()
    marks = {
        Finding.Level.OK: "[green]ok[/]",
        Finding.Level.NOTE: "[yellow]note[/]",
        Finding.Level.BAD: "[red]bad[/]",
    }
    for finding in findings:
        table.add_row(marks[finding.level], finding.what, finding.found, finding.remedy)
    _console().print(table)
    if any(finding.level is Finding.Level.BAD for finding in findings):
        raise typer.Exit(1)


def _new_bag(bag: Path | None, kind: str) -> Path:
    """The folder of this run's bag; raises BadParameterError where it exists already."""
    folder = bag or Path("runs") / f"{kind}_{time.strftime('%Y%m%d_%H%M%S')}"
    if folder.exists():
        raise BadParameterError(f"the bag {str(folder)!r} exists already; name another one with --bag")
    return folder


def _run(package: str, executable: str, arguments: list[str]) -> int:
    from robustnav_nodes.graph.environment import prepare_environment
    from robustnav_nodes.graph.executables import run_executable

    prepare_environment()
    return run_executable(package, executable, arguments)


@cache
def command_line() -> typer.Typer:
    """All commands; those on bags are their package's, which stands on this one."""
    from bags.bag_commands import bag_app

    app.add_typer(bag_app, name="bag")
    return app


def main() -> int:
    """Entry point; errors that robustnav raises on purpose become one sentence."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # Ctrl-C during start-up needs no traceback
    try:
        command_line()()
    except BadParameterError as error:
        print(f"robustnav: {error}", file=sys.stderr)
        return 2
    except RobustnavError as error:
        print(f"robustnav: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
