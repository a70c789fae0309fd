"""`robustnav train iedl`."""

import json
from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.console import Console

from robustnav_msgs_py.errors import BadFileError, BadParameterError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from robustnav_nodes.instruction.iedl_training import EpochFigures

MAX_SEED = 2**31 - 1
HOMES = 400
EPOCHS = 30


class EncoderChoice(StrEnum):
    """What IEDL sees of a viewpoint."""

    SEMANTIC = "semantic"
    CLIP = "clip"


def train_iedl_command(
    data: Annotated[
        Path | None, typer.Option(help="folder of a semantic R2R pack; default: homes made for this")
    ] = None,
    split: Annotated[str, typer.Option(help="split of the pack to learn from")] = "train",
    out: Annotated[Path, typer.Option(help="model file to write (.npz)")] = Path("runs/iedl/model.npz"),
    seed: Annotated[int, typer.Option(min=0, max=MAX_SEED, help="decides all that is random")] = 1,
    homes: Annotated[
        int, typer.Option(min=2, max=10_000, help="how many homes to make, without --data")
    ] = HOMES,
    epochs: Annotated[
        int, typer.Option(min=0, max=1000, help="of the thesis' IEDL at most; 0: leave it out")
    ] = EPOCHS,
    minutes: Annotated[
        float | None,
        typer.Option(min=0.1, help="of wall time, after which no epoch of IEDL begins; default: any"),
    ] = None,
    width: Annotated[int, typer.Option(min=16, max=1024, help="of IEDL; the thesis has 768")] = 256,
    encoder: Annotated[
        EncoderChoice, typer.Option(help="of IEDL: what a detector says, or images/ of the pack through CLIP")
    ] = EncoderChoice.SEMANTIC,
    clip_folder: Annotated[
        Path | None, typer.Option(help="folder of a CLIP that transformers saved, for --encoder clip")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="take up a training that was stopped")] = False,
) -> None:
    """Train the models of instruction errors: ours, its blind twins, and IEDL as the thesis builds it."""
    try:
        import sklearn  # noqa: F401
        import torch  # noqa: F401
    except ImportError as error:
        raise BadParameterError(
            "training needs torch and scikit-learn; install them with pip install 'robustnav[learn]'"
        ) from error
    if width % 4:
        raise BadParameterError(f"--width {width} must be a multiple of 4, the number of attention heads")
    if (encoder is EncoderChoice.CLIP) != (clip_folder is not None):
        raise BadParameterError("--encoder clip and --clip-folder need each other: add the other, or neither")
    from robustnav_nodes.benchmarks.clip_of_pack import clip_of_pack
    from robustnav_nodes.benchmarks.instruction_episodes import lessons_of
    from robustnav_nodes.benchmarks.report_file import check_writable
    from robustnav_nodes.instruction.iedl_training import IedlSettings
    from robustnav_nodes.instruction.training import TrainingPlan, train_models

    clip, images = (None, None) if clip_folder is None else clip_of_pack(clip_folder, data)
    out.parent.mkdir(parents=True, exist_ok=True)
    check_writable(out)
    say = Console(highlight=False, soft_wrap=True).print
    lessons = lessons_of(data, split, homes, seed, say)
    if images is not None:
        images.check(one.trajectory for one in lessons.instructions)
    say(f"learning from {len(lessons.instructions)} instructions: {lessons.name}")
    plan = TrainingPlan(
        data=lessons.name,
        seed=seed,
        iedl=IedlSettings(epochs=epochs, minutes=minutes, width=width) if epochs else None,
    )
    _, curve = train_models(
        lessons.instructions,
        lessons.common_sense,
        plan,
        out,
        resume=resume,
        say=say,
        errors=lessons.errors,
        encoder=clip,
    )
    if curve:
        _save_curve(curve, out.with_suffix(".curve.json"))
    more = "" if clip_folder is None else f" --clip-folder {clip_folder} --data {data} --split SPLIT"
    say(f"{out}: judge it with `robustnav bench instruction --model {out}{more}`")


def _save_curve(curve: "Sequence[EpochFigures]", path: Path) -> None:
    from robustnav_nodes.benchmarks.instruction_plots import draw_curve

    try:
        path.write_text(json.dumps([asdict(figures) for figures in curve], indent=1) + "\n", encoding="utf-8")
    except OSError as error:
        raise BadFileError(f"cannot write the curve {str(path)!r}: {error.strerror}") from error
    draw_curve(curve, path.with_suffix(".png"))
