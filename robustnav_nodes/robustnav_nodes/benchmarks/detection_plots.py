"""Pictures of how good a detector is: reliability, and recall over distance."""

from collections.abc import Mapping
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg  # no screen
from matplotlib.figure import Figure

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.detection_scores import calibration_error
from robustnav_nodes.benchmarks.detection_tally import Tally
from robustnav_nodes.drawing.colors import FAINT, INK, MUTED

DPI = 150
COLORS = ("#173f7a", "#d9480f", "#57b894", "#7b5cc4", "#8a919b", "#c2255c")


def draw(found: Mapping[str, Tally], folder: Path) -> None:
    """Write reliability.png and recall_over_distance.png, with a line for each name in `found`.

    Raises BadFileError where that fails.
    """
    _save(_reliability(found), folder / "reliability.png")
    _save(_recall(found), folder / "recall_over_distance.png")


def _reliability(found: Mapping[str, Tally]) -> Figure:
    figure = _figure()
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [0.0, 1.0], color=FAINT, linewidth=1.0)
    for color, (name, tally) in zip(COLORS, found.items(), strict=False):
        bins = tally.score_bins()
        if bins:
            told = f"{name} (error {calibration_error(bins):.2f})"
            points = [(row.mean_score, row.precision) for row in bins]
            axes.plot(*zip(*points, strict=True), color=color, marker="o", markersize=4, label=told)
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0), xlabel="score", ylabel="part that is right")
    _finish(axes)
    return figure


def _recall(found: Mapping[str, Tally]) -> Figure:
    figure = _figure()
    axes = figure.add_subplot()
    for color, (name, tally) in zip(COLORS, found.items(), strict=False):
        shares = tally.recall_by_range()
        if shares:
            points = [((share.low + share.high) / 2.0, share.recall) for share in shares]
            axes.plot(*zip(*points, strict=True), color=color, marker="o", markersize=4, label=name)
    axes.set(xlim=(0.0, None), ylim=(0.0, 1.0), xlabel="distance on the floor, m", ylabel="recall")
    _finish(axes)
    return figure


def _figure() -> Figure:
    figure = Figure(figsize=(5.0, 4.0), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _finish(axes: Axes) -> None:
    axes.tick_params(colors=MUTED, labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    if axes.get_legend_handles_labels()[0]:
        axes.legend(frameon=False, fontsize=8, labelcolor=INK)


def _save(figure: Figure, path: Path) -> None:
    try:
        figure.savefig(path, dpi=DPI)
    except OSError as error:
        raise BadFileError(f"cannot draw into {str(path)!r}: {error.strerror}") from error
