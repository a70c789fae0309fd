"""What was assumed of the detector and what searches have taught since, by class."""

import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from scipy.special import betaincinv

from robustnav_msgs_py.detector_statistics import ClassStatistics, DetectorStatistics
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.records import DetectorRecord
from robustnav_nodes.belief.online_statistics import Observed, OnlineStatistics

UPPER_BOUND = 0.95


class LearntStatistics:
    """Beta posteriors by class over the assumed statistics. Owned by the belief node; one thread.

    pseudo_count: how many looks the assumed statistics are worth. `observed` is what was seen so far.
    """

    def __init__(
        self, assumed: DetectorStatistics, pseudo_count: float, observed: Mapping[str, Observed] | None = None
    ) -> None:
        self._assumed = assumed
        self._pseudo_count = pseudo_count
        self.observed: dict[str, Observed] = dict(observed or {})

    def online(self, label: str) -> OnlineStatistics:
        """The posterior of a class."""
        return self._prior(label).with_observed(self.observed.get(label, Observed()))

    def of(self, label: str) -> ClassStatistics:
        """Posterior means; the assumed statistics, to the last bit, while nothing was observed.

        Recall by range keeps its course and is scaled with the mean.
        """
        assumed = self._assumed.of(label)
        if label not in self.observed:
            return assumed
        learnt = self.online(label).statistics
        by_range = assumed.recall_by_range
        if by_range is not None and assumed.recall > 0.0:
            by_range = by_range.scaled(learnt.recall / assumed.recall)
        return replace(learnt, recall_by_range=by_range)

    def learn(self, label: str, online: OnlineStatistics) -> None:
        """Take over a posterior that was made from `online(label)`."""
        self.observed[label] = online.observed_since(self._prior(label))

    def record(self, label: str) -> DetectorRecord:
        """What is believed of the detector on a class, and what was assumed, for people and other nodes."""
        assumed, now, seen = self._assumed.of(label), self.of(label), self.observed.get(label, Observed())
        return DetectorRecord(
            label=label,
            precision=now.precision,
            recall=now.recall,
            precision_assumed=assumed.precision,
            recall_assumed=assumed.recall,
            detected=seen.detected,
            missed=seen.missed,
            true_firings=seen.true_firings,
            false_firings=seen.false_firings,
        )

    def complaint(self, label: str) -> str:
        """A sentence where the detector is surely worse than assumed on a class, else ""."""
        if label not in self.observed:
            return ""
        assumed, online = self._assumed.of(label), self.online(label)
        recall_at_most = _upper_bound(online.detected, online.missed)
        precision_at_most = _upper_bound(online.true_firings, online.false_firings)
        worse = []
        if recall_at_most < assumed.recall:
            worse.append(f"recall at most {recall_at_most:.2f}, assumed {assumed.recall:.2f}")
        if precision_at_most < assumed.precision:
            worse.append(f"precision at most {precision_at_most:.2f}, assumed {assumed.precision:.2f}")
        if not worse:
            return ""
        return (
            f"the detector is worse on class {label!r} than assumed ({'; '.join(worse)}): "
            "measure it anew with robustnav bench detection --statistics, or train it for this home"
        )

    def _prior(self, label: str) -> OnlineStatistics:
        return OnlineStatistics.starting_from(self._assumed.of(label), self._pseudo_count)


def read_observed(path: Path) -> dict[str, Observed]:
    """What was observed in earlier runs; nothing where the file is not there yet.

    Raises BadFileError where it cannot be read or holds anything else.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise BadFileError(f"cannot read what was learnt, {str(path)!r}: {error.strerror}") from error
    except ValueError as error:
        raise BadFileError(f"what was learnt, {str(path)!r}, is not JSON: {error}; move it away") from error
    classes = content.get("observed") if isinstance(content, dict) else None
    if not isinstance(classes, dict):
        raise BadFileError(f"{str(path)!r} must be an object with 'observed'; move it away to begin anew")
    return {label: _observed(label, row, path) for label, row in classes.items()}


def write_observed(path: Path, observed: Mapping[str, Observed]) -> None:
    """Write the file, whole or not at all. Raises BadFileError where it cannot be written."""
    content = {"observed": {label: asdict(row) for label, row in sorted(observed.items())}}
    unfinished = path.with_name(path.name + ".part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
        unfinished.replace(path)
    except OSError as error:
        raise BadFileError(f"cannot write what was learnt to {str(path)!r}: {error.strerror}") from error


def _observed(label: str, row: Any, path: Path) -> Observed:
    names = set(Observed.__dataclass_fields__)
    fits = isinstance(row, dict) and row.keys() == names
    if not fits or not all(
        isinstance(value, (int, float)) and not isinstance(value, bool) and 0.0 <= value < float("inf")
        for value in row.values()
    ):
        raise BadFileError(
            f"class {label!r} in {str(path)!r} must hold {', '.join(sorted(names))}, each 0 or more; "
            "move the file away to begin anew"
        )
    return Observed(**{name: float(value) for name, value in row.items()})


def _upper_bound(hits: float, misses: float) -> float:
    """Below this the rate lies with probability UPPER_BOUND, by a Beta(hits, misses)."""
    return float(betaincinv(hits, misses, UPPER_BOUND))
