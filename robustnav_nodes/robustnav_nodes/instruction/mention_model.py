"""Our model: every mention is judged by what was seen while it was being walked; the worst ones decide.

Boosted trees score each row of `mention_features`; an instruction is wrong where one of its mentions is
(noisy-or), weighed so that the score can be read as a probability. A blind model is the same without all that
was seen.
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
from robustnav_nodes.instruction.mentions import Mention, find_mentions
from robustnav_nodes.instruction.scene import Scene, scene_of
from robustnav_nodes.instruction.trajectory import Trajectory
from robustnav_nodes.instruction.trees import Trees, mean_log_odds
from robustnav_nodes.instruction.verdict import Verdict

MAX_PLACES = 60  # of a longer walk so many, evenly spread, are looked at


@dataclass(frozen=True, slots=True, kw_only=True)
class Scorer:
    """Trees by kind of mention; `head` maps an episode's summary to log odds; blind ones see wording only."""

    trees: Mapping[str, tuple[Trees, ...]]
    head: Float64
    blind: bool

    def mention_odds(self, rows: NDArray[np.float32], kinds: Sequence[str], blind_columns: int) -> Float64:
        """Log odds that each mention is wrong."""
        odds = np.zeros(len(kinds))
        seen = rows[:, :blind_columns] if self.blind else rows
        for kind in KINDS:
            of_kind = np.array([k == kind for k in kinds], dtype=bool)
            if of_kind.any():
                odds[of_kind] = mean_log_odds(self.trees[kind], seen[of_kind])
        return odds

    def error_odds(self, odds: Float64, kinds: Sequence[str]) -> float:
        """Log odds that the instruction is wrong, from those of its mentions."""
        return float(episode_summary(odds, kinds) @ self.head)


SUMMARY = 8


def episode_summary(odds: Float64, kinds: Sequence[str]) -> Float64:
    """[1, noisy-or log odds, the three highest log odds, the highest of each kind]."""
    found = np.full(SUMMARY, -6.0)
    found[0] = 1.0
    if len(odds):
        right = float(np.minimum(-np.logaddexp(0.0, odds).sum(), -1e-9))  # log P(no mention is wrong)
        found[1] = np.log(-np.expm1(right)) - right
        top = np.sort(odds)[::-1][:3]
        found[2 : 2 + len(top)] = np.maximum(top, -6.0)
        for k, kind in enumerate(KINDS):
            found[5 + k] = max([float(o) for o, own in zip(odds, kinds, strict=True) if own == kind] + [-6.0])
    return found


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
        kinds = [mention.kind for mention in mentions]
        order = np.argsort(-odds, kind="stable")
        return Verdict(
            error_score=float(1.0 / (1.0 + np.exp(-self._scorer.error_odds(odds, kinds)))),
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
