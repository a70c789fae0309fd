"""`robustnav bench detection`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from robustnav_msgs_py.errors import BadParameterError

if TYPE_CHECKING:
    from robustnav_nodes.benchmarks.detection_bench import Measured

UNSEEN_SEED = 500_000
EVERY = "all"


def detection_command(
    back_end: Annotated[str, typer.Option(help="truth, learned, onnx or open_vocabulary")] = "learned",
    model: Annotated[str, typer.Option(help="weights, ONNX file or folder of the model")] = "",
    class_names: Annotated[str, typer.Option(help="class names of the model, one on a line")] = "",
    homes: Annotated[int, typer.Option(min=1, max=10_000, help="easy, medium, hard, easy ...")] = 12,
    poses: Annotated[int, typer.Option(min=2, max=10_000, help="pictures of each home")] = 30,
    seed: Annotated[
        int, typer.Option(min=0, max=2**31 - 1, help="of the first home; nothing is trained on 500000 and up")
    ] = UNSEEN_SEED,
    degradation: Annotated[str, typer.Option(help="what is wrong with the camera, or all")] = "none",
    score: Annotated[
        float | None, typer.Option(min=0.0, max=1.0, help="precision and recall from this score up")
    ] = None,
    plots: Annotated[Path | None, typer.Option(help="folder to draw pictures into")] = None,
    statistics: Annotated[
        Path | None, typer.Option(help="file for the belief and the planner; of the first degradation")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", help="write the figures to this file too")
    ] = None,
) -> None:
    """How good a detector is in homes that it has not seen: by class, distance, visible part; calibration."""
    from robustnav_nodes.benchmarks.detection_bench import measure
    from robustnav_nodes.benchmarks.detection_report import report_content
    from robustnav_nodes.benchmarks.detection_statistics_file import write_statistics
    from robustnav_nodes.benchmarks.one_core import one_core
    from robustnav_nodes.benchmarks.report_file import check_writable, write_report

    check_writable(json_file, statistics)
    if plots is not None and not plots.is_dir():
        raise BadParameterError(f"--plots {str(plots)!r} is no folder; make it first")
    names = _degradations(degradation)
    values: dict[str, Any] = {"back_end": back_end, "model": model, "class_names_file": class_names}
    if score is not None:
        values["score_min"] = score
    parameters = _parameters(values)
    console = Console(highlight=False)
    columns = (TextColumn("looking"), BarColumn(), MofNCompleteColumn(), TextColumn("images"))
    seeds = range(seed, seed + homes)
    with one_core(), Progress(*columns, TimeElapsedColumn(), console=console, transient=True) as progress:
        task = progress.add_task("", total=len(names) * homes * poses)
        found = [measure(parameters, name, seeds, poses, lambda: progress.advance(task)) for name in names]
    _show(console, found)
    if statistics is not None:
        write_statistics(statistics, found[0].tally)
    if plots is not None:
        from robustnav_nodes.benchmarks.detection_plots import draw

        draw({measured.degradation: measured.tally for measured in found}, plots)
    if json_file is not None:
        settings = {"homes": homes, "poses": poses, "score_min": found[0].tally.score_min, **values}
        write_report(json_file, "detection", seed=seed, settings=settings, **report_content(found))


def _parameters(values: dict[str, Any]) -> Any:
    from robustnav_msgs_py.parameters import build
    from robustnav_nodes.detection.parameters import DetectionParameters

    return build(DetectionParameters, values)


def _degradations(wanted: str) -> list[str]:
    from sim_bridge.sensors.degradations import DEGRADATIONS

    if wanted == EVERY:
        return list(DEGRADATIONS)
    if wanted not in DEGRADATIONS:
        raise BadParameterError(
            f"there is no degradation {wanted!r}; there are {', '.join(DEGRADATIONS)} and {EVERY}"
        )
    return [wanted]


def _show(console: Console, found: "Sequence[Measured]") -> None:
    from robustnav_nodes.benchmarks.detection_report import overall_row
    from robustnav_nodes.benchmarks.detection_table import class_table, part, recall_sentence

    rows = [overall_row(measured) for measured in found]
    table = Table(box=None, padding=(0, 2, 0, 0), header_style="dim")
    table.add_column("", no_wrap=True)
    for name in (
        "objects",
        "mAP@0.5",
        "precision",
        "recall",
        "F1",
        "ECE",
        "off, 90 %",
        "ms",
    ):
        table.add_column(name, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(
            row["degradation"],
            str(row["objects"]),
            *(part(row[name]) for name in ("map50", "precision", "recall", "f1", "calibration_error")),
            _placed(row),
            f"{row['image_ms']:.1f}",
        )
    console.print(table)
    console.print(
        "[dim]ECE: calibration error; off: of right detections, from the object's centre; ms: an image[/]\n"
    )
    console.print(class_table(found[0].tally))
    if rows[0]["instance_top1"] is not None:
        console.print(
            f"this one among five of its class: {rows[0]['instance_top1']:.2f} of "
            f"{rows[0]['instance_trials']} times right"
        )
    console.print(recall_sentence(found[0].tally))


def _placed(row: dict[str, Any]) -> str:
    return "–" if row["place_error_m_p90"] is None else f"{row['place_error_m_p90']:.2f} m"
