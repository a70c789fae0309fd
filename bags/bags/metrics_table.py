"""Metrics of many recorded searches: a row for each, the means with what they are taken over, and a table."""

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from bags.episodes import ACTIVE, EpisodeSpan, episode_spans, robots
from bags.metrics import SearchMetrics, search_metrics
from bags.reader import Bag
from bags.recorded_values import recorded_values
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.benchmarks.bootstrap import mean_intervals

# What the thesis measures of instructions that may be wrong; no topic of ours carries it yet.
NOT_TOLD_YET = ("SIN", "MIN", "AUC", "ATD")
ANSWERS = "chat/to_user"
UNKNOWN = "–"
NAMES: Mapping[str, str] = MappingProxyType(
    {
        "sr": "SR",
        "apl": "APL (successes) m",
        "spl": "SPL",
        "steps": "steps",
        "false_alarms": "false alarms",
        "nq_success": "NQ (successes)",
        "nq_all": "NQ (all)",
        "sim_duration_s": "robot's time s",
        "wall_duration_s": "wall time s",
    }
)


COLUMNS = ("no.", "target", "success", "steps", "path", "shortest", "SPL", "alarms", "NQ", "time", "wall")


@dataclass(frozen=True, slots=True, kw_only=True)
class MetricsRow:
    """One search of the robot `robot` (its namespace, "" for none) in a bag.

    `questions` is how many lines with a question mark at their end the robot said to the person, from the end
    of the search before until the end of this one; None where what it said was not recorded.
    """

    bag: str
    robot: str
    metrics: SearchMetrics
    questions: int | None

    def as_mapping(self) -> dict[str, Any]:
        """The row without what the bag does not tell."""
        measured = {item.name: getattr(self.metrics, item.name) for item in fields(self.metrics)}
        told = {"bag": self.bag, "robot": self.robot or None, **measured, "nq": self.questions}
        return {name: value for name, value in told.items() if value is not None}


@dataclass(frozen=True, slots=True, kw_only=True)
class Mean:
    """Mean over the `count` searches that tell it, with its 95 % interval (None for a single one)."""

    name: str
    value: float
    count: int
    interval: tuple[float, float] | None


def metrics_rows(bag: Bag) -> tuple[MetricsRow, ...]:
    """A row for each search in `bag`, by robot and in their order.

    Where nobody told how a search stood, the bag as a whole is one. How a search went that had not ended when
    the bag did is not known. Raises BadFileError where no search began, and what `search_metrics` raises.
    """
    rows = []
    told_by = robots(bag)
    for robot in told_by or ("",):
        spans = episode_spans(bag, robot)
        for span in spans if told_by else (None,):
            metrics = search_metrics(
                bag, namespace=robot if span else None, episode=span.episode if span else None
            )
            if metrics.phase in ACTIVE:
                metrics = replace(metrics, found=None, success=None, spl=None)
            questions = _questions(bag, robot, span)
            rows.append(MetricsRow(bag=str(bag.path), robot=robot, metrics=metrics, questions=questions))
    if not rows:
        raise BadFileError(f"{bag.path} holds no search: none had begun when it ended")
    return tuple(rows)


def _questions(bag: Bag, robot: str, span: EpisodeSpan | None) -> int | None:
    if not any(row.name == f"{robot}/{ANSWERS}" for row in bag.topics):
        return None
    return sum(
        said.value.rstrip().endswith("?")
        for said in recorded_values(bag, [ANSWERS], namespace=robot)
        if span is None or span.led_here(said.log_time_ns)
    )


def means(rows: Sequence[MetricsRow]) -> tuple[Mean, ...]:
    """Means of what at least one row tells. APL and `nq_success` are over the successful searches (C12)."""
    successes = [row for row in rows if row.metrics.success]
    found = (
        _mean("sr", rows, lambda row: row.metrics.success),
        _mean("apl", successes, lambda row: row.metrics.path_length_m),
        _mean("spl", rows, lambda row: row.metrics.spl),
        _mean("steps", rows, lambda row: row.metrics.steps),
        _mean("false_alarms", rows, lambda row: row.metrics.false_alarms),
        _mean("nq_success", successes, lambda row: row.questions),
        _mean("nq_all", rows, lambda row: row.questions),
        _mean("sim_duration_s", rows, lambda row: row.metrics.sim_duration_s),
        _mean("wall_duration_s", rows, lambda row: row.metrics.wall_duration_s),
    )
    return tuple(mean for mean in found if mean is not None)


def _mean(name: str, rows: Sequence[MetricsRow], value: Callable[[MetricsRow], float | None]) -> Mean | None:
    told = [float(found) for row in rows if (found := value(row)) is not None and math.isfinite(found)]
    if not told:
        return None
    interval = mean_intervals(np.array(told)[:, np.newaxis])[0] if len(told) > 1 else None
    return Mean(name=name, value=float(np.mean(told)), count=len(told), interval=interval)


def report_content(rows: Sequence[MetricsRow]) -> dict[str, Any]:
    """What the JSON file holds: `rows`, and `means` as name, name_ci and name_episodes."""
    summary: dict[str, Any] = {}
    for mean in means(rows):
        summary[mean.name] = mean.value
        summary[f"{mean.name}_episodes"] = mean.count
        if mean.interval is not None:
            summary[f"{mean.name}_ci"] = list(mean.interval)
    return {"episodes": len(rows), "rows": [row.as_mapping() for row in rows], "means": summary}


def render(rows: Sequence[MetricsRow]) -> RenderableType:
    """The tables that a terminal shows."""
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0), header_style="bold")
    table.add_column("bag", overflow="fold")
    for name in COLUMNS:
        table.add_column(name, justify="left" if name in ("target", "success") else "right", no_wrap=True)
    short = _without_common_folders([row.bag for row in rows])
    for row in rows:
        told = row.metrics
        table.add_row(
            escape(f"{short[row.bag]} {row.robot}".rstrip()),
            str(told.episode),
            escape(told.target) or UNKNOWN,
            {True: "yes", False: "no", None: UNKNOWN}[told.success],
            _cell(told.steps, 0),
            _cell(told.path_length_m, 2),
            _cell(told.shortest_path_m, 2),
            _cell(told.spl, 2),
            _cell(told.false_alarms, 0),
            _cell(row.questions, 0),
            _cell(told.sim_duration_s, 1),
            _cell(told.wall_duration_s, 1),
        )
    found = means(rows)
    parts: list[RenderableType] = [table]
    if len(rows) > 1:
        parts += [Text(), _means_table(found)]
    untold = [name for name in NAMES if name not in {mean.name for mean in found}]
    parts.append(
        Text("\nmetres; seconds of the robot's and of the wall's clock; NQ: questions the robot asked")
    )
    if untold:
        parts.append(Text(f"not told by these bags: {', '.join(NAMES[name] for name in untold)}"))
    parts.append(Text(f"not told by any bag yet: {', '.join(NOT_TOLD_YET)}"))
    return Group(*parts)


def _without_common_folders(bags: Sequence[str]) -> Mapping[str, str]:
    """Paths of bags by what tells them apart."""
    absolute = {bag: Path(bag).absolute() for bag in bags}
    common = os.path.commonpath([path.parent for path in absolute.values()])
    return {bag: str(path.relative_to(common)) for bag, path in absolute.items()}


def _means_table(found: Sequence[Mean]) -> Table:
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("mean of")
    for name in ("", "95 % interval", "episodes"):
        table.add_column(name, justify="right")
    for mean in found:
        ends = UNKNOWN if mean.interval is None else f"{mean.interval[0]:.2f} .. {mean.interval[1]:.2f}"
        table.add_row(NAMES[mean.name], f"{mean.value:.2f}", ends, str(mean.count))
    return table


def _cell(value: float | None, digits: int) -> str:
    return UNKNOWN if value is None else f"{value:.{digits}f}"
