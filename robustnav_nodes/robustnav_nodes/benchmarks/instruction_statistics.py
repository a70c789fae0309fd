"""What a pack's episodes with errors hold, beside the thesis' table 4.1."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from robustnav_nodes.instruction.common_sense import anything_goes
from robustnav_nodes.instruction.episodes import ERROR_TYPES
from robustnav_nodes.instruction.injection import (
    PROTOCOLS,
    ErrorStatistics,
    Protocol,
    episodes_put_in,
    error_statistics,
)
from robustnav_nodes.instruction.r2r_pack import R2rPack

SEED = 1  # of the errors that are put in anew


@dataclass(frozen=True, slots=True, kw_only=True)
class ThesisRow:
    """A row of table 4.1: R2RIE-CE, val unseen."""

    episodes: int
    errors_per_episode: float
    mean_tokens: float


THESIS = {
    "direction": ThesisRow(episodes=3218, errors_per_episode=1.0, mean_tokens=31.59),
    "room": ThesisRow(episodes=2064, errors_per_episode=1.0, mean_tokens=32.05),
    "object": ThesisRow(episodes=3162, errors_per_episode=1.0, mean_tokens=30.94),
    "room_object": ThesisRow(episodes=1734, errors_per_episode=2.0, mean_tokens=33.35),
    "all": ThesisRow(episodes=1586, errors_per_episode=3.0, mean_tokens=34.58),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class StatisticsRow:
    """The episodes of one type of error in one split, by one protocol."""

    protocol: Protocol
    split: str
    statistics: ErrorStatistics


def pack_statistics(folder: Path, splits: list[str], *, common_sense: bool = True) -> Iterator[StatisticsRow]:
    """A row for each protocol, split (all where none is named) and type of error of the pack.

    Without `common_sense` of errors that are put in anew, in which any room may replace any, and any object.
    Raises BadFileError where the pack cannot be read or has no such split.
    """
    pack = R2rPack(folder)
    for protocol in PROTOCOLS:
        for split in splits or pack.splits:
            anew = (
                None
                if common_sense
                else episodes_put_in(pack.instructions(split), anything_goes(), protocol, SEED)
            )
            for error_type in ERROR_TYPES:
                episodes = pack.episodes(split, protocol, error_type) if anew is None else anew[error_type]
                yield StatisticsRow(
                    protocol=protocol, split=split, statistics=error_statistics(error_type, episodes)
                )
