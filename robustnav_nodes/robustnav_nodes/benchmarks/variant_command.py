"""`robustnav bench variants`."""

from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

if TYPE_CHECKING:
    from robustnav_nodes.benchmarks.variant_bench import VariantRow


def variants_command(
    episodes: Annotated[int, typer.Option(min=2, help="of each experiment")] = 100,
    seed: Annotated[int, typer.Option(min=0, max=2**31 - 1, help="decides scenes and episodes")] = 1,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="write the figures to this file too")
    ] = None,
) -> None:
    """What goes beyond the thesis: learnt statistics, priors, several targets at once, blocked ways."""
    from dataclasses import asdict

    from robustnav_nodes.benchmarks.report_file import check_writable, write_report
    from robustnav_nodes.benchmarks.variant_bench import DIFFICULTY, variant_rows

    check_writable(json_file)
    console = Console(highlight=False)
    columns = (TextColumn("searching"), BarColumn(), MofNCompleteColumn(), TextColumn("episodes"))
    with Progress(*columns, TimeElapsedColumn(), console=console, transient=True) as progress:
        task = progress.add_task("", total=episodes)
        rows = variant_rows(episodes=episodes, seed=seed, progress=lambda: progress.advance(task))
    _show(console, rows)
    if json_file is not None:
        write_report(
            json_file,
            "variants",
            suite=f"{DIFFICULTY}-noisy",
            seed=seed,
            episodes=episodes,
            rows=[asdict(row) for row in rows],
        )


def _show(console: Console, rows: "Sequence[VariantRow]") -> None:
    for part, of_part in groupby(rows, lambda row: row.part):
        table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim", title=part, title_justify="left")
        table.add_column("", no_wrap=True, min_width=16)
        for name in ("SR", "SPL", "steps", "over the first, 95 %"):
            table.add_column(name, justify="right", no_wrap=True)
        for number, row in enumerate(of_part):
            spl = "–" if row.spl is None else f"{row.spl.mean:.2f}"
            table.add_row(
                row.variant,
                f"{row.sr.mean:.2f}",
                spl,
                f"{row.steps.mean:.0f}",
                "" if number == 0 else _gain(row),
            )
        console.print(table)
        console.print()


def _gain(row: "VariantRow") -> str:
    name, figure, form = ("steps", row.steps, "+.0f") if row.spl is None else ("SPL", row.spl, "+.2f")
    low, high = figure.gain_ci
    return f"{name} {figure.gain:{form}} ({low:{form}} to {high:{form}})"
