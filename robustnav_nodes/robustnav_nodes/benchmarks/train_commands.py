"""`robustnav train`: teach our own networks, and judge what they learned."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.benchmarks.train_iedl_command import train_iedl_command

train_app = typer.Typer(help="Train our own networks.", no_args_is_help=True)
train_app.command("iedl")(train_iedl_command)

MAX_SEED = 2**31 - 1
MINUTES = 36.0
TEST_HOMES, TEST_PICTURES = 100, 12
# Of the usual learning rate, where weights are there to go on from.
RATE_OF_TRAINED = 0.25


@train_app.command("detector")
def detector_command(
    out: Annotated[Path, typer.Option(help="weights file to write (.npz)")] = Path(
        "runs/detector/weights.npz"
    ),
    minutes: Annotated[float, typer.Option(min=0.1, max=1000.0, help="in all, with rendering")] = MINUTES,
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="decides all that is random")] = 1,
    homes: Annotated[int, typer.Option(min=1, max=90_000, help="how many homes to learn from")] = 800,
    begin_with: Annotated[
        Path | None, typer.Option(help="weights to go on from (.npz); default: from nothing")
    ] = None,
    only: Annotated[
        str, typer.Option(help="detector or look: the one to train; the other stays as in --begin-with")
    ] = "",
    anew: Annotated[
        bool, typer.Option("--anew", help="with --only: that network begins from nothing")
    ] = False,
    rate: Annotated[
        float | None,
        typer.Option(
            min=0.001,
            max=10.0,
            help="of the usual learning rate; default: 1 from nothing, else 0.25",
            show_default=False,
        ),
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="take up a training that was stopped")] = False,
) -> None:
    """Train the detector on pictures rendered for it (7 MB a home beside the weights)."""
    _require_torch()
    from robustnav_nodes.detection.learned.training import NETWORKS, TrainingPlan, train_detector
    from robustnav_nodes.detection.learned.weights import load_weights

    if only and only not in NETWORKS:
        raise BadParameterError(f"--only {only!r} is no network; there are {', '.join(NETWORKS)}")
    if anew and not only:
        raise BadParameterError("--anew is for the one network of --only; without weights both begin anew")
    begun = None if begin_with is None else load_weights(begin_with)

    out.parent.mkdir(parents=True, exist_ok=True)
    bar = Progress(
        TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[word]}"), TimeElapsedColumn()
    )
    with bar:
        tasks = {
            name: bar.add_task(name, total=1.0, word="", start=False)
            for name in ("pictures", "detector", "look")
        }

        def report(name: str, share: float, word: str) -> None:
            bar.start_task(tasks[name])
            bar.update(tasks[name], completed=share, word=word)

        plan = TrainingPlan(
            minutes=minutes,
            seed=seed,
            homes=homes,
            networks=(only,) if only else NETWORKS,
            begin_with=begun,
            anew=anew,
            rate=rate if rate is not None else 1.0 if begun is None or anew else RATE_OF_TRAINED,
        )
        train_detector(out, plan, resume=resume, report=report)
    Console(highlight=False).print(f"{out}: judge it with `robustnav train judge --weights {out}`")


@train_app.command("judge")
def judge_command(
    out: Annotated[Path, typer.Option(help="figures to write, as .json, .md and .png")] = Path(
        "runs/detector/figures.json"
    ),
    weights: Annotated[
        Path | None, typer.Option(help="weights file (.npz); default: those that come along")
    ] = None,
    homes: Annotated[int, typer.Option(min=1, max=10_000, help="how many homes to judge on")] = TEST_HOMES,
) -> None:
    """Judge the detector on homes that it was not trained on."""
    _require_torch()
    from robustnav_nodes.detection.learned.report_card import judge_weights, save_figures, tables
    from robustnav_nodes.detection.learned.weights import SHIPPED, load_weights

    out.parent.mkdir(parents=True, exist_ok=True)
    read = load_weights(weights or SHIPPED)
    figures = judge_weights(read, out.parent / "judging", homes, TEST_PICTURES)
    save_figures(out, figures)
    Console(highlight=False, soft_wrap=True).print(tables(figures), markup=False)


def _require_torch() -> None:
    try:
        import cv2  # noqa: F401
        import torch  # noqa: F401
    except ImportError as error:
        raise BadParameterError(
            f"training needs {error.name}, which is not installed: pip install 'robustnav[learn]'"
        ) from error
