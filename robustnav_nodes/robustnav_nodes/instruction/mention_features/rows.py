"""The rows that the models of wrong mentions learn from and look at."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.mention_features.columns import Columns, Knowledge, told, walked
from robustnav_nodes.instruction.mention_features.direction_columns import add_directions, add_linked_things
from robustnav_nodes.instruction.mention_features.evidence_columns import (
    add_evidence,
    add_place,
    add_rooms_and_objects,
)
from robustnav_nodes.instruction.mention_features.replacements import worst_other
from robustnav_nodes.instruction.mention_features.wording_columns import add_wording
from robustnav_nodes.instruction.mentions import Mention
from robustnav_nodes.instruction.scene import Scene


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class MentionRows:
    """Float32 [M, features] and the names of the features; those that need no look at the walk come first."""

    values: NDArray[np.float32]
    names: tuple[str, ...]
    blind: int


def mention_rows(
    scene: Scene,
    at_places: Float64,
    tokens: Sequence[str],
    mentions: Sequence[Mention],
    known: Knowledge,
) -> MentionRows:
    """The rows of all mentions of an instruction, of which there is at least one.

    `at_places` is `known.places.evidence(scene)`.
    """
    columns = Columns()
    said = told(tokens, mentions, known.wording)
    read = add_wording(columns, said, known.replacements)
    blind = len(columns.names)
    walk = walked(scene, at_places, said, known.places)
    add_place(columns, walk)
    seen = add_evidence(columns, said, walk, known)
    add_rooms_and_objects(columns, said, walk)
    add_directions(columns, said, walk, seen)
    add_linked_things(columns, said, walk)
    _add_doubts(columns, np.where(np.isnan(seen), read, seen))
    return MentionRows(values=columns.rows(len(mentions)), names=tuple(columns.names), blind=blind)


def _add_doubts(columns: Columns, odds: Float64) -> None:
    """How doubtful the mentions beside it, the worst other one and the mention itself are."""
    columns.add("odds_before", np.concatenate([[np.nan], odds[:-1]]))
    columns.add("odds_after", np.concatenate([odds[1:], [np.nan]]))
    columns.add("odds_worst_other", worst_other(odds))
    columns.add("odds_own", odds)
