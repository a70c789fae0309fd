"""`robustnav data instructions`: packs of instructions to learn from, as large as is wanted."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

MAX_SEED = 1_000_000_000


def instructions_command(
    out: Annotated[Path, typer.Option(help="folder to write the pack into; must not hold one")],
    homes: Annotated[int, typer.Option(min=1, max=100_000, help="how many homes to train in")] = 300,
    unseen: Annotated[int | None, typer.Option(min=0, help="other homes; default: a fifth as many")] = None,
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="of the first home")] = 1,
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
