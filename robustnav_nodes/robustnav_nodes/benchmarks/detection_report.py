"""The figures of `robustnav bench detection` as rows of its JSON report."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.detection_bench import Measured
from robustnav_nodes.benchmarks.detection_instances import top1
from robustnav_nodes.benchmarks.detection_scores import calibration_error
from robustnav_nodes.benchmarks.detection_tally import ALL, ClassScore, Tally


def report_content(found: Sequence[Measured]) -> dict[str, Any]:
    """`rows`: of each degradation the row of all classes, then a row for each class."""
    rows: list[dict[str, Any]] = []
    for measured in found:
        rows.append(overall_row(measured))
        rows += [_row(score, measured) for score in measured.tally.class_scores()[1:]]
    return {"rows": rows}


def overall_row(measured: Measured) -> dict[str, Any]:
    """All classes together, with what is only told of all.

    image_ms is a median; place_error_m: from where a right detection was placed to the object's centre.
    """
    return {
        **_row(measured.tally.class_scores()[0], measured),
        **tally_figures(measured.tally),
        "instance_trials": len(measured.choices),
        "image_ms_p95": _percentile(measured.image_ms, 95.0),
        "place_error_m_p50": _percentile(measured.place_error_m, 50.0),
        "place_error_m_p90": _percentile(measured.place_error_m, 90.0),
    }


def tally_content(tally: Tally) -> dict[str, Any]:
    """`rows`: that of all classes, then a row for each class; without what a bag does not tell."""
    overall, *classes = ({"class": row.pop("label"), **row} for row in map(asdict, tally.class_scores()))
    return {"rows": [{**overall, **tally_figures(tally)}, *classes]}


def tally_figures(tally: Tally) -> dict[str, Any]:
    """How far scores are from what they are worth, and recall by distance and visible part."""
    bins = tally.score_bins()
    return {
        "images": tally.images,
        "calibration_error": calibration_error(bins) if bins else None,
        "reliability": [asdict(row) for row in bins],
        "recall_by_range": [asdict(row) for row in tally.recall_by_range()],
        "recall_by_visible_part": [asdict(row) for row in tally.recall_by_visible_part()],
    }


def _row(score: ClassScore, measured: Measured) -> dict[str, Any]:
    figures = asdict(score)
    label = figures.pop("label")
    return {
        "class": label,
        "degradation": measured.degradation,
        **figures,
        "instance_top1": top1(measured.choices, None if label == ALL else label),
        "image_ms": _percentile(measured.image_ms, 50.0),
    }


def _percentile(values: Float64, part: float) -> float | None:
    return float(np.percentile(values, part)) if len(values) else None
