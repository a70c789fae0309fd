"""`robustnav instruction`: what the models of instruction errors are good for."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from rich.text import Text

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.instruction_protocols import OneProtocol

instruction_app = typer.Typer(help="Find instructions that are likely wrong.", no_args_is_help=True)

_PREFIX, _SUFFIX = "r2r_", ".jsonl.gz"


@instruction_app.command("audit")
def audit_command(
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help="r2r_SPLIT.jsonl.gz, in the folder of its pack")
    ],
    model: Annotated[
        Path | None, typer.Option(help="what `robustnav train iedl` wrote; default: what comes along")
    ] = None,
    protocol: Annotated[
        OneProtocol, typer.Option(help="which errors to expect: any, or such as read naturally")
    ] = OneProtocol.MATCHED,
    threshold: Annotated[float, typer.Option(min=0.0, max=1.0, help="flag from this error score up")] = 0.6,
    top: Annotated[int, typer.Option(min=0, help="show so many at most")] = 20,
    json_file: Annotated[Path | None, typer.Option("--json", help="write all that are flagged")] = None,
) -> None:
    """Flag the instructions of a data set that are likely wrong, with the words that are doubted most."""
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report
    from robustnav_nodes.instruction.audit import audit
    from robustnav_nodes.instruction.model_file import SHIPPED, load_model
    from robustnav_nodes.instruction.r2r_pack import R2rPack

    check_writable(json_file)
    split = file.name.removeprefix(_PREFIX).removesuffix(_SUFFIX)
    if not file.is_file() or file.name != f"{_PREFIX}{split}{_SUFFIX}":
        raise BadFileError(
            f"{str(file)!r} is no file of instructions; name a file {_PREFIX}SPLIT{_SUFFIX} in the folder of "
            "its pack (`robustnav data r2r` and `robustnav data instructions` make packs)"
        )
    judge = load_model(model or SHIPPED).model(protocol.value)
    console = Console(highlight=False)
    console.print("[dim]reading the walks and what was said[/]")
    instructions = R2rPack(file.parent).instructions(split)
    with Progress(console=console, transient=True) as progress:
        task = progress.add_task("judging", total=len(instructions))
        found = audit(instructions, judge, lambda: progress.advance(task))
    flagged = [one for one in found if one.error_score >= threshold]
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    for name in ("instruction", "score", "doubted words in brackets"):
        table.add_column(name)
    for one in flagged[:top]:
        table.add_row(f"{one.home} {one.key}", f"{one.error_score:.2f}", Text(one.marked))
    console.print(table)
    console.print(f"{len(flagged)} of {len(found)} instructions have an error score of {threshold:g} or more")
    if json_file is not None:
        write_report(
            json_file,
            "instruction-audit",
            file=file.name,
            protocol=protocol.value,
            threshold=threshold,
            instructions=len(found),
            flagged=[
                {
                    "instruction": one.key,
                    "home": one.home,
                    "error_score": round(one.error_score, 4),
                    "words": None if one.words is None else list(one.words),
                    "tokens": list(one.tokens),
                }
                for one in flagged
            ],
        )
