"""`robustnav bench`: measure, and say how surely."""

import os
import signal
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.benchmarks.detection_command import detection_command
from robustnav_nodes.benchmarks.home_command import homes_command
from robustnav_nodes.benchmarks.instruction_command import instruction_command
from robustnav_nodes.benchmarks.recorder_command import recorder_command
from robustnav_nodes.benchmarks.variant_command import variants_command

if TYPE_CHECKING:
    from robustnav_nodes.benchmarks.contestants import Contestant
    from robustnav_nodes.benchmarks.search_bench import SearchRow
    from robustnav_nodes.benchmarks.search_plan import PlayedEpisode, SceneJob

bench_app = typer.Typer(
    help="Measure planners, detectors, instruction errors, the simulator and the recorder.",
    no_args_is_help=True,
)
bench_app.command("variants")(variants_command)
bench_app.command("detection")(detection_command)
bench_app.command("instruction")(instruction_command)
bench_app.command("homes")(homes_command)
bench_app.command("recorder")(recorder_command)

JsonFile = Annotated[Path | None, typer.Option("--json", help="write the figures to this file too")]
MAX_SEED = 2**31 - 1
DEFAULT_SUITE = "all"


@bench_app.command("search")
def search_command(
    suite: Annotated[
        str | None,
        typer.Option(help="all, or one of easy-, medium-, hard- with perfect or noisy: hard-noisy"),
    ] = None,
    scenes: Annotated[
        Path | None, typer.Option(help="instead of a suite: a folder of scene files (*.npz)")
    ] = None,
    target_id: Annotated[
        int | None,
        typer.Option(min=0, help="the object, where --scenes is a folder of the released POMP-BE-PD planner"),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="decides scenes and episodes")] = 1,
    episodes: Annotated[
        int, typer.Option(min=0, help="for each difficulty and detector; 0: only --graph")
    ] = 200,
    planners: Annotated[str | None, typer.Option(help="a,b,c; default: all of them")] = None,
    simulations: Annotated[int, typer.Option(min=8, max=1_000_000, help="of POMCP, for one decision")] = 1024,
    dock: Annotated[
        bool, typer.Option(help="success is a stop where the target is docked at, not in view")
    ] = False,
    workers: Annotated[int | None, typer.Option(min=1, help="processes; default: one for each core")] = None,
    ray: Annotated[
        str | None, typer.Option(help="on a Ray cluster instead: its address, 'auto' or 'local'")
    ] = None,
    graph: Annotated[int, typer.Option(min=0, help="besides, this many searches through the ROS graph")] = 0,
    plots: Annotated[Path | None, typer.Option(help="folder to draw pictures into")] = None,
    json_file: JsonFile = None,
) -> None:
    """Compare planners on episodes that the seed decides: SR, SPL, errors, each with a 95 % interval."""
    from robustnav_nodes.benchmarks.contestants import DEFAULT, NAMES, contestants
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report
    from robustnav_nodes.benchmarks.search_bench import as_json, gains, search_rows, settings_of
    from robustnav_nodes.benchmarks.search_table import show_rows

    if suite is not None and scenes is not None:
        raise BadParameterError("--suite makes its scenes, --scenes reads them: give one of the two")
    if target_id is not None and scenes is None:
        raise BadParameterError("--target-id is the object of a folder: name the folder with --scenes")
    if episodes == 0 and graph == 0:
        raise BadParameterError("--episodes 0 leaves nothing to do but --graph N, which is not given")
    names = [name.strip() for name in planners.split(",")] if planners is not None else list(NAMES)
    chosen = contestants(names, dock=dock, simulations=simulations)
    check_writable(json_file)
    if plots is not None:
        _make_folder(plots)

    console = _console()
    jobs = _jobs(suite, scenes, target_id, seed=seed, episodes=episodes, contestants=chosen)
    began_s = time.monotonic()
    played = _play(jobs, workers or os.cpu_count() or 1, ray)
    rows, gained = search_rows(played, names), gains(played)
    if graph > 0:
        rows.append(_graph_row(console, graph, seed))
    wall_s = time.monotonic() - began_s
    show_rows(console, rows, gained, dock=dock)
    console.print(f"[dim]{len(played) + graph} searches, {wall_s:.0f} s[/]")
    if json_file is not None:
        write_report(
            json_file,
            "search",
            suite=str(scenes or suite or DEFAULT_SUITE),
            seed=seed,
            episodes=episodes,
            default_planner=DEFAULT,
            settings={**settings_of(jobs, chosen), "graph_seeds": list(range(seed, seed + graph))},
            rows=as_json(rows),
            gains=as_json(gained),
            wall_s=round(wall_s, 1),
        )
    if plots is not None and jobs:
        _draw(console, jobs, played, plots)


@bench_app.command("planner")
def planner_command(
    sizes: Annotated[str, typer.Option(help="poses, and about as many candidates")] = "100,1000,10000,100000",
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="decides the floors")] = 1,
    plot: Annotated[Path | None, typer.Option(help="PNG file of how time and memory grow")] = None,
    json_file: JsonFile = None,
) -> None:
    """How time and memory of a decision grow with the search space; one core, a process for each size."""
    from dataclasses import asdict

    from robustnav_nodes.benchmarks.planner_bench import draw_planner_rows, planner_rows
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report
    from robustnav_nodes.planner.parameters import PlannerParameters

    wanted = _sizes(sizes)
    check_writable(json_file, plot)
    console = _console()
    console.print("[dim]  poses candidates   sim/s steps/s  POMCP ms, 95 % lookahead  belief space s   MB[/]")
    rows = planner_rows(
        wanted,
        seed,
        lambda row: console.print(
            f"{row.poses:7d} {row.candidates:10d} {row.simulations_per_s:7.2g} "
            f"{row.simulated_steps_per_s:7.2g} {row.decision_ms_p50:10.2f} /{row.decision_ms_p95:6.2f} "
            f"{row.lookahead_ms_p50:9.2f} {row.belief_update_ms:9.3f} {row.search_space_s:7.2f} "
            f"{row.rss_mb:4.0f}"
        ),
    )
    if json_file is not None:
        write_report(
            json_file,
            "planner",
            seed=seed,
            settings={"simulations": PlannerParameters().simulations},
            rows=[asdict(row) for row in rows],
        )
    if plot is not None:
        draw_planner_rows(rows, plot)


@bench_app.command("sim")
def sim_command(
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="of the first home")] = 1,
    homes: Annotated[int, typer.Option(min=1, max=1000, help="hard ones, one seed after the other")] = 20,
    json_file: JsonFile = None,
) -> None:
    """How fast the simulator is: pictures, lock-step, building homes, memory; on one core."""
    from dataclasses import asdict

    from robustnav_nodes.benchmarks.report_file import check_writable, write_report
    from robustnav_nodes.benchmarks.sim_bench import sim_figures

    check_writable(json_file)
    figures = sim_figures(range(seed, seed + homes))
    console = _console()
    console.print(f"a hard home of {figures.bodies} bodies, one core")
    console.print(f"RGB-D 320 x 240             {figures.rgbd_320x240_fps:8.0f} pictures/s")
    console.print(f"RGB-D 640 x 480             {figures.rgbd_640x480_fps:8.0f} pictures/s")
    console.print(f"depth alone, 320 x 240      {figures.depth_320x240_fps:8.0f} pictures/s")
    console.print(f"lock-step without camera    {figures.lockstep_realtime_factor:8.0f} x real time")
    console.print(f"slowest of {homes:3d} homes to build {figures.hard_home_build_s:7.2f} s")
    console.print(f"most memory                 {figures.rss_mb:8.0f} MB")
    if json_file is not None:
        write_report(json_file, "sim", seed=seed, settings={"homes": homes}, **asdict(figures))


@bench_app.command("pomdp")
def pomdp_command(
    simulations: Annotated[int, typer.Option(min=8, max=1_000_000, help="for one decision")] = 4096,
    episodes: Annotated[int, typer.Option(min=2, help="of each problem")] = 200,
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="decides the episodes")] = 1,
    json_file: JsonFile = None,
) -> None:
    """Returns of our POMCP on two known problems, beside the published ones."""
    from dataclasses import asdict

    from robustnav_nodes.benchmarks.pomdp_returns import rocksample_return, tiger_return
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report

    check_writable(json_file)
    console = _console()
    rows = []
    for problem, published in (
        ("Tiger", "optimum 19.37"),
        ("RockSample[7,8]", "published 20.71 ± 0.21 (Silver and Veness 2010)"),
    ):
        if problem == "Tiger":
            found = tiger_return(simulations=simulations, episodes=episodes, seed=seed)
        else:
            found = rocksample_return(7, 8, simulations, episodes, seed)
        console.print(f"{problem:16s} {found.mean:6.2f} ± {found.standard_error:.2f}   [dim]{published}[/]")
        rows.append({"problem": problem, "published": published, **asdict(found)})
    console.print(f"[dim]mean discounted return ± standard error of {episodes} episodes[/]")
    if json_file is not None:
        write_report(json_file, "pomdp", seed=seed, settings={"simulations": simulations}, rows=rows)


def _jobs(
    suite: str | None,
    scenes: Path | None,
    target_id: int | None,
    *,
    seed: int,
    episodes: int,
    contestants: "tuple[Contestant, ...]",
) -> "list[SceneJob]":
    from robustnav_nodes.benchmarks.search_plan import folder_jobs, suite_jobs

    if episodes == 0:
        return []
    if scenes is not None:
        return folder_jobs(scenes, target_id, seed=seed, episodes=episodes, contestants=contestants)
    return suite_jobs(suite or DEFAULT_SUITE, seed=seed, episodes=episodes, contestants=contestants)


def _play(jobs: "Sequence[SceneJob]", workers: int, ray: str | None) -> "list[PlayedEpisode]":
    from robustnav_nodes.benchmarks.search_workers import play_here, play_on_ray

    if not jobs:
        return []
    signal.signal(signal.SIGINT, signal.default_int_handler)  # Ctrl-C takes the worker processes along
    played: list[PlayedEpisode] = []
    columns = (TextColumn("searching"), BarColumn(), MofNCompleteColumn(), TextColumn("scenes"))
    with Progress(*columns, TimeElapsedColumn(), console=_console(), transient=True) as progress:
        task = progress.add_task("", total=len(jobs))
        for of_scene in play_here(jobs, workers) if ray is None else play_on_ray(jobs, ray):
            played += of_scene
            progress.advance(task)
    return played


def _graph_row(console: Console, count: int, seed: int) -> "SearchRow":
    from robustnav_nodes.benchmarks.graph_bench import GraphEpisode, graph_row

    folder = Path("runs") / f"bench_{time.strftime('%Y%m%d_%H%M%S')}"
    _make_folder(folder)
    console.print(f"[dim]{count} searches through the ROS graph, bags in {escape(str(folder))}[/]")

    def show(episode: GraphEpisode) -> None:
        metrics = episode.metrics
        spl = "unknown" if metrics.spl is None else f"{metrics.spl:.2f}"
        console.print(
            f"seed {episode.seed}: {escape(metrics.target)}, {episode.outcome.replace('_', ' ')}, "
            f"{metrics.steps} steps, SPL {spl}"
        )

    return graph_row(count, seed=seed, folder=folder, progress=show)


def _draw(
    console: Console, jobs: "Sequence[SceneJob]", played: "Sequence[PlayedEpisode]", folder: Path
) -> None:
    from robustnav_nodes.benchmarks.belief_picture import draw_belief, fooled_episode
    from robustnav_nodes.benchmarks.contestants import DEFAULT
    from robustnav_nodes.benchmarks.search_plots import draw_spl_by_length
    from robustnav_nodes.benchmarks.search_suite import NOISY

    draw_spl_by_length(played, folder / "spl_by_length.png")
    told = fooled_episode(jobs, DEFAULT, NOISY)
    if told is None:
        console.print(
            f"[dim]no picture of the belief: no episode of {DEFAULT} fits that has a false alarm[/]"
        )
    else:
        draw_belief(told, DEFAULT, folder / "belief.png")
    console.print(f"pictures in {escape(str(folder))}")


def _sizes(text: str) -> tuple[int, ...]:
    """The numbers in "100,1000". Raises BadParameterError."""
    smallest, largest = 50, 1_000_000
    words = text.split(",")
    if not all(word.strip().isdecimal() and smallest <= int(word) <= largest for word in words):
        raise BadParameterError(
            f"--sizes is {text!r}: it must be numbers from {smallest} to {largest}, such as 100,1000"
        )
    return tuple(int(word) for word in words)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise BadFileError(f"cannot make the folder {str(folder)!r}: {error.strerror}") from error


def _console() -> Console:
    return Console(highlight=False)
