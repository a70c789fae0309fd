"""`robustnav data instructions`, `r2r` and `statistics`: packs to learn from, and what is in them."""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

MAX_SEED = 1_000_000_000


def instructions_command(
    out: Annotated[Path, typer.Option(help="folder to make for the pack; must be missing or empty")],
    homes: Annotated[int, typer.Option(min=1, max=100_000, help="how many homes to train in")] = 300,
    unseen: Annotated[
        int | None, typer.Option(min=0, max=100_000, help="other homes; default: a fifth as many")
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, max=MAX_SEED, help="decides homes, which no other seed has, and errors")
    ] = 1,
    walks: Annotated[int, typer.Option(min=1, max=100, help="through each home")] = 12,
    walks_seen: Annotated[int, typer.Option(min=0, max=100, help="more of them, for val_seen")] = 2,
    writers: Annotated[int, typer.Option(min=1, max=8, help="who each tell a walk")] = 2,
    workers: Annotated[int, typer.Option(min=1, max=64, help="processes")] = 2,
) -> None:
    """Generate instructions for walks through simulated homes, with errors, as a pack."""
    from robustnav_nodes.benchmarks.generated_instructions import GenerationPlan, write_generated_pack

    plan = GenerationPlan(
        seed=seed,
        homes=homes,
        unseen=max(1, homes // 5) if unseen is None else unseen,
        walks=walks,
        walks_seen=walks_seen,
        writers=writers,
    )
    with Progress() as progress:
        task = progress.add_task("homes", total=plan.homes + plan.unseen)
        counts = write_generated_pack(plan, out, workers, lambda done: progress.update(task, advance=done))
    say = Console(highlight=False, soft_wrap=True).print
    say(f"{out}: {', '.join(f'{count} {what}' for what, count in counts.items())}", markup=False)


def r2r_command(
    out: Annotated[Path, typer.Option(help="folder to make for the pack; must be missing or empty")],
    fine_grained_r2r: Annotated[Path, typer.Option(help="copy of YicongHong/Fine-Grained-R2R")],
    matterport_sim: Annotated[Path, typer.Option(help="copy of peteanderson80/Matterport3DSimulator")],
    reverie: Annotated[Path, typer.Option(help="copy of YuankaiQi/REVERIE")],
    matterport: Annotated[Path, typer.Option(help="copy of niessner/Matterport")],
    split: Annotated[list[str] | None, typer.Option(help="can be repeated; default: all three")] = None,
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="decides the errors")] = 1,
) -> None:
    """Build the semantic R2R pack of people's instructions from local copies of public repositories."""
    from robustnav_nodes.benchmarks.r2r_building import build_r2r_pack
    from robustnav_nodes.benchmarks.r2r_sources import SourceFolders

    folders = SourceFolders(
        fine_grained=fine_grained_r2r, simulator=matterport_sim, reverie=reverie, matterport=matterport
    )
    console = Console(highlight=False, soft_wrap=True)
    with console.status("") as status:
        counts = build_r2r_pack(
            folders,
            out,
            split or ["train", "val_seen", "val_unseen"],
            seed,
            lambda scan: status.update(f"scan {scan}"),
        )
    console.print(f"{out}: {', '.join(f'{count} {what}' for what, count in counts.items())}", markup=False)


def statistics_command(
    pack: Annotated[Path, typer.Argument(metavar="PACK", help="folder of a pack, ours or of real walks")],
    split: Annotated[list[str] | None, typer.Option(help="only this one; can be repeated")] = None,
    common_sense: Annotated[
        bool, typer.Option(help="wrong rooms adjoin the right ones, wrong objects share rooms with them")
    ] = True,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="write the figures to this file too")
    ] = None,
) -> None:
    """Count a pack's episodes with errors, beside table 4.1 of the thesis (other data)."""
    from rich.table import Table

    from robustnav_nodes.benchmarks.instruction_statistics import THESIS, pack_statistics
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report

    check_writable(json_file)
    rows = list(pack_statistics(pack, split or [], common_sense=common_sense))
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for column in ("protocol", "split", "type"):
        table.add_column(column, no_wrap=True)
    for column in ("episodes", "tokens", "dir./obj./room"):
        table.add_column(column, justify="right", no_wrap=True)
    for row in rows:
        found, thesis = row.statistics, THESIS[row.statistics.error_type]
        kinds = dict(found.kinds)
        table.add_row(
            row.protocol,
            row.split,
            found.error_type,
            f"{found.episodes} ({thesis.episodes})",
            f"{found.mean_tokens:.1f} ({thesis.mean_tokens:.1f})",
            "/".join(str(kinds[kind]) for kind in ("direction", "object", "room")),
        )
    console = Console(highlight=False)
    console.print(table)
    console.print("[dim]in brackets: the thesis' table 4.1, on other data[/]")
    if json_file is not None:
        write_report(
            json_file,
            "instruction-statistics",
            common_sense=common_sense,
            rows=[
                {
                    "protocol": row.protocol,
                    "split": row.split,
                    "type": row.statistics.error_type,
                    "episodes": row.statistics.episodes,
                    "errors_per_episode": row.statistics.errors_per_episode,
                    "mean_tokens": row.statistics.mean_tokens,
                    "kinds": dict(row.statistics.kinds),
                    "thesis": asdict(THESIS[row.statistics.error_type]),
                }
                for row in rows
            ],
        )
