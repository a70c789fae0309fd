"""`robustnav bench instruction`."""

import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.benchmarks.instruction_protocols import ProtocolChoice

if TYPE_CHECKING:
    from robustnav_nodes.benchmarks.instruction_bench import Calibration, InstructionRow, PairRow, StepTime

MAX_SEED = 2**31 - 1
BEST = "mentions"
_TYPES = {
    "direction": "dir.",
    "room": "room",
    "object": "obj.",
    "room_object": "r & o",
    "all": "all",
    "mean": "mean",
}
# The published rows as the table names them: it is as narrow as a terminal.
_THESIS_NAMES = {
    "thesis: random": "th. random",
    "thesis: CLIP grounding": "th. CLIP",
    "thesis: IEDL": "th. IEDL",
}
_WALKED_OF_A_TYPE = 20  # episodes, to time a robot's steps


def instruction_command(
    data: Annotated[
        Path | None, typer.Option(help="folder of a semantic R2R pack; default: homes made for this")
    ] = None,
    suite: Annotated[
        str | None,
        typer.Option("--suite", "--split", help="split of the pack: val_seen …; default: val_unseen"),
    ] = None,
    model: Annotated[
        Path | None, typer.Option(help="what `robustnav train iedl` wrote; default: what comes along")
    ] = None,
    clip_folder: Annotated[
        Path | None, typer.Option(help="CLIP that IEDL was trained with; it looks at images/ of --data")
    ] = None,
    protocol: Annotated[ProtocolChoice, typer.Option(help="how wrong words are drawn")] = ProtocolChoice.BOTH,
    models: Annotated[str | None, typer.Option(help="a,b,c; default: all of them")] = None,
    episodes: Annotated[
        int | None, typer.Option(min=2, help="of each type of error, drawn by the seed; default: all")
    ] = None,
    common_sense: Annotated[
        bool, typer.Option(help="wrong rooms adjoin the right ones, wrong objects share rooms with them")
    ] = True,
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="decides homes, draws and chance")] = 1,
    plots: Annotated[Path | None, typer.Option(help="folder to draw pictures into")] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="write the figures to this file too")
    ] = None,
) -> None:
    """How well wrong instructions are told from right ones, and the wrong words found in them."""
    from robustnav_nodes.benchmarks.clip_of_pack import clip_of_pack
    from robustnav_nodes.benchmarks.generated_instructions import VAL_UNSEEN
    from robustnav_nodes.benchmarks.instruction_bench import (
        THESIS,
        calibration_of,
        judge_episodes,
        mean_row,
        online_step_time,
        pair_rows,
        row_of,
    )
    from robustnav_nodes.benchmarks.instruction_contestants import contestants_of
    from robustnav_nodes.benchmarks.instruction_episodes import bench_episodes
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report
    from robustnav_nodes.instruction.model_file import SHIPPED, load_model

    check_writable(json_file)
    if plots is not None and not plots.is_dir():
        raise BadParameterError(f"--plots {str(plots)!r} is no folder; make it first")
    if suite is not None and data is None:
        raise BadParameterError(
            f"--suite {suite!r} names a split of a pack, and none is named: add --data PACK, or leave it out"
        )
    suite = suite or VAL_UNSEEN
    console = Console(highlight=False)
    learned = load_model(model or SHIPPED)
    wanted = None if models is None else [name.strip() for name in models.split(",")]
    encoder, images = (None, None) if clip_folder is None else clip_of_pack(clip_folder, data)
    asked = {name: contestants_of(learned, name, seed, wanted, encoder) for name in _protocols(protocol)}
    began = time.monotonic()
    console.print("[dim]reading the walks and what was said[/]")
    found = bench_episodes(
        data,
        suite,
        tuple(asked),
        episodes,
        seed,
        common_sense=common_sense,
        say=lambda told: console.print(f"[dim]{told}[/]"),
    )
    if images is not None:
        images.check(one.trajectory for parts in found.values() for part in parts.values() for one in part)
    rows: list[InstructionRow] = []
    pairs: list[PairRow] = []
    calibrations: list[Calibration] = []
    steps: list[StepTime | None] = []
    columns = (TextColumn("judging"), BarColumn(), MofNCompleteColumn(), TextColumn("episodes"))
    with Progress(*columns, TimeElapsedColumn(), console=console, transient=True) as progress:
        total = sum(len(part) * len(asked[name]) for name, parts in found.items() for part in parts.values())
        task = progress.add_task("", total=total)
        for name, parts in found.items():
            for contestant, judge in asked[name].items():
                judged = [
                    judge_episodes(contestant, judge, name, error_type, part, lambda: progress.advance(task))
                    for error_type, part in parts.items()
                ]
                of_types = [row_of(one) for one in judged]
                rows += [*of_types, mean_row(of_types, judged)]
                pairs += pair_rows(judged[0])
                if contestant in (BEST, "iedl"):
                    calibrations.append(calibration_of(judged))
                if contestant == BEST:
                    some = [one for part in parts.values() for one in part[:_WALKED_OF_A_TYPE]]
                    steps.append(online_step_time(contestant, judge, name, some))
    _show(console, rows)
    _show_pairs(console, [row for row in pairs if row.model == BEST])
    _show_calibration(console, calibrations)
    measured = [step for step in steps if step is not None]
    _show_times(console, rows, measured)
    if plots is not None:
        from robustnav_nodes.benchmarks.instruction_plots import draw

        draw(rows, calibrations, plots)
    if json_file is not None:
        settings = {
            "data": "generated" if data is None else data.name,
            "model": "shipped" if model is None else model.name,
            "trained_on": learned.card.get("data"),
            "iedl_encoder": learned.iedl_encoder,
            "episodes_of_a_type": episodes,
            "common_sense": common_sense,
        }
        write_report(
            json_file,
            "instruction",
            suite=suite,
            seed=seed,
            settings=settings,
            seconds=round(time.monotonic() - began, 1),
            rows=[asdict(row) for row in rows],
            pairs=[asdict(row) for row in pairs],
            calibration=[asdict(one) for one in calibrations],
            online_step_ms=[asdict(step) for step in measured],
            thesis={name: {key: list(two) for key, two in types.items()} for name, types in THESIS.items()},
        )


def _protocols(choice: ProtocolChoice) -> tuple[Any, ...]:
    from robustnav_nodes.instruction.injection import PROTOCOLS

    return PROTOCOLS if choice is ProtocolChoice.BOTH else (choice.value,)


def _show(console: Console, rows: "Sequence[InstructionRow]") -> None:
    from robustnav_nodes.benchmarks.instruction_bench import THESIS

    for protocol in dict.fromkeys(row.protocol for row in rows):
        table = Table(
            title=f"{protocol}: AUC / ATD in tokens",
            title_justify="left",
            box=None,
            header_style="dim",
            padding=(0, 1, 0, 0),
        )
        table.add_column("", no_wrap=True)
        for name in _TYPES.values():
            table.add_column(name, justify="right", no_wrap=True)
        table.add_column("AUC, 95 %", justify="right", no_wrap=True)
        of_protocol = [row for row in rows if row.protocol == protocol]
        for model in dict.fromkeys(row.model for row in of_protocol):
            by_type = {row.error_type: row for row in of_protocol if row.model == model}
            low_high = by_type["mean"].auc_ci
            interval = "–" if low_high is None else "–".join(map(_share, low_high))
            table.add_row(model, *(_two(by_type[name].auc, by_type[name].atd) for name in _TYPES), interval)
        if protocol == "uniform":
            for model, types in THESIS.items():
                figures = (_two(*types.get(name, (None, None))) for name in _TYPES)
                table.add_row(f"[dim]{_THESIS_NAMES[model]}[/]", *figures, "")
        console.print(table)
    console.print("[dim]r & o: room & object. The thesis' rows (th.) are of other data: R2RIE-CE.[/]\n")


def _show_pairs(console: Console, rows: "Sequence[PairRow]") -> None:
    for protocol in dict.fromkeys(row.protocol for row in rows):
        told = ", ".join(
            f"{row.pair} {'–' if row.auc is None else f'{row.auc:.2f}'} ({row.episodes})"
            for row in rows
            if row.protocol == protocol
        )
        console.print(f"{BEST}, {protocol}, AUC by pair of opposites (episodes): {told}")


def _show_calibration(console: Console, rows: "Sequence[Calibration]") -> None:
    for row in rows:
        console.print(
            f"{row.model}, {row.protocol}: calibration error {row.error:.3f}; {row.error_scaled:.3f} with a "
            f"temperature of {row.temperature:.2f} found on other homes"
        )


def _show_times(console: Console, rows: "Sequence[InstructionRow]", steps: "Sequence[StepTime]") -> None:
    for protocol in dict.fromkeys(row.protocol for row in rows):
        told = ", ".join(
            f"{row.model} {row.seconds_per_1000:.2g}"
            for row in rows
            if row.protocol == protocol and row.error_type == "mean"
        )
        console.print(f"{protocol}, seconds for 1000 episodes: {told}")
    for step in steps:
        console.print(
            f"{step.model}, {step.protocol}, one more viewpoint to a verdict: median "
            f"{step.median_ms:.1f} ms, 95th percentile {step.p95_ms:.1f} ms ({step.steps} steps)"
        )


def _two(one: float | None, other: float | None) -> str:
    return f"{'–' if one is None else _share(one)}/{'–' if other is None else f'{other:.1f}'}"


def _share(value: float) -> str:
    """Two decimals, and no zero before them: the table is as narrow as a terminal."""
    return f"{value:.2f}".removeprefix("0")
