"""What the demo says at its end, measured from the bag alone."""

from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from bags.metrics import SearchMetrics, search_metrics
from bags.picture import draw_search
from bags.reader import open_bag
from robustnav_msgs_py.errors import RobustnavError
from robustnav_msgs_py.records import SearchPhase
from robustnav_nodes.graph.demo import DemoEnd


def show_summary(console: Console, end: DemoEnd, bag: Path, logs: Path) -> bool:
    """Print the summary and draw the picture; returns whether the object was really found."""
    picture = bag.parent / f"{bag.name}.png"
    try:
        with open_bag(bag) as opened:
            metrics = search_metrics(opened)
            draw_search(opened, picture)
    except RobustnavError as error:
        console.print("[red]no summary:[/] ", end="")
        console.print(f"{error}; the nodes' logs are in {logs}", markup=False)
        return False
    console.print(verdict(metrics, end))
    console.print(_table(metrics, end, bag, picture, logs))
    return metrics.success is True


def _table(metrics: SearchMetrics, end: DemoEnd, bag: Path, picture: Path, logs: Path) -> Table:
    table = Table(show_header=False)
    table.add_row("object", escape(metrics.target))
    table.add_row("steps", str(metrics.steps))
    table.add_row(
        "path length", f"{_number(metrics.path_length_m)} m (shortest {_number(metrics.shortest_path_m)} m)"
    )
    table.add_row("SPL", _number(metrics.spl))
    table.add_row("false alarms survived", str(metrics.false_alarms))
    searched_s = metrics.wall_duration_s
    of_these = "" if searched_s is None else f", of the search {searched_s:.0f} s"
    table.add_row("time", f"{end.wall_s:.0f} s{of_these}")
    if end.restarts:
        table.add_row("processes brought back", str(end.restarts))
    table.add_row("bag", str(bag))
    table.add_row("picture", str(picture))
    table.add_row("logs", str(logs))
    return table


def verdict(metrics: SearchMetrics, end: DemoEnd) -> str:
    """A sentence in rich's markup: what the robot says of the search, and what the bag says of that."""
    target = escape(metrics.target or end.search.target or "object")
    if metrics.success:
        return f"[bold green]found[/] the {target}, and it is really there"
    if metrics.success is None and metrics.found:
        return f"[bold yellow]found[/] the {target}, the robot says; the bag does not tell where it really is"
    if metrics.found:
        return f"[bold red]mistaken[/]: the robot says it found the {target}, but it is not there"
    if end.search.phase == SearchPhase.FOUND:
        return f"[bold yellow]found[/] the {target}, the robot says; the bag ends before that"
    if end.timed_out:
        return f"[bold red]not found[/]: the time was over while looking for the {target}"
    return f"[bold red]not found[/]: {escape(end.search.message) or 'interrupted'}"


def _number(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.2f}"
