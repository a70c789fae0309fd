"""What a tally tells of a detector, as the file that belief and planner read."""

import json
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Bool
from robustnav_nodes.benchmarks.detection_tally import Found, Tally, There

# A target at the far end of a candidate's view cone; nearer bins are narrower where recall changes most.
EDGES_M = (0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0)
RANGE_MAX_M = 4.0
VISIBLE_MIN = 0.3
# A class's own figures count as much as those of all classes together after this many objects of it.
BORROWED = 5.0


def statistics_content(tally: Tally) -> dict[str, Any]:
    """Precision, recall within RANGE_MAX_M and recall by range, for each class that was there.

    Recall is of objects of any size in the image of which nothing hides more than the belief's own rule
    about sight allows for: what a belief asks is whether a target in view is detected. Classes of which
    little was seen borrow from all.
    """
    found, there = tally.found(), tally.there()
    everything = np.ones(len(there.label), dtype=np.bool_)
    said = np.ones(len(found.label), dtype=np.bool_)
    common_precision = _precision(found, said, tally.score_min, 0.5)
    common = _recalls(tally, there, everything, None)
    classes = {}
    for number, label in enumerate(tally.labels):
        real = there.label == number
        if not real.any():
            continue
        overall, by_range = _recalls(tally, there, real, common)
        classes[label] = {
            "precision": _precision(found, found.label == number, tally.score_min, common_precision),
            "recall": overall,
            "recall_by_range": {"edges_m": list(EDGES_M), "recall": by_range},
        }
    unknown = {"precision": common_precision, "recall": common[0]}
    return {"unknown_class": unknown, "classes": classes}


def write_statistics(path: Path, tally: Tally) -> None:
    """Write the file; raises BadFileError where it cannot be written."""
    text = json.dumps(statistics_content(tally), indent=1, allow_nan=False) + "\n"
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise BadFileError(f"cannot write the statistics {str(path)!r}: {error.strerror}") from error


def _precision(found: Found, said: Bool, score_min: float, common: float) -> float:
    """What was found of an object too small or too hidden to count was right all the same."""
    firm = said & (found.score >= score_min)
    right = found.is_true[firm] | found.is_void[firm]
    return _borrowing(float(right.sum()), int(firm.sum()), common)


def _recalls(
    tally: Tally, there: There, real: Bool, common: tuple[float, Sequence[float]] | None
) -> tuple[float, list[float]]:
    """Recall within RANGE_MAX_M, and in each bin of EDGES_M; an empty bin has that of the one before."""
    hit = there.score >= tally.score_min
    real = real & (there.visible >= VISIBLE_MIN)
    within = real & (there.distance_m <= RANGE_MAX_M)
    overall = _borrowing(float(hit[within].sum()), int(within.sum()), common[0] if common else 0.5)
    by_range: list[float] = []
    for number, (low, high) in enumerate(pairwise(EDGES_M)):
        inside = real & (there.distance_m >= low) & (there.distance_m < high)
        before = by_range[-1] if by_range else overall
        usual = common[1][number] if common else before
        by_range.append(_borrowing(float(hit[inside].sum()), int(inside.sum()), usual))
    return overall, by_range


def _borrowing(hits: float, tries: int, usual: float) -> float:
    return round((hits + BORROWED * usual) / (tries + BORROWED), 4)
