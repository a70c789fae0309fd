"""`robustnav bench recorder`."""

import tempfile
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console
from rich.table import Table

if TYPE_CHECKING:  # bags stands on this package, so that it may be missing here
    from bags.recorder_bench import RecorderRow


def recorder_command(
    mb_per_s: Annotated[
        float, typer.Option(min=0.0, max=10_000.0, help="of VGA images, said reliably")
    ] = 60.0,
    messages_per_s: Annotated[
        float, typer.Option(min=1.0, max=1_000_000.0, help="small messages besides, said reliably")
    ] = 3000.0,
    seconds: Annotated[float, typer.Option(min=1.0, max=3600.0, help="how long")] = 30.0,
    demo: Annotated[bool, typer.Option(help="besides, what the recorder costs in a demo")] = True,
    seed: Annotated[int, typer.Option(min=0, max=2**31 - 1, help="of the demo")] = 1,
    bags: Annotated[
        Path | None, typer.Option(help="folder to keep the bags in; default: they are thrown away")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="write the figures to this file too")
    ] = None,
) -> None:
    """What the recorder takes without loss, each message counted, its share of a core, and its memory."""
    from dataclasses import asdict

    from bags.recorder_bench import measure_demo, measure_load
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report
    from robustnav_nodes.graph.environment import prepare_environment

    check_writable(json_file)
    prepare_environment()
    rows = []
    with tempfile.TemporaryDirectory(prefix="recorder_bench_") if bags is None else nullcontext(bags) as kept:
        folder = Path(kept)
        load = measure_load(
            folder / "load", mb_per_s=mb_per_s, messages_per_s=messages_per_s, seconds=seconds
        )
        rows.append(load)
        if demo:
            rows.append(measure_demo(folder / "demo", seed=seed))
    _show(Console(highlight=False), rows)
    if json_file is not None:
        write_report(
            json_file,
            "recorder",
            seed=seed,
            settings={"mb_per_s": mb_per_s, "messages_per_s": messages_per_s, "seconds": seconds},
            rows=[asdict(row) for row in rows],
        )


def _show(console: Console, rows: "Sequence[RecorderRow]") -> None:
    table = Table(box=None, padding=(0, 1, 0, 0), header_style="dim")
    table.add_column("load", no_wrap=True)
    for name in ("s", "MB/s", "messages/s", "missing", "dropped", "CPU", "RSS MB", "bag MB"):
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            row.load,
            f"{row.seconds:.0f}",
            f"{row.mb_per_s:.1f}",
            f"{row.messages_per_s:.0f}",
            "–" if row.missing is None else f"{row.missing}",
            f"{row.dropped}",
            f"{row.cpu_share:.0%}",
            f"{row.rss_mb:.0f}",
            f"{row.file_mb:.0f}",
        )
    console.print(table)
