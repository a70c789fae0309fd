"""A picture of a recorded search: map, final belief, the robot's way, what it was fooled by, and the end."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from bags.drawing.floor import draw_map, draw_view, shown
from bags.drawing.run import draw_alarms, draw_objects, draw_way
from bags.false_alarms import FalseAlarm, false_alarms
from bags.metrics import SearchMetrics, measure
from bags.metrics_settings import MetricsSettings, settings_of
from bags.reader import Bag
from bags.search_run import SearchRun, read_search
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.records import SearchPhase
from robustnav_msgs_py.values import OccupancyMap
from robustnav_nodes.drawing.colors import (
    BELIEF_COLORS,
    BELIEF_SPAN,
    FAINT,
    FALSE_ALARM,
    INK,
    MUTED,
    TARGET,
    TIME_COLORS,
    belief_norm,
)

WIDTH_IN, HEAD_IN, FOOT_IN, BAR_IN = 9.6, 0.72, 0.95, 0.3
TALLEST_IN = 12.0
DPI = 160


def draw_search(
    bag: Bag,
    png: Path,
    *,
    namespace: str | None = None,
    episode: int | None = None,
    settings: MetricsSettings | None = None,
) -> None:
    """Draw search number `episode` (the last one where None) into the file `png`.

    Candidate locations are tinted by the last belief, the way by the time, with a tick for the heading at
    each decision. Raises BadFileError where the bag holds no map or the file cannot be written, and what
    `read_search` raises.
    """
    run = read_search(bag, namespace=namespace, episode=episode)
    chosen = settings or settings_of(bag.manifest, run.namespace)
    if run.floor_map is None:
        raise BadFileError(f"{bag.path} cannot be drawn: no map was recorded in it")
    figure = _figure(run, run.floor_map, measure(run, chosen), chosen)
    try:
        FigureCanvasAgg(figure).print_figure(str(png), format="png", dpi=DPI)
    except OSError as error:
        raise BadFileError(f"the picture cannot be written to {png}: {error.strerror or error}") from error


def _figure(
    run: SearchRun, floor_map: OccupancyMap, metrics: SearchMetrics, settings: MetricsSettings
) -> Figure:
    left, right, bottom, top = shown(floor_map)
    map_in = min(WIDTH_IN * 0.96 * (top - bottom) / (right - left), TALLEST_IN)
    height_in = map_in + HEAD_IN + FOOT_IN
    figure = Figure(figsize=(WIDTH_IN, height_in), dpi=DPI, facecolor="white")
    axes = figure.add_axes((0.02, FOOT_IN / height_in, 0.96, map_in / height_in))
    axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
    axes.axis("off")
    draw_map(axes, floor_map, run.candidates, run.belief)
    draw_objects(axes, run)
    seconds = draw_way(axes, run)
    alarms = false_alarms(run, settings.mount, settings.false_alarm_distance_m) or ()
    draw_alarms(axes, alarms)
    if run.end is not None:
        half_view_rad = settings.space.horizontal_view_rad / 2.0
        draw_view(axes, floor_map, run.candidates, run.end, half_view_rad, settings.success_distance_m)
    _draw_scale(figure, right - left, height_in)
    _draw_words(figure, metrics, height_in)
    _draw_keys(figure, run, alarms, seconds, height_in)
    return figure


def _draw_scale(figure: Figure, shown_m: float, height_in: float) -> None:
    """A bar of one metre (five for large maps) at the upper right."""
    length_m = 1.0 if shown_m < 25.0 else 5.0
    right, width, low = 0.975, 0.96 * length_m / shown_m, 1.0 - 0.62 / height_in
    figure.add_artist(Rectangle((right - width, low), width, 0.03 / height_in, color=FAINT, lw=0))
    middle = right - width / 2
    figure.text(middle, low + 0.06 / height_in, f"{length_m:.0f} m", ha="center", fontsize=8, color=FAINT)


def _draw_words(figure: Figure, metrics: SearchMetrics, height_in: float) -> None:
    head = 1.0 - 0.28 / height_in
    words = figure.text(
        0.025, head, headline(metrics), fontsize=15, fontweight="bold", color=INK, va="center"
    )
    words.set_parse_math(False)  # a "$" in a name is a "$"
    figure.text(0.025, head - 0.3 / height_in, _summary(metrics), fontsize=10, color=MUTED, va="center")


def headline(metrics: SearchMetrics) -> str:
    """What was searched for and how it ended, in one line."""
    wanted = f"“{metrics.target}”" if metrics.target else "nothing in particular"
    return f"Searching for {wanted}: {_outcome(metrics)}".removesuffix(": ")


def _outcome(metrics: SearchMetrics) -> str:
    if metrics.found:
        return {True: "found", False: "the robot is mistaken", None: "the robot says found"}[metrics.success]
    if metrics.phase in (SearchPhase.SEARCHING, SearchPhase.DOCKING):
        return "not found yet"
    return (metrics.phase or "").replace("_", " ")


def _summary(metrics: SearchMetrics) -> str:
    parts = []
    if metrics.steps is not None:
        parts.append(f"{metrics.steps} steps")
    if metrics.path_length_m is not None:
        shortest = (
            f" (shortest {metrics.shortest_path_m:.1f} m)" if metrics.shortest_path_m is not None else ""
        )
        parts.append(f"{metrics.path_length_m:.1f} m driven{shortest}")
    if metrics.spl is not None:
        parts.append(f"SPL {metrics.spl:.2f}")
    if metrics.false_alarms is not None:
        parts.append(f"{metrics.false_alarms} false alarm{'s' * (metrics.false_alarms != 1)} survived")
    return "  ·  ".join(parts)


def _draw_keys(
    figure: Figure, run: SearchRun, alarms: Sequence[FalseAlarm], seconds: float, height_in: float
) -> None:
    handles = [
        _key("start", marker="o", ms=9, mfc="white", mec=INK, mew=1.4),
        _key("end", marker="o", ms=9, mfc=TIME_COLORS(1.0), mec="white", mew=1.0),
        _key("heading at a decision", marker="|", ms=8, mec=TIME_COLORS(0.5), mew=1.4),
    ]
    if run.targets:
        handles.append(_key(f"{run.target} (truth)", marker="*", ms=14, mfc=TARGET, mec=INK, mew=0.9))
    if run.objects:
        handles.append(_key("other objects", marker="o", ms=4, mfc=FAINT, mec="white", mew=0.5))
    if alarms:
        handles.append(_key(f"false alarms ({len(alarms)})", marker="x", ms=8, mec=FALSE_ALARM, mew=2.2))
    legend = figure.legend(
        handles=handles,
        loc="center",
        bbox_to_anchor=(0.5, 0.72 / height_in),
        ncol=len(handles),
        frameon=False,
        fontsize=9,
        labelcolor=INK,
        handletextpad=0.4,
        columnspacing=1.8,
    )
    for words in legend.get_texts():
        words.set_parse_math(False)
    time = Normalize(0.0, max(seconds, 1e-9))
    _bar(figure, 0.19, 0.13, height_in, TIME_COLORS, time, "way, by time", ("0 s", f"{seconds:.0f} s"))
    if run.belief is not None:
        ends = (f"{BELIEF_SPAN:.0f} × less", f"{BELIEF_SPAN:.0f} × more likely than at first")
        _bar(figure, 0.62, 0.19, height_in, BELIEF_COLORS, belief_norm(), "belief at the end", ends)


def _key(label: str, **style: Any) -> Line2D:
    return Line2D([], [], linestyle="none", label=label, **style)


def _bar(
    figure: Figure,
    left: float,
    name_width: float,
    height_in: float,
    colors: Colormap,
    norm: Normalize,
    name: str,
    ends: tuple[str, str],
) -> None:
    """A slim colour bar that begins at `left`, a word at each end of it, and its name further to the left."""
    axes = figure.add_axes((left, BAR_IN / height_in, 0.12, 0.1 / height_in))
    bar = figure.colorbar(ScalarMappable(norm=norm, cmap=colors), cax=axes, orientation="horizontal")
    bar.outline.set_visible(False)
    axes.set_xticks([])
    axes.minorticks_off()
    middle = (BAR_IN + 0.05) / height_in
    style: dict[str, Any] = {"fontsize": 8.5, "va": "center"}
    figure.text(left - name_width, middle, name, ha="left", color=INK, **style)
    figure.text(left - 0.007, middle, ends[0], ha="right", color=FAINT, **style)
    figure.text(left + 0.127, middle, ends[1], ha="left", color=FAINT, **style)
