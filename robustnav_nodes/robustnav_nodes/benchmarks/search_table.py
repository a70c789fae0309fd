"""The figures of the search benchmark on screen, the thesis' beside them."""

from collections.abc import Sequence
from itertools import groupby

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from robustnav_nodes.benchmarks.bootstrap import Interval
from robustnav_nodes.benchmarks.contestants import DEFAULT
from robustnav_nodes.benchmarks.search_bench import Gain, SearchRow
from robustnav_nodes.benchmarks.search_suite import NOISY, PERFECT

# METHODS 4: averages of the thesis' tables 3.1 and 3.3, on the Active Vision Dataset.
THESIS = {
    PERFECT: "3.1, 3 scenes: random walk SR .18 SPL .03 APL 76 · EAT .69 .46 17 · POMP .76 .56 17 · "
    "BE-PD .90 .63 18",
    NOISY: "3.3, 8 scenes: POMP SR .40 SPL .20 APL 41 · BE .44 .25 37 · PD .49 .20 49 · BE-PD .54 .27 39",
}


def show_rows(console: Console, rows: Sequence[SearchRow], gained: Sequence[Gain], *, dock: bool) -> None:
    """A table for each difficulty and detector, planners in the order of `rows`."""
    for (difficulty, detector), group in groupby(rows, lambda row: (row.difficulty, row.detector)):
        of_cell = list(group)
        console.print()
        console.print(
            f"[bold]{escape(difficulty)}, {escape(detector)} detector[/], {of_cell[0].episodes} episodes"
        )
        console.print(_table(of_cell, dock=dock))
        console.print("[dim]wrong: stopped where the target is not in view; other: not found[/]")
        if detector in THESIS:
            console.print(f"[dim]thesis, AVDB: other data (table {THESIS[detector]})[/]")
        for gain in gained:
            if (gain.difficulty, gain.detector) == (difficulty, detector):
                console.print(_sentence(gain))


def _table(rows: Sequence[SearchRow], *, dock: bool) -> Table:
    table = Table(box=None, padding=(0, 1, 0, 0), header_style="dim")
    table.add_column("planner", no_wrap=True)
    errors = ["wrong", "dock", "other"] if dock else ["wrong", "other"]
    for name in ["SR", "95 %", "SPL", "95 %", "steps", *errors, "ms, 95 %"]:
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        cells = [
            _share(row.sr),
            _span(row.sr_ci),
            _share(row.spl),
            _span(row.spl_ci),
            "–" if row.apl is None else f"{row.apl:.0f}",
            _share(row.wrong_stop),
            *([_share(row.docking_error)] if dock else []),
            _share(row.other_error),
            _ms(row.decision_ms_p50, row.decision_ms_p95),
        ]
        table.add_row(escape(row.planner), *cells, style="bold" if row.planner == DEFAULT else None)
    return table


def _sentence(gain: Gain) -> str:
    ratio = "unknown" if gain.spl_ratio is None else f"{gain.spl_ratio:.2f}"
    low, high = ("?" if bound is None else f"{bound:.2f}" for bound in gain.spl_ratio_ci)
    sr_low, sr_high = gain.sr_difference_ci
    return (
        f"{DEFAULT} over {gain.over}, same episodes: SPL x {ratio} ({low} to {high}), "
        f"SR {gain.sr_difference:+.2f} ({sr_low:+.2f} to {sr_high:+.2f})"
    )


def _span(interval: Interval) -> str:
    return "–".join(_share(bound) for bound in interval)


def _share(value: float) -> str:
    """Two decimals, without the 0 before the point: ".54", "1.0"."""
    return f"{value:.2f}".removeprefix("0") if value < 0.995 else "1.0"


def _ms(median: float, high: float) -> str:
    """Median and 95 % of the decisions' times."""
    return " / ".join(f"{ms:.1f}" if ms < 10.0 else f"{ms:.0f}" for ms in (median, high))
