"""Our model: every mention is judged by what was seen while it was being walked; one wrong one is enough.

Boosted trees and a small transformer score the rows of `mention_features`; the mean of their log odds counts.
`score_scale` makes one score of it. A blind model is the same without all that was seen.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import KINDS
from robustnav_nodes.instruction.mention_features.columns import Knowledge
from robustnav_nodes.instruction.mention_features.rows import mention_rows
from robustnav_nodes.instruction.mention_network import MentionNetwork
from robustnav_nodes.instruction.mentions import Mention, find_mentions
from robustnav_nodes.instruction.scene import Scene, scene_of
from robustnav_nodes.instruction.score_scale import ScoreScale
from robustnav_nodes.instruction.trajectory import Trajectory
from robustnav_nodes.instruction.trees import Trees, mean_log_odds
from robustnav_nodes.instruction.verdict import Verdict

MAX_PLACES = 60  # of a longer walk so many, evenly spread, are looked at


@dataclass(frozen=True, slots=True, kw_only=True)
class Scorer:
    """Trees by kind of mention, and one network for all; blind ones see wording only."""

    trees: Mapping[str, tuple[Trees, ...]]
    network: MentionNetwork
    scale: ScoreScale
    blind: bool

    def mention_odds(self, rows: NDArray[np.float32], kinds: Sequence[str], blind_columns: int) -> Float64:
        """Log odds that each mention of one instruction is wrong."""
        seen = rows[:, :blind_columns] if self.blind else rows
        if not len(seen):
            return np.zeros(0)
        odds: Float64 = (odds_of_trees(self.trees, seen, kinds) + self.network.log_odds(seen)) / 2.0
        return odds

    def error_odds(self, odds: Float64, kinds: Sequence[str]) -> float:
        """Log odds that the instruction is wrong, from those of its mentions."""
        return self.scale.log_odds(odds, np.array([KINDS.index(kind) for kind in kinds], dtype=np.int64))


def odds_of_trees(
    trees: Mapping[str, tuple[Trees, ...]], rows: NDArray[np.float32], kinds: Sequence[str]
) -> Float64:
    """Log odds of each row by the trees for its kind of mention."""
    odds = np.zeros(len(kinds))
    for kind in KINDS:
        of_kind = np.array([k == kind for k in kinds], dtype=bool)
        if of_kind.any():
            odds[of_kind] = mean_log_odds(trees[kind], rows[of_kind])
    return odds


class MentionModel:
    """A judge for one protocol; not thread-safe (it keeps the last walk's arrays)."""

    def __init__(self, knowledge: Knowledge, scorer: Scorer, features: tuple[str, ...]) -> None:
        self._knowledge = knowledge
        self._scorer = scorer
        self._features = features
        self._last: tuple[Trajectory, Scene, Float64] | None = None

    def judge(self, trajectory: Trajectory, tokens: Sequence[str]) -> Verdict:
        mentions = find_mentions(tokens)
        odds = self.mention_odds(trajectory, tokens, mentions)
        order = np.argsort(-odds, kind="stable")
        error_odds = self._scorer.error_odds(odds, [m.kind for m in mentions])
        return Verdict(
            error_score=float(1.0 / (1.0 + np.exp(-error_odds))),
            # not shifted, as the score is: the likeliest wrong comes first
            doubts=tuple((mentions[k].start, float(1.0 / (1.0 + np.exp(-odds[k])))) for k in order),
        )

    def mention_odds(
        self, trajectory: Trajectory, tokens: Sequence[str], mentions: Sequence[Mention]
    ) -> Float64:
        """Log odds that each mention is wrong, as far as the walk goes."""
        if not mentions:
            return np.zeros(0)
        if self._last is None or self._last[0] is not trajectory:
            scene = scene_of(thinned(trajectory))
            self._last = (trajectory, scene, self._knowledge.places.evidence(scene))
        rows = mention_rows(self._last[1], self._last[2], tokens, mentions, self._knowledge)
        if rows.names != self._features:
            raise BadFileError(
                "the model was learned from other features than this version computes: train it anew"
            )
        return self._scorer.mention_odds(rows.values, [m.kind for m in mentions], rows.blind)


def thinned(trajectory: Trajectory) -> Trajectory:
    """At most MAX_PLACES viewpoints of a walk, evenly spread."""
    if len(trajectory) <= MAX_PLACES:
        return trajectory
    kept = [trajectory.viewpoints[int(k)] for k in np.linspace(0, len(trajectory) - 1, MAX_PLACES).round()]
    # what was turned at the places between is turned at the one before them
    turned = [replace(here, yaw_out_rad=there.yaw_in_rad) for here, there in pairwise(kept)]
    return Trajectory(viewpoints=(*turned, kept[-1]))
