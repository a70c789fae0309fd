"""SPL against the length of the shortest way, as in the thesis' fig. 3.6."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg  # no screen
from matplotlib.figure import Figure
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.bootstrap import mean_intervals
from robustnav_nodes.benchmarks.contestants import DEFAULT, NAMES
from robustnav_nodes.benchmarks.search_bench import cells_of
from robustnav_nodes.benchmarks.search_plan import PlayedEpisode
from robustnav_nodes.drawing.colors import FAINT, INK, MUTED

BINS = 5
EPISODES_IN_BIN = 8  # of each planner, at least
DPI = 150
_MOST_COLUMNS = 4

# Rules are grey, the thesis' planners blue, those with our evidence green, ours orange.
_STYLE = {
    "random": ("#b4b9c0", ":", "o"),
    "greedy": ("#5b626c", "-", "s"),
    "greedy_gain": ("#8a919b", "--", "v"),
    "pomp": ("#a9cdf2", "-", "o"),
    "pomp_be": ("#6ba6e3", "--", "v"),
    "pomp_pd": ("#2c7fd6", ":", "^"),
    "pomp_be_pd": ("#173f7a", "-", "D"),
    "greedy_likelihood": ("#1d9a6c", "-", "s"),
    "pomp_be_pd_likelihood": ("#57b894", "--", "D"),
    "pomp_be_pd_two_views": ("#7b5cc4", ":", "D"),
    "pomp_belief": ("#9bd3bd", "-.", "P"),
    "lookahead_discount": ("#f2a55e", "--", "X"),
    "pomp_guided": ("#57b894", ":", "P"),
    "lookahead": ("#d9480f", "-", "o"),
}
_OTHER_STYLE = ("#000000", ":", ".")


def draw_spl_by_length(played: Sequence[PlayedEpisode], png: Path) -> None:
    """A row of axes for each detector, in it axes for each difficulty and for all; a line for each planner.

    Raises BadFileError where the file cannot be written.
    """
    cells = cells_of(played)
    difficulties = list(dict.fromkeys(difficulty for (difficulty, _), _ in cells))
    detectors = list(dict.fromkeys(detector for (_, detector), _ in cells))
    columns: list[list[str]] = [[difficulty] for difficulty in difficulties]
    if len(difficulties) >= _MOST_COLUMNS:
        columns = []
    if len(difficulties) > 1:
        columns.append(difficulties)
    figure = Figure(
        figsize=(3.3 * len(columns) + 2.6, 2.9 * len(detectors) + 0.9), dpi=DPI, layout="constrained"
    )
    FigureCanvasAgg(figure)
    grid = figure.subplots(len(detectors), len(columns), squeeze=False, sharey=True)
    for row, detector in enumerate(detectors):
        for column, wanted in enumerate(columns):
            axes = grid[row, column]
            of_axes = [
                episode
                for (difficulty, by), episodes in cells
                if by == detector and difficulty in wanted
                for episode in episodes
            ]
            _draw_lines(axes, of_axes)
            name = wanted[0] if len(wanted) == 1 else "all"
            axes.set_title(f"{name}, {detector} detector", fontsize=10, color=INK, loc="left")
            if column == 0:
                axes.set_ylabel("SPL", color=MUTED)
            if row == len(detectors) - 1:
                axes.set_xlabel("shortest way, actions", color=MUTED)
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right center", frameon=False, fontsize=9)
    figure.suptitle("SPL by how far the target is (shaded: 95 %)", color=INK, fontweight="bold", fontsize=11)
    save(figure, png)


def save(figure: Figure, png: Path) -> None:
    """Write a picture; raises BadFileError where that fails."""
    try:
        figure.savefig(png)
    except OSError as error:
        raise BadFileError(f"cannot write the picture {str(png)!r}: {error.strerror}") from error


def bins_of(shortest: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    """Indices of the episodes in each bin, about as many in each; `shortest` int64 [e], in actions."""
    count = int(np.clip(len(shortest) // EPISODES_IN_BIN, 1, BINS))
    edges = np.quantile(shortest, np.linspace(0.0, 1.0, count + 1)[1:-1])
    which = np.searchsorted(edges, shortest, side="left")
    return [np.nonzero(which == number)[0] for number in range(count) if np.any(which == number)]


def _draw_lines(axes: Axes, episodes: Sequence[PlayedEpisode]) -> None:
    for planner in sorted({episode.planner for episode in episodes}, key=NAMES.index):
        results = [episode.result for episode in episodes if episode.planner == planner]
        shortest = np.array([result.shortest for result in results])
        spl = np.array([result.spl for result in results])
        bins = bins_of(shortest)
        middle = [float(np.median(shortest[chosen])) for chosen in bins]
        color, line, marker = _STYLE.get(planner, _OTHER_STYLE)
        is_default = planner == DEFAULT
        axes.plot(
            middle,
            [spl[chosen].mean() for chosen in bins],
            color=color,
            linestyle=line,
            marker=marker,
            markersize=5.0 if is_default else 3.5,
            linewidth=2.4 if is_default else 1.3,
            zorder=4 if is_default else 3,
            label=planner,
        )
        if is_default:
            _shade(axes, middle, spl, bins, color)
    axes.set(ylim=(0.0, 1.0), xlim=(0.0, None))
    axes.grid(visible=True, color=FAINT, alpha=0.25, linewidth=0.6)
    axes.tick_params(colors=MUTED, labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _shade(axes: Axes, middle: list[float], spl: Float64, bins: list[NDArray[np.int64]], color: str) -> None:
    bounds = [mean_intervals(spl[chosen][:, np.newaxis])[0] for chosen in bins]
    low, high = zip(*bounds, strict=True)
    axes.fill_between(middle, low, high, color=color, alpha=0.15, linewidth=0.0, zorder=2)
