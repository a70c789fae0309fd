"""Pictures of how well wrong instructions are found: AUC by type of error, and reliability of the scores."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg  # no screen
from matplotlib.figure import Figure

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.instruction_bench import Calibration, InstructionRow
from robustnav_nodes.drawing.colors import FAINT, INK, MUTED

if TYPE_CHECKING:
    from robustnav_nodes.instruction.iedl_training import EpochFigures

DPI = 150
COLORS = {
    "random": "#d0d4da",
    "grounding": "#8a919b",
    "surprise": "#7b5cc4",
    "blind": "#d9480f",
    "iedl": "#57b894",
    "mentions": "#173f7a",
}


def draw(rows: Sequence[InstructionRow], calibrations: Sequence[Calibration], folder: Path) -> None:
    """Write instruction_auc.png and instruction_reliability.png. Raises BadFileError where that fails."""
    _save(_bars(rows), folder / "instruction_auc.png")
    _save(_reliability(calibrations), folder / "instruction_reliability.png")


def draw_curve(curve: "Sequence[EpochFigures]", path: Path) -> None:
    """Loss and AUC of IEDL over its training. Raises BadFileError where that fails."""
    figure = _figure(5.0, 3.0)
    minutes = [point.seconds / 60.0 for point in curve]
    for number, (name, values) in enumerate(
        (("loss", [point.loss for point in curve]), ("AUC, homes left out", [point.auc for point in curve]))
    ):
        axes = figure.add_subplot(1, 2, number + 1)
        axes.plot(minutes, values, color=COLORS["iedl"], marker="o", markersize=3)
        axes.set(xlabel="minutes", title=name)
        axes.tick_params(colors=MUTED, labelsize=8)
        axes.spines[["top", "right"]].set_visible(False)
    _save(figure, path)


def _bars(rows: Sequence[InstructionRow]) -> Figure:
    protocols = list(dict.fromkeys(row.protocol for row in rows))
    figure = _figure(9.0, 3.2 * len(protocols))
    for number, protocol in enumerate(protocols, start=1):
        axes = figure.add_subplot(len(protocols), 1, number)
        own = [row for row in rows if row.protocol == protocol and row.auc is not None]
        models = list(dict.fromkeys(row.model for row in own))
        types = list(dict.fromkeys(row.error_type for row in own))
        width = 0.8 / max(1, len(models))
        for k, model in enumerate(models):
            for row in own:
                if row.model == model and row.auc is not None:
                    at = types.index(row.error_type) + (k - (len(models) - 1) / 2.0) * width
                    low, high = row.auc_ci or (row.auc, row.auc)
                    axes.bar(at, row.auc - 0.4, width * 0.9, bottom=0.4, color=COLORS.get(model, INK))
                    axes.plot([at, at], [low, high], color=INK, linewidth=0.8)
        axes.axhline(0.5, color=FAINT, linewidth=1.0)
        axes.set_xticks(range(len(types)), [name.replace("_", " & ") for name in types])
        axes.set(ylim=(0.4, 1.0), ylabel="AUC", title=protocol)
        axes.tick_params(colors=MUTED, labelsize=8)
        axes.spines[["top", "right"]].set_visible(False)
        if number == 1:
            for model in models:
                axes.bar(np.nan, np.nan, color=COLORS.get(model, INK), label=model)
            axes.legend(frameon=False, fontsize=8, ncols=len(models), labelcolor=INK, loc="upper left")
    return figure


def _reliability(calibrations: Sequence[Calibration]) -> Figure:
    figure = _figure(5.0, 4.0)
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 1.0], color=FAINT, linewidth=1.0)
    for one in calibrations:
        axes.plot(
            [point[0] for point in one.curve],
            [point[1] for point in one.curve],
            color=COLORS.get(one.model, INK),
            linestyle="-" if one.protocol == "uniform" else "--",
            marker="o",
            markersize=4,
            label=f"{one.model}, {one.protocol} (error {one.error:.2f})",
        )
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0), xlabel="error score", ylabel="part that is wrong")
    axes.tick_params(colors=MUTED, labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    if calibrations:
        axes.legend(frameon=False, fontsize=8, labelcolor=INK)
    return figure


def _figure(width: float, height: float) -> Figure:
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _save(figure: Figure, path: Path) -> None:
    try:
        figure.savefig(path, dpi=DPI)
    except OSError as error:
        raise BadFileError(f"cannot draw into {str(path)!r}: {error.strerror}") from error
