"""What the planner believes in the course of one episode with false alarms, as in the thesis' fig. 3.4."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg  # no screen
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PatchCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.contestants import Contestant
from robustnav_nodes.benchmarks.search_episode import BeliefMoment, EpisodeResult, run_episode
from robustnav_nodes.benchmarks.search_plan import SceneJob, chance_of, drawn_episode
from robustnav_nodes.benchmarks.search_plots import DPI, save
from robustnav_nodes.benchmarks.search_scene import SearchScene, SearchTarget
from robustnav_nodes.drawing.colors import (
    BELIEF_COLORS,
    BELIEF_SPAN,
    FALSE_ALARM,
    FLOOR,
    INK,
    MUTED,
    TARGET,
    TIME_COLORS,
    UNKNOWN,
    WALL,
    belief_norm,
)
from robustnav_nodes.search_space.floor_grid import FREE, OCCUPIED
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.space import SearchSpace

PANELS = 6
STEPS = range(15, 100)  # of an episode that is worth a picture
_COLUMNS = 3
_EPISODES_LOOKED_AT = 30
_HEADING_M = 0.35


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FalseAlarm:
    """A detection from a pose that has the target not in view. look: number of the look, from 0."""

    look: int
    x_m: float
    y_m: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ToldEpisode:
    """An episode with the belief after each look."""

    scene: SearchScene
    target: SearchTarget
    result: EpisodeResult
    moments: tuple[BeliefMoment, ...]
    alarms: tuple[FalseAlarm, ...]


def fooled_episode(jobs: Sequence[SceneJob], planner: str, detector: str) -> ToldEpisode | None:
    """The first episode of the plan that succeeds, of middling length, although a false alarm came first.

    None where `planner` does not play or there is none among the first few.
    """
    looked_at = 0
    for job in jobs:
        if job.detectors is not None and detector not in job.detectors:
            continue
        contestant = next((each for each in job.contestants if each.name == planner), None)
        if contestant is None:
            return None
        scene = job.load()
        if not all(detector in target.detections for target in scene.targets):
            continue
        for number in job.numbers:
            told = replayed(scene, contestant, detector, seed=job.seed, number=number)
            if told.result.is_success and told.result.steps in STEPS and _fooled(told):
                return told
            looked_at += 1
            if looked_at == _EPISODES_LOOKED_AT:
                return None
    return None


def replayed(
    scene: SearchScene, contestant: Contestant, detector: str, *, seed: int, number: int
) -> ToldEpisode:
    """Play episode `number` again, as `play` did."""
    target, start = drawn_episode(scene, detector, seed=seed, number=number, dock=contestant.planner.dock)
    record = target.detections[detector]
    moments: list[BeliefMoment] = []
    result = run_episode(
        scene,
        target,
        detector,
        start,
        contestant.planner_for(record.statistics),
        contestant.belief,
        chance_of(scene, seed=seed, number=number),
        moments,
    )
    candidates = scene.space.candidates
    alarms: list[FalseAlarm] = []
    for look, moment in enumerate(moments):
        if target.in_view[moment.pose] or any(moment.pose == moments[a.look].pose for a in alarms):
            continue
        for density in record.at(moment.pose, len(candidates)):
            place = int(np.argmax(density))
            alarms.append(
                FalseAlarm(look=look, x_m=float(candidates.x_m[place]), y_m=float(candidates.y_m[place]))
            )
    return ToldEpisode(
        scene=scene, target=target, result=result, moments=tuple(moments), alarms=tuple(alarms)
    )


def draw_belief(told: ToldEpisode, planner: str, png: Path) -> None:
    """Six moments of the episode. Raises BadFileError where the file cannot be written."""
    space = told.scene.space
    left, right, bottom, top = _shown(space)
    panel_in = 3.6
    rows = PANELS // _COLUMNS
    height_in = panel_in * (top - bottom) / (right - left)
    figure = Figure(
        figsize=(_COLUMNS * panel_in + 0.9, rows * (height_in + 0.3) + 0.8), dpi=DPI, layout="constrained"
    )
    FigureCanvasAgg(figure)
    grid = figure.subplots(rows, _COLUMNS)
    place = likeliest_place(told.target, space.observability)
    for axes, look in zip(grid.flat, shown_looks(told), strict=True):
        _draw_moment(axes, told, look, place)
        axes.set(xlim=(left, right), ylim=(bottom, top), aspect="equal")
        axes.axis("off")
    alarms = len(told.alarms)
    figure.suptitle(
        f"What {planner} believes while it looks for {told.target.label} in {told.scene.name}: "
        f"found after {told.result.steps} steps, {alarms} false alarm{'s' * (alarms != 1)} on the way",
        color=INK,
        fontweight="bold",
        fontsize=11,
    ).set_parse_math(False)
    colors = figure.colorbar(
        ScalarMappable(belief_norm(), BELIEF_COLORS), ax=grid, shrink=0.5, aspect=30, pad=0.02
    )
    colors.set_label("probability, times that of knowing nothing", color=MUTED, fontsize=8)
    colors.ax.tick_params(labelsize=7, colors=MUTED)
    keys = [
        Line2D([], [], marker="*", ms=11, mfc=TARGET, mec=INK, lw=0, label="target"),
        Line2D([], [], marker="x", ms=7, mew=2, color=FALSE_ALARM, lw=0, label="false alarm so far"),
        Line2D([], [], color=TIME_COLORS(0.7), lw=2, label="way so far"),
        Line2D([], [], marker="o", ms=7, mfc=TIME_COLORS(1.0), mec="white", lw=0, label="robot"),
        Rectangle((0, 0), 1, 1, fc="none", ec=TIME_COLORS(1.0), lw=1.0, label="in view"),
    ]
    figure.legend(handles=keys, loc="outside lower center", ncols=len(keys), frameon=False, fontsize=9)
    save(figure, png)


def shown_looks(told: ToldEpisode) -> list[int]:
    """The looks to show: the first, the first false alarm, the last, and between them the widest gaps halved.

    PANELS numbers, ascending; some twice where the episode is shorter.
    """
    last = len(told.moments) - 1
    looks = [0, *(alarm.look for alarm in told.alarms[:1] if 0 < alarm.look < last), last]
    while len(looks) < PANELS:
        gap = int(np.argmax(np.diff(looks)))
        looks.insert(gap + 1, (looks[gap] + looks[gap + 1]) // 2)
    return looks


def likeliest_place(target: SearchTarget, observability: Observability) -> int:
    """The candidate that is seen from the very poses that have the target in view, or from the most alike."""
    both = np.array(
        [np.count_nonzero(target.in_view[observability.seers_of(j)]) for j in range(observability.candidates)]
    )
    seers = np.diff(observability.seers_start)
    either = np.count_nonzero(target.in_view) + seers - both
    return int(np.argmax(both / np.maximum(either, 1)))


def _fooled(told: ToldEpisode) -> bool:
    """Whether a false alarm came after the start and before the target was first in view."""
    first = next(look for look, moment in enumerate(told.moments) if told.target.in_view[moment.pose])
    return any(0 < alarm.look < first for alarm in told.alarms)


def _draw_moment(axes: Axes, told: ToldEpisode, look: int, place: int) -> None:
    space, moment = told.scene.space, told.moments[look]
    candidates, graph = space.candidates, space.graph
    _draw_floor(axes, space)
    _draw_belief(axes, space, moment)
    way = [each.pose for each in told.moments[: look + 1]]
    x_m, y_m = graph.x_m[way], graph.y_m[way]
    axes.plot(x_m, y_m, color="white", lw=3.4, solid_capstyle="round", zorder=4)
    axes.plot(x_m, y_m, color=TIME_COLORS(0.7), lw=1.7, solid_capstyle="round", zorder=5)
    so_far = [alarm for alarm in told.alarms if alarm.look <= look]
    for alarm in so_far:
        axes.plot(alarm.x_m, alarm.y_m, "x", ms=9, mew=4.0, color="white", zorder=6)
        axes.plot(alarm.x_m, alarm.y_m, "x", ms=8, mew=2.2, color=FALSE_ALARM, zorder=7)
    axes.plot(
        candidates.x_m[place], candidates.y_m[place], "*", ms=13, mfc=TARGET, mec=INK, mew=0.9, zorder=8
    )
    here, yaw_rad = (x_m[-1], y_m[-1]), graph.yaw_rad[moment.pose]
    ahead = (here[0] + _HEADING_M * np.cos(yaw_rad), here[1] + _HEADING_M * np.sin(yaw_rad))
    axes.plot(*zip(here, ahead, strict=True), color=TIME_COLORS(1.0), lw=2.0, zorder=9)
    axes.plot(*here, "o", ms=7, mfc=TIME_COLORS(1.0), mec="white", mew=1.0, zorder=10)
    axes.set_title(_title(told, look), fontsize=9, color=INK, loc="left", pad=3)


def _title(told: ToldEpisode, look: int) -> str:
    moment = told.moments[look]
    in_view = told.scene.space.observability.row(moment.pose)
    what = "start" if look == 0 else f"step {look}"
    if look == len(told.moments) - 1:
        what += ": found"
    elif any(alarm.look == look for alarm in told.alarms):
        what += ": false alarm"
    return f"{what}   ({moment.probability[in_view].sum():.0%} in view)"


def _draw_floor(axes: Axes, space: SearchSpace) -> None:
    """Walls where there is a map, else the places where the robot can stand."""
    if space.view is None:
        axes.plot(space.graph.x_m, space.graph.y_m, ".", ms=2, color=UNKNOWN, zorder=0)
        return
    grid = space.view.grid
    colors = np.empty((*grid.kind.shape, 3))
    colors[:] = to_rgb(UNKNOWN)
    colors[grid.kind == FREE] = to_rgb(FLOOR)
    colors[grid.kind == OCCUPIED] = to_rgb(WALL)
    rows, columns = grid.kind.shape
    extent = (
        grid.x_m,
        grid.x_m + columns * grid.resolution_m,
        grid.y_m,
        grid.y_m + rows * grid.resolution_m,
    )
    axes.imshow(colors, extent=extent, origin="lower", interpolation="nearest", zorder=0)


def _draw_belief(axes: Axes, space: SearchSpace, moment: BeliefMoment) -> None:
    ratio = np.clip(moment.probability * len(space.candidates), 1.0 / BELIEF_SPAN, BELIEF_SPAN)
    colors = BELIEF_COLORS(belief_norm()(ratio))
    squares = PatchCollection(_squares(space, np.arange(len(ratio))), facecolors=colors, lw=0, zorder=1)
    axes.add_collection(squares)
    seen = _squares(space, space.observability.seen_by(moment.pose))
    axes.add_collection(
        PatchCollection(seen, facecolors="none", edgecolors=TIME_COLORS(1.0), linewidths=0.5, zorder=2)
    )


def _squares(space: SearchSpace, which: NDArray[np.integer]) -> list[Rectangle]:
    side_m = space.candidates.size_m
    corner: Float64 = np.stack([space.candidates.x_m, space.candidates.y_m], axis=1) - 0.5 * side_m
    return [Rectangle(tuple(corner[j]), side_m, side_m) for j in which]


def _shown(space: SearchSpace) -> tuple[float, float, float, float]:
    """Left, right, bottom, top in metres, with a small margin."""
    x_m = np.concatenate([space.graph.x_m, space.candidates.x_m])
    y_m = np.concatenate([space.graph.y_m, space.candidates.y_m])
    margin_m = 0.5
    return (x_m.min() - margin_m, x_m.max() + margin_m, y_m.min() - margin_m, y_m.max() + margin_m)
