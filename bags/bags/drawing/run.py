"""The run: the way and its headings, the robot, the things, and where the detector was wrong."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import patheffects
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import Normalize
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path as Outline
from matplotlib.transforms import Affine2D

from bags.false_alarms import FalseAlarm
from bags.search_run import SearchRun
from robustnav_msgs_py.values import Pose2D
from robustnav_nodes.drawing.colors import FAINT, FALSE_ALARM, INK, MUTED, TARGET, TIME_COLORS

TICK_M = 0.2
ARROW_HEAD = Outline([(1.0, 0.0), (-0.7, 0.7), (-0.35, 0.0), (-0.7, -0.7), (1.0, 0.0)], closed=True)


def draw_way(axes: Axes, run: SearchRun) -> float:
    """Draw the way; returns the seconds it took, in the robot's time."""
    if not run.odometry:
        return 0.0
    begun_ns = run.odometry[0].value.stamp_ns
    seconds = np.array([(heard.value.stamp_ns - begun_ns) / 1e9 for heard in run.odometry])
    places = np.array([(heard.value.pose.x_m, heard.value.pose.y_m) for heard in run.odometry])
    norm = Normalize(0.0, max(float(seconds[-1]), 1e-9))
    axes.plot(*places.T, color="white", lw=5.0, solid_joinstyle="round", solid_capstyle="round", zorder=3)
    way = LineCollection(
        list(np.stack([places[:-1], places[1:]], axis=1)),
        array=seconds[1:],
        cmap=TIME_COLORS,
        norm=norm,
        linewidths=2.6,
        capstyle="round",
        zorder=4,
    )
    axes.add_collection(way)
    _draw_ticks(axes, run, norm, begun_ns)
    _draw_robot(axes, run.odometry[0].value.pose, "white", INK)
    _draw_robot(axes, run.odometry[-1].value.pose, TIME_COLORS(1.0), "white")
    return float(seconds[-1])


def _draw_ticks(axes: Axes, run: SearchRun, norm: Normalize, begun_ns: int) -> None:
    """A short stroke for the heading at which each decision was made."""
    strokes, times = [], []
    for heard in run.decisions:
        decision = heard.value
        ahead = TICK_M * np.array([np.cos(decision.yaw_rad), np.sin(decision.yaw_rad)])
        here = np.array([decision.x_m, decision.y_m])
        strokes.append(np.stack([here, here + ahead]))
        times.append(_seconds_at(run, heard.log_time_ns, begun_ns))
    ticks = LineCollection(
        strokes, array=np.array(times), cmap=TIME_COLORS, norm=norm, linewidths=1.1, zorder=5
    )
    axes.add_collection(ticks)


def _seconds_at(run: SearchRun, log_time_ns: int, begun_ns: int) -> float:
    """The robot's time when the recorder's clock showed `log_time_ns`."""
    heard_ns = [heard.log_time_ns for heard in run.odometry]
    index = min(int(np.searchsorted(heard_ns, log_time_ns)), len(heard_ns) - 1)
    return (run.odometry[index].value.stamp_ns - begun_ns) / 1e9


def _draw_robot(axes: Axes, pose: Pose2D, fill: Any, edge: str) -> None:
    """A disc with an arrow head in it that points ahead."""
    axes.plot(pose.x_m, pose.y_m, "o", ms=15, mfc=fill, mec=edge, mew=1.6, zorder=7)
    ahead = MarkerStyle(ARROW_HEAD, transform=Affine2D().rotate(pose.yaw_rad))
    axes.plot(pose.x_m, pose.y_m, marker=ahead, ms=8.5, mfc=edge, mec="none", zorder=8)


def draw_objects(axes: Axes, run: SearchRun) -> None:
    outline = [patheffects.withStroke(linewidth=2.0, foreground="white")]
    for item in run.objects or ():
        is_target = item.label == run.target
        if is_target:
            axes.plot(item.x_m, item.y_m, "*", ms=21, mfc=TARGET, mec=INK, mew=1.1, zorder=9)
        else:
            axes.plot(item.x_m, item.y_m, "o", ms=3.6, mfc=FAINT, mec="white", mew=0.6, zorder=3)
        axes.annotate(
            item.label,
            (item.x_m, item.y_m),
            xytext=(0.0, -13.0 if is_target else -5.0),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=9.0 if is_target else 6.5,
            fontweight="bold" if is_target else "normal",
            color=INK if is_target else MUTED,
            path_effects=outline,
            parse_math=False,  # a "$" in a name is a "$"
            zorder=9 if is_target else 3,
        )


def draw_alarms(axes: Axes, alarms: Sequence[FalseAlarm]) -> None:
    casing = [patheffects.withStroke(linewidth=4.5, foreground="white")]
    x_m, y_m = [alarm.x_m for alarm in alarms], [alarm.y_m for alarm in alarms]
    axes.plot(x_m, y_m, "x", ms=9, mew=2.4, color=FALSE_ALARM, path_effects=casing, zorder=6)
