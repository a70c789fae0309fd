"""A detector's figures on screen: a row for each class, and how recall falls with distance."""

from rich.table import Table

from robustnav_nodes.benchmarks.detection_tally import ClassScore, Tally


def class_table(tally: Tally, *, with_all: bool = False) -> Table:
    """A row for each class that was there or was imagined; `with_all`: and a first one for all of them."""
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    table.add_column("", no_wrap=True)
    for name in ("objects", "AP@0.5", "precision", "recall", "F1"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in tally.class_scores()[0 if with_all else 1 :]:
        table.add_row(row.label, str(row.objects), *_parts(row))
    return table


def recall_sentence(tally: Tally) -> str:
    """Recall from each distance on."""
    told = ", ".join(f"{share.low:g} m {share.recall:.2f}" for share in tally.recall_by_range())
    return f"recall from a distance of {told}"


def part(value: float | None) -> str:
    """Two decimals; a dash where there is nothing to tell it from."""
    return "–" if value is None else f"{value:.2f}"


def _parts(row: ClassScore) -> tuple[str, ...]:
    return tuple(part(value) for value in (row.map50, row.precision, row.recall, row.f1))
