"""`robustnav bench homes`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.planner.parameters import PlannerParameters

if TYPE_CHECKING:
    from robustnav_nodes.benchmarks.home_bench import HomeEpisode, HomeRow

# Nothing is trained on, and nothing else is judged on, seeds from here on.
UNSEEN_SEED = 700_000


def homes_command(
    suite: Annotated[str, typer.Option(help="planners, degradations or statistics")] = "planners",
    episodes: Annotated[int, typer.Option(min=2, max=10_000, help="homes: easy, medium, easy ...")] = 30,
    seed: Annotated[int, typer.Option(min=0, max=2**31 - 1, help="of the first home")] = UNSEEN_SEED,
    max_steps: Annotated[
        int, typer.Option(min=1, help="after which a search has failed; default: as the planner has it")
    ] = PlannerParameters().max_steps,
    back_end: Annotated[str, typer.Option(help="of the detection node")] = "learned",
    model: Annotated[str, typer.Option(help="of the detection node; empty: what comes along")] = "",
    statistics: Annotated[
        Path | None,
        typer.Option(
            help="how good the detector is, from bench detection --statistics; default: the belief's"
        ),
    ] = None,
    folder: Annotated[
        Path | None, typer.Option(help="of bags; a bench that was stopped goes on there")
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="folder to draw into; of statistics only")] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="write the figures to this file too")
    ] = None,
) -> None:
    """Searches through the real nodes in unseen homes, with a detector that looks at pixels; in lock-step."""
    from dataclasses import asdict

    from robustnav_msgs_py.detector_statistics import DetectorStatistics, read_detector_statistics
    from robustnav_nodes.benchmarks.home_bench import SUITES, HomeBench, home_rows
    from robustnav_nodes.benchmarks.one_core import one_core
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report

    if suite not in SUITES:
        raise BadParameterError(f"there is no suite {suite!r} of homes; there are {', '.join(SUITES)}")
    check_writable(json_file)
    if plots is not None and not plots.is_dir():
        raise BadParameterError(f"--plots {str(plots)!r} is no folder; make it first")
    known = DetectorStatistics() if statistics is None else read_detector_statistics(statistics)
    console = Console(highlight=False, soft_wrap=True)
    bench = HomeBench(
        suite=suite,
        seed=seed,
        episodes=episodes,
        max_steps=max_steps,
        folder=folder or Path("runs") / f"bench_homes_{suite}",
        statistics=known,
        detection={"back_end": back_end, "model": model},
    )
    console.print(f"[dim]bags in {escape(str(bench.folder))}[/]")
    with one_core():
        played = bench.play(lambda episode: _say(console, episode))
    rows = home_rows(played)
    _show(console, rows)
    if plots is not None and suite == "statistics":
        from robustnav_nodes.benchmarks.home_plots import draw_learning

        draw_learning(played, known, plots / "learnt_statistics.png")
    if json_file is not None:
        write_report(
            json_file,
            "homes",
            suite=suite,
            seed=seed,
            episodes=episodes,
            settings={"max_steps": max_steps, "statistics": str(statistics or ""), **bench.detection},
            rows=[asdict(row) for row in rows],
            searches=[_as_data(episode) for episode in played],
        )


def _say(console: Console, episode: "HomeEpisode") -> None:
    arm, metrics = episode.arm, episode.graph.metrics
    console.print(
        f"home {episode.graph.seed}, {arm.planner}, camera {arm.camera}, statistics {arm.statistics}: "
        f"{escape(metrics.target)}, {episode.graph.outcome.replace('_', ' ')}, {metrics.steps} steps, "
        f"{metrics.false_alarms} false alarms"
    )


def _show(console: Console, rows: "Sequence[HomeRow]") -> None:
    table = Table(box=None, padding=(0, 1, 0, 0), header_style="dim")
    names = ("planner", "camera", "statistics")
    varied = [name for name in names if len({getattr(row, name) for row in rows}) > 1]
    for name in varied:
        table.add_column(name)
    for name in ("n", "SR", "SPL", "wrong", "lost", "alarms", "steps", "gain"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            *(getattr(row, name) for name in varied),
            str(row.episodes),
            _span(row.sr, row.sr_ci),
            _short(row.spl),
            _short(row.wrong_stop),
            _short(row.not_found),
            _short(row.false_alarms),
            "–" if row.steps is None else f"{row.steps:.0f}",
            _span(row.sr_gain, row.sr_gain_ci),
        )
    console.print(table)
    console.print(
        "[dim]n: searches; wrong: stops where the target is not; lost: not found in time;\n"
        "alarms: false ones, a search; ranges: 95 %; gain: in SR, over the first planner\n"
        "with the same camera in the same homes[/]"
    )


def _span(value: float, interval: tuple[float, float]) -> str:
    return f"{_short(value)} {_short(interval[0])}–{_short(interval[1])}"


def _short(value: float) -> str:
    """Two digits, without the zero before them."""
    text = f"{value:.2f}"
    return text.replace("0.", ".") if abs(value) < 1.0 else text


def _as_data(episode: "HomeEpisode") -> dict[str, object]:
    metrics = episode.graph.metrics
    return {
        "home": episode.graph.seed,
        "planner": episode.arm.planner,
        "camera": episode.arm.camera,
        "statistics": episode.arm.statistics,
        "target": metrics.target,
        "outcome": str(episode.graph.outcome),
        "steps": metrics.steps,
        "spl": metrics.spl,
        "false_alarms": metrics.false_alarms,
        "believed_precision": episode.believed.precision,
        "believed_recall": episode.believed.recall,
    }
