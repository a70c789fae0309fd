"""What is believed of the detector from search to search, and how many searches succeed with it."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg  # no screen
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from robustnav_msgs_py.detector_statistics import DetectorStatistics
from robustnav_nodes.benchmarks.home_bench import LEARNT_LABELS, RIGHT, SUITES, HomeEpisode
from robustnav_nodes.benchmarks.search_episode import Outcome
from robustnav_nodes.benchmarks.search_plots import save
from robustnav_nodes.drawing.colors import FAINT, INK, MUTED

DPI = 150
COLORS = ("#173f7a", "#8a919b", "#d9480f")
LINES = {"recall": "-", "precision": "--"}


def draw_learning(played: Sequence[HomeEpisode], measured: DetectorStatistics, png: Path) -> None:
    """Over the searches: believed recall and precision of each class, and the part that succeeded so far.

    Raises BadFileError where the file cannot be written.
    """
    figure = Figure(figsize=(3.2 * (len(LEARNT_LABELS) + 1), 3.5), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    *of_classes, of_success = figure.subplots(1, len(LEARNT_LABELS) + 1)
    arms = SUITES["statistics"]
    for axes, label in zip(of_classes, LEARNT_LABELS, strict=True):
        for arm, color in zip(arms[1:], COLORS[1:], strict=True):
            own = [
                episode for episode in played if (episode.arm, episode.graph.metrics.target) == (arm, label)
            ]
            at = range(1, len(own) + 1)
            for name, line in LINES.items():
                believed = [getattr(episode.believed, name) for episode in own]
                axes.plot(at, believed, color=color, linestyle=line, label=f"{name}, {arm.statistics}")
        for name, line in LINES.items():
            value = getattr(measured.of(label), name)
            axes.axhline(value, color=COLORS[0], linestyle=line, linewidth=0.8, label=f"{name}, {RIGHT}")
        _finish(axes, f"what is believed of {label!r}", "searches for it")
    for arm, color in zip(arms, COLORS, strict=True):
        found = [episode.graph.outcome is Outcome.SUCCESS for episode in played if episode.arm == arm]
        count = np.arange(1, len(found) + 1)
        of_success.plot(count, np.cumsum(found) / count, color=color)
    _finish(of_success, "searches that succeeded so far", "searches")
    handles, labels = of_classes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=3, frameon=False, fontsize=7)
    save(figure, png)


def _finish(axes: Axes, title: str, across: str) -> None:
    axes.set(ylim=(0.0, 1.02), xlabel=across)
    axes.set_title(title, fontsize=9, color=INK, loc="left")
    axes.grid(visible=True, color=FAINT, alpha=0.25, linewidth=0.6)
    axes.tick_params(colors=MUTED, labelsize=8)
    axes.spines[["top", "right"]].set_visible(False)
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
