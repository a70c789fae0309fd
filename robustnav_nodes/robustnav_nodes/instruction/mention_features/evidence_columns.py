"""Where on the way a mention belongs, and how well it fits what was seen there."""

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import (
    CONCEPT_NUMBER,
    CONCEPTS,
    DIRECTION,
    FIRST_OBJECT,
    FIRST_ROOM,
    OPPOSITES,
    ROOM_TYPES_OF,
)
from robustnav_nodes.instruction.mention_features.columns import Columns, Knowledge, Told, Walked
from robustnav_nodes.instruction.mention_features.replacements import replacement_odds
from robustnav_nodes.instruction.scene import FAR_M
from robustnav_nodes.instruction.side_model import SIDES
from robustnav_nodes.instruction.trajectory import ROOM_TYPES

_LEAST = 1e-9


def add_place(columns: Columns, walk: Walked) -> None:
    """How far along the way, and how surely."""
    along = np.arange(len(walk.scene)) / max(1, walk.last)
    at = walk.elsewhere @ along
    columns.add("places", np.full(len(walk.expected_at), float(len(walk.scene))))
    columns.add("at", at)
    columns.add("at_with_own", walk.placed @ along)
    columns.add("at_width", np.sqrt(np.maximum(walk.elsewhere @ along**2 - at**2, 0.0)))
    columns.add("ahead_of_text", at - walk.expected_at)


def add_evidence(columns: Columns, said: Told, walk: Walked, known: Knowledge) -> Float64:
    """Evidence for each mention here, before and after; answers the log odds of a replacement."""
    here = _add_own_evidence(columns, walk)
    ratio = np.exp(walk.at_places)
    around = (ratio + ratio[walk.before] + ratio[walk.after]) / 3.0
    views = {
        "here": np.log(walk.elsewhere @ ratio + _LEAST),
        "around": np.log(walk.elsewhere @ around + _LEAST),
        "best": np.repeat(walk.at_places.max(axis=0)[None, :], len(said), axis=0),
    }
    answer = np.full(len(said), np.nan)
    for name, view in views.items():
        odds = replacement_odds(said.fits, said.numbers, known.replacements, view)
        bare = replacement_odds(np.zeros_like(said.fits), said.numbers, known.replacements, view)[0]
        odds[:, said.sided], bare[said.sided] = np.nan, np.nan
        columns.add(f"odds_{name}_uniform", odds[0])
        columns.add(f"odds_{name}_matched", odds[1])
        columns.add(f"odds_{name}_best", odds[2])
        columns.add(f"odds_{name}_bare", bare)
        if name == "here":
            answer = odds[0].copy()
    flipped = _opposites(said, walk, known, here)
    sides = np.flatnonzero(~np.isnan(flipped)).tolist()
    opposite = [CONCEPT_NUMBER[DIRECTION, OPPOSITES[said.mentions[m].concept]] for m in sides]
    answer[sides] = said.fits[sides, opposite] - said.fits[sides, said.numbers[sides]] + flipped[sides]
    columns.add("opposite", flipped)
    columns.add("opposite_odds", np.where(np.isnan(flipped), np.nan, answer))
    return answer


def _add_own_evidence(columns: Columns, walk: Walked) -> Float64:
    own, elsewhere, last = walk.own, walk.elsewhere, walk.last
    ratio = np.exp(own)
    here: Float64 = np.log(np.maximum((elsewhere * ratio).sum(axis=1), _LEAST))
    columns.add("here", here)
    columns.add("next", np.log(np.maximum((elsewhere * ratio[:, walk.after]).sum(axis=1), _LEAST)))
    columns.add("previous", np.log(np.maximum((elsewhere * ratio[:, walk.before]).sum(axis=1), _LEAST)))
    columns.add("best", own.max(axis=1))
    columns.add("start", own[:, 0])
    columns.add("end", own[:, -1])
    columns.add("mean", own.mean(axis=1))
    along = np.arange(last + 1) / max(1, last)
    columns.add("best_off", own.argmax(axis=1) / max(1, last) - elsewhere @ along)
    columns.add("likely_best", (own + np.log(elsewhere + 1e-6)).max(axis=1))
    rows, nearest = np.arange(len(own)), walk.by_text
    columns.add("by_text", own[rows, nearest])
    columns.add("by_text_next", own[rows, np.minimum(nearest + 1, last)])
    columns.add("by_text_previous", own[rows, np.maximum(nearest - 1, 0)])
    return here


def _opposites(said: Told, walk: Walked, known: Knowledge, here: Float64) -> Float64:
    """How much better the opposite of left, right, up or down fits; NaN for all other mentions."""
    flipped = np.full(len(said), np.nan)
    sides = np.array([m.concept in SIDES or m.concept in ("up", "down") for m in said.mentions], dtype=bool)
    if sides.any():
        other = known.places.of_mentions(
            walk.scene, said.tokens, said.mentions, walk.at_places, opposite=True
        )[sides]
        weighed = (walk.elsewhere[sides] * np.exp(other)).sum(axis=1)
        flipped[sides] = np.log(np.maximum(weighed, _LEAST)) - here[sides]
    return flipped


def add_rooms_and_objects(columns: Columns, said: Told, walk: Walked) -> None:
    """How near the nearest such object is and how likely such a room, here, around, at both ends."""
    scene, elsewhere = walk.scene, walk.elsewhere
    ranges = np.full((len(said), len(scene)), np.nan)
    chance = np.full((len(said), len(scene)), np.nan)
    for m, number in enumerate(said.numbers):
        if FIRST_OBJECT <= number < FIRST_ROOM:
            ranges[m] = scene.range_m[:, number - FIRST_OBJECT]
        elif number >= FIRST_ROOM:
            types = ROOM_TYPES_OF.get(CONCEPTS[number][1], ())
            if types:
                chance[m] = scene.rooms[:, [ROOM_TYPES.index(t) for t in types]].sum(axis=1)
    around = np.minimum(np.minimum(ranges, ranges[:, walk.before]), ranges[:, walk.after])
    columns.add("range_here", (elsewhere * ranges).sum(axis=1))
    columns.add("range_around", (elsewhere * around).sum(axis=1))
    columns.add("range_best", ranges.min(axis=1))
    columns.add("range_start", ranges[:, 0])
    columns.add("range_end", ranges[:, -1])
    columns.add("seen_from", (ranges < FAR_M).mean(axis=1))
    columns.add("room_here", (elsewhere * chance).sum(axis=1))
    columns.add("room_next", (elsewhere * chance[:, walk.after]).sum(axis=1))
    columns.add("room_previous", (elsewhere * chance[:, walk.before]).sum(axis=1))
    columns.add("room_best", chance.max(axis=1))
    columns.add("room_start", chance[:, 0])
    columns.add("room_end", chance[:, -1])
    rooms = elsewhere @ scene.rooms
    for k, name in enumerate(ROOM_TYPES):
        columns.add(f"type_{name}", rooms[:, k])
    doubt = -(scene.rooms * np.log(scene.rooms + _LEAST)).sum(axis=1)
    columns.add("room_doubt", elsewhere @ doubt)
    columns.add("things_here", elsewhere @ (scene.range_m < FAR_M).sum(axis=1))
