"""One row of numbers per mention: how it is worded, and what was seen and turned while it was being walked.

Where on the way a mention belongs is told by the other mentions (`alignment`, leave-one-out): a wrong word
cannot pull the place where it is looked up towards itself. Sides are counted from the word that was said: a
turn to the right is positive where "right" was said, so that left and right are one question.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.alignment import place_mentions
from robustnav_nodes.instruction.common_sense import CommonSense
from robustnav_nodes.instruction.concepts import (
    CONCEPT_NUMBER,
    CONCEPTS,
    DIRECTION,
    FIRST_OBJECT,
    FIRST_ROOM,
    OBJECT,
    OPPOSITES,
    ROOM_TYPES_OF,
    is_plural,
)
from robustnav_nodes.instruction.direction_phrases import PHRASES, TURN, phrase_of
from robustnav_nodes.instruction.mentions import Mention
from robustnav_nodes.instruction.place_model import DOWN, LEFT, RIGHT, UP, PlaceModel, said_at
from robustnav_nodes.instruction.scene import FAR_M, Scene
from robustnav_nodes.instruction.trajectory import ROOM_TYPES
from robustnav_nodes.instruction.wording import Wording

_BEFORE = (
    *(
        "the",
        "a",
        "your",
        "to",
        "into",
        "in",
        "of",
        "out",
        "exit",
        "leave",
        "enter",
        "turn",
        "on",
        "at",
        "past",
    ),
    *(
        "through",
        "by",
        "next",
        "and",
        "from",
        "down",
        "up",
        "left",
        "right",
        "toward",
        "towards",
        "near",
        "front",
    ),
    *(
        "go",
        "walk",
        "take",
        "make",
        "slight",
        "slightly",
        "sharp",
        "stop",
        "wait",
        "between",
        "around",
        ".",
        ",",
    ),
    *(
        "first",
        "second",
        "straight",
        "until",
        "reach",
        "with",
        "pass",
        "just",
        "continue",
        "head",
        "hard",
        "|",
    ),
)
_AFTER = (
    *(
        ".",
        ",",
        "and",
        "of",
        "on",
        "in",
        "to",
        "the",
        "your",
        "with",
        "at",
        "into",
        "side",
        "door",
        "down",
        "up",
    ),
    *(
        "until",
        "past",
        "through",
        "towards",
        "when",
        "then",
        "room",
        "stairs",
        "hallway",
        "one",
        "table",
        "|",
    ),
)
_SIDED = frozenset({"left", "right", "leftmost", "rightmost"})
_OPPOSITE = {
    CONCEPT_NUMBER[DIRECTION, one]: CONCEPT_NUMBER[DIRECTION, other] for one, other in OPPOSITES.items()
}
_SIGN = {"left": 1.0, "leftmost": 1.0, "right": -1.0, "rightmost": -1.0}
_TURNED_RAD = 0.6  # what counts as a turn that people mention
_LINK_AFTER, _LINK_BEFORE = 5, 4  # tokens to the thing that a direction is said of


@dataclass(frozen=True, slots=True, kw_only=True)
class Replacements:
    """[objects and rooms, same]: log of how likely the second is put in for the first (-Inf: never)."""

    log_share: Float64


def replacements_of(common_sense: CommonSense) -> Replacements:
    """Uniform over what common sense allows."""
    count = len(CONCEPTS) - FIRST_OBJECT
    log_share = np.full((count, count), -np.inf)
    for number in range(FIRST_OBJECT, len(CONCEPTS)):
        kind, concept = CONCEPTS[number]
        others = common_sense.of(kind, concept)
        for other in others:
            if (kind, other) in CONCEPT_NUMBER:
                log_share[number - FIRST_OBJECT, CONCEPT_NUMBER[kind, other] - FIRST_OBJECT] = -math.log(
                    len(others)
                )
    return Replacements(log_share=log_share)


@dataclass(frozen=True, slots=True, kw_only=True)
class MentionRows:
    """Float32 [M, features] and the names of the features; those that need no look at the walk come first."""

    values: NDArray[np.float32]
    names: tuple[str, ...]
    blind: int


class _Columns:
    """Collects named columns of one value per mention."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self.values: list[Float64] = []

    def add(self, name: str, value: Float64) -> None:
        self.names.append(name)
        self.values.append(value)


def mention_rows(
    scene: Scene,
    at_places: Float64,
    tokens: Sequence[str],
    mentions: Sequence[Mention],
    *,
    places: PlaceModel,
    wording: Wording,
    replacements: Replacements,
) -> MentionRows:
    """The rows of all mentions of an instruction; `at_places` is `places.evidence(scene)`."""
    columns = _Columns()
    numbers = np.array([CONCEPT_NUMBER[m.kind, m.concept] for m in mentions], dtype=np.int64)
    fits = np.array([wording.log_fits(tokens, m) for m in mentions]).reshape(len(mentions), len(CONCEPTS))
    blind_odds = _wording_columns(columns, tokens, mentions, numbers, fits, replacements)
    blind = len(columns.names)
    at = said_at(tokens, mentions)
    own = places.of_mentions(scene, tokens, mentions, at_places)
    placed, elsewhere = place_mentions(own, at)
    _place_columns(columns, scene, at, placed, elsewhere)
    odds = _evidence_columns(
        columns, scene, at_places, numbers, fits, own, elsewhere, at, replacements, places, tokens, mentions
    )
    _room_object_columns(columns, scene, numbers, elsewhere)
    _direction_columns(columns, scene, at_places, tokens, mentions, numbers, elsewhere, placed, at, odds)
    _neighbour_columns(columns, np.where(np.isnan(odds), blind_odds, odds))
    values = np.column_stack(columns.values) if len(mentions) else np.zeros((0, len(columns.names)))
    return MentionRows(values=values.astype(np.float32), names=tuple(columns.names), blind=blind)


def _wording_columns(
    columns: _Columns,
    tokens: Sequence[str],
    mentions: Sequence[Mention],
    numbers: NDArray[np.int64],
    fits: Float64,
    replacements: Replacements,
) -> Float64:
    count = len(mentions)
    rows = np.arange(count)
    own = fits[rows, numbers] if count else np.zeros(0)
    columns.add("concept", numbers.astype(float))
    columns.add("fit", own)
    columns.add("share", own - np.logaddexp.reduce(fits, axis=1) if count else own)
    odds = _replacement_odds(fits, numbers, replacements, None)
    for name, values in zip(("uniform", "matched", "best", "allowed"), odds, strict=True):
        columns.add(f"blind_{name}", values)
    words = [
        (
            tokens[m.start - 1] if m.start else "|",
            tokens[m.start - 2] if m.start > 1 else "|",
            tokens[m.start + m.length] if m.start + m.length < len(tokens) else "|",
        )
        for m in mentions
    ]
    for k, known, name in ((0, _BEFORE, "before"), (1, _BEFORE, "before2"), (2, _AFTER, "after")):
        columns.add(name, np.array([_word_number(known, word[k]) for word in words], dtype=float))
    for word in ("the", "your", "turn", "to", "into", "exit", "in", "on", "past", "and", "."):
        columns.add(f"before_{word}", np.array([float(w[0] == word) for w in words]))
    for word in (".", ",", "and", "of", "on", "in", "the"):
        columns.add(f"after_{word}", np.array([float(w[2] == word) for w in words]))
    last = max(1, len(tokens) - 1)
    columns.add("said_at", np.array([m.start / last for m in mentions]))
    columns.add("tokens", np.full(count, float(len(tokens))))
    columns.add("mentions", np.full(count, float(count)))
    said = [m.concept for m in mentions]
    columns.add("same", np.array([float(said.count(m.concept)) for m in mentions]))
    columns.add(
        "plural",
        np.array([float(is_plural(" ".join(tokens[m.start : m.start + m.length]))) for m in mentions]),
    )
    columns.add("words", np.array([float(m.length) for m in mentions]))
    stops = [k for k, token in enumerate(tokens) if token == "."]
    columns.add("sentence", np.array([float(sum(s < m.start for s in stops)) for m in mentions]))
    columns.add("sentences_left", np.array([float(sum(s > m.start for s in stops)) for m in mentions]))
    columns.add(
        "to_stop",
        np.array([float(min([s - m.start for s in stops if s > m.start] or [99])) for m in mentions]),
    )
    columns.add(
        "from_stop",
        np.array([float(m.start - max([s for s in stops if s < m.start] or [-1])) for m in mentions]),
    )
    columns.add(
        "phrase",
        np.array([float(phrase_of(tokens, m)) if m.kind == DIRECTION else float(PHRASES) for m in mentions]),
    )
    columns.add(
        "gap_before",
        np.array([float(m.start - mentions[k - 1].start) if k else 99.0 for k, m in enumerate(mentions)]),
    )
    columns.add(
        "gap_after",
        np.array(
            [
                float(mentions[k + 1].start - m.start) if k + 1 < count else 99.0
                for k, m in enumerate(mentions)
            ]
        ),
    )
    columns.add("concept_before", np.array([float(numbers[k - 1]) if k else -1.0 for k in range(count)]))
    columns.add(
        "concept_after", np.array([float(numbers[k + 1]) if k + 1 < count else -1.0 for k in range(count)])
    )
    for name, values in (("fit_before", np.roll(odds[0], 1)), ("fit_after", np.roll(odds[0], -1))):
        columns.add(name, values)
    uniform: Float64 = odds[0]
    columns.add("fit_worst_other", _worst_other(uniform))
    return uniform


def _replacement_odds(
    fits: Float64, numbers: NDArray[np.int64], replacements: Replacements, evidence: Float64 | None
) -> Float64:
    """float64 [4, M]: log odds that each was put in (uniform, matched, of the best one); of how many.

    `fits` [M, concepts]; `evidence` [M, objects and rooms], none for the wording alone. NaN where nothing is
    known to be replaced by the concept.
    """
    count = len(numbers)
    found = np.full((4, count), np.nan)
    if not count:
        return found
    sided = numbers < FIRST_OBJECT
    if sided.any():
        other = np.array([_OPPOSITE[number] for number in numbers[sided]])
        gain = fits[sided, other] - fits[sided, numbers[sided]]
        found[:, sided] = gain, np.minimum(gain, 0.0), gain, np.ones(len(gain))
    thing = ~sided
    if thing.any():
        column = numbers[thing] - FIRST_OBJECT
        gain = fits[thing, FIRST_OBJECT:] - fits[thing, numbers[thing]][:, None]
        weight = replacements.log_share.T[column]
        seen = np.zeros_like(gain)
        if evidence is not None:
            seen = evidence[thing] - evidence[thing, column][:, None]
        could = np.isfinite(weight)
        known = could.any(axis=1)
        rows = np.flatnonzero(thing)[known]
        gain, weight, seen, could = gain[known], weight[known], seen[known], could[known]
        found[0, rows] = np.logaddexp.reduce(gain + weight + seen, axis=1)
        found[1, rows] = np.logaddexp.reduce(np.minimum(gain, 0.0) + weight + seen, axis=1)
        found[2, rows] = np.where(could, gain + seen, -np.inf).max(axis=1)
        found[3, rows] = could.sum(axis=1)
    return found


@cache
def _word_number(known: tuple[str, ...], word: str) -> float:
    return float(known.index(word)) if word in known else float(len(known))


def _place_columns(columns: _Columns, scene: Scene, at: Float64, placed: Float64, elsewhere: Float64) -> None:
    last = max(1, len(scene) - 1)
    along = np.arange(len(scene)) / last
    columns.add("places", np.full(len(at), float(len(scene))))
    columns.add("at", elsewhere @ along)
    columns.add("at_with_own", placed @ along)
    columns.add("at_width", np.sqrt(np.maximum(elsewhere @ along**2 - (elsewhere @ along) ** 2, 0.0)))
    columns.add("ahead_of_text", elsewhere @ along - at)


def _evidence_columns(
    columns: _Columns,
    scene: Scene,
    at_places: Float64,
    numbers: NDArray[np.int64],
    fits: Float64,
    own: Float64,
    elsewhere: Float64,
    at: Float64,
    replacements: Replacements,
    places: PlaceModel,
    tokens: Sequence[str],
    mentions: Sequence[Mention],
) -> Float64:
    """Evidence of each mention here, before and after; answers the log odds of a replacement."""
    count, last = len(numbers), len(scene) - 1
    index = np.arange(len(scene))
    before, after = np.maximum(index - 1, 0), np.minimum(index + 1, last)
    ratio, all_ratio = np.exp(own), np.exp(at_places)
    here = np.log(np.maximum((elsewhere * ratio).sum(axis=1), 1e-9))
    columns.add("here", here)
    columns.add("next", np.log(np.maximum((elsewhere * ratio[:, after]).sum(axis=1), 1e-9)))
    columns.add("previous", np.log(np.maximum((elsewhere * ratio[:, before]).sum(axis=1), 1e-9)))
    columns.add("best", own.max(axis=1) if count else here)
    columns.add("start", own[:, 0])
    columns.add("end", own[:, -1])
    columns.add("mean", own.mean(axis=1) if count else here)
    columns.add(
        "best_off",
        (own.argmax(axis=1) / max(1, last) if count else here) - elsewhere @ (index / max(1, last)),
    )
    columns.add("likely_best", (own + np.log(elsewhere + 1e-6)).max(axis=1) if count else here)
    nearest = np.rint(at * last).astype(np.int64)
    rows = np.arange(count)
    columns.add("by_text", own[rows, nearest])
    columns.add("by_text_next", own[rows, np.minimum(nearest + 1, last)])
    columns.add("by_text_previous", own[rows, np.maximum(nearest - 1, 0)])
    views = {
        "here": np.log(elsewhere @ all_ratio + 1e-9),
        "around": np.log(elsewhere @ (all_ratio + all_ratio[before] + all_ratio[after]) / 3.0 + 1e-9),
        "best": np.repeat(at_places.max(axis=0)[None, :], count, axis=0),
    }
    answer = np.full(count, np.nan)
    for name, view in views.items():
        odds = _replacement_odds(fits, numbers, replacements, view)
        bare = _replacement_odds(np.zeros_like(fits), numbers, replacements, view)[0]
        odds[:, numbers < FIRST_OBJECT] = np.nan
        bare[numbers < FIRST_OBJECT] = np.nan
        for k, which in enumerate(("uniform", "matched", "best")):
            columns.add(f"odds_{name}_{which}", odds[k])
        columns.add(f"odds_{name}_bare", bare)
        if name == "here":
            answer = odds[0]
    flipped = np.full(count, np.nan)
    for m, mention in enumerate(mentions):
        number = numbers[m]
        if number in (LEFT, RIGHT, UP, DOWN):
            other = Mention(
                start=mention.start, length=mention.length, kind=DIRECTION, concept=OPPOSITES[mention.concept]
            )
            opposite = places.of_mentions(scene, tokens, [other], at_places)[0]
            flipped[m] = math.log(float(elsewhere[m] @ np.exp(opposite)) + 1e-9) - here[m]
            answer[m] = fits[m, CONCEPT_NUMBER[DIRECTION, other.concept]] - fits[m, number] + flipped[m]
    columns.add("opposite", flipped)
    columns.add("opposite_odds", np.where(np.isnan(flipped), np.nan, answer))
    return answer


def _room_object_columns(
    columns: _Columns, scene: Scene, numbers: NDArray[np.int64], elsewhere: Float64
) -> None:
    count, last = len(numbers), len(scene) - 1
    index = np.arange(len(scene))
    before, after = np.maximum(index - 1, 0), np.minimum(index + 1, last)
    ranges = np.full((count, len(scene)), np.nan)
    chance = np.full((count, len(scene)), np.nan)
    for m, number in enumerate(numbers):
        if FIRST_OBJECT <= number < FIRST_ROOM:
            ranges[m] = scene.range_m[:, number - FIRST_OBJECT]
        elif number >= FIRST_ROOM:
            types = ROOM_TYPES_OF.get(CONCEPTS[number][1], ())
            if types:
                chance[m] = scene.rooms[:, [ROOM_TYPES.index(t) for t in types]].sum(axis=1)
    columns.add("range_here", (elsewhere * ranges).sum(axis=1))
    columns.add(
        "range_around",
        (elsewhere * np.minimum(np.minimum(ranges, ranges[:, before]), ranges[:, after])).sum(axis=1),
    )
    columns.add("range_best", ranges.min(axis=1) if count else np.zeros(0))
    columns.add("range_start", ranges[:, 0])
    columns.add("range_end", ranges[:, -1])
    columns.add("seen_from", (ranges < FAR_M).mean(axis=1) if count else np.zeros(0))
    columns.add("room_here", (elsewhere * chance).sum(axis=1))
    columns.add("room_next", (elsewhere * chance[:, after]).sum(axis=1))
    columns.add("room_previous", (elsewhere * chance[:, before]).sum(axis=1))
    columns.add("room_best", chance.max(axis=1) if count else np.zeros(0))
    columns.add("room_start", chance[:, 0])
    columns.add("room_end", chance[:, -1])
    rooms = elsewhere @ scene.rooms
    for k, name in enumerate(ROOM_TYPES):
        columns.add(f"type_{name}", rooms[:, k])
    doubt = -(scene.rooms * np.log(scene.rooms + 1e-9)).sum(axis=1)
    columns.add("room_doubt", elsewhere @ doubt)
    columns.add("things_here", elsewhere @ (scene.range_m < FAR_M).sum(axis=1))


def _direction_columns(
    columns: _Columns,
    scene: Scene,
    at_places: Float64,
    tokens: Sequence[str],
    mentions: Sequence[Mention],
    numbers: NDArray[np.int64],
    elsewhere: Float64,
    placed: Float64,
    at: Float64,
    odds: Float64,
) -> None:
    count, last = len(mentions), len(scene) - 1
    index = np.arange(len(scene))
    before, after = np.maximum(index - 1, 0), np.minimum(index + 1, last)
    nearest = np.rint(at * last).astype(np.int64)
    sign = np.array([_SIGN.get(m.concept, math.nan) for m in mentions])
    turn = scene.turn_rad
    sided = np.tanh(turn / 0.8)
    big = (np.abs(turn) > _TURNED_RAD) * np.sign(turn)
    walked = np.cumsum(turn)
    for name, values in (
        ("turn_here", elsewhere @ sided),
        ("turn_next", elsewhere @ sided[after]),
        ("turn_previous", elsewhere @ sided[before]),
        ("turn_by_text", sided[nearest]),
        ("turn_by_text_next", sided[np.minimum(nearest + 1, last)]),
        ("turn_by_text_previous", sided[np.maximum(nearest - 1, 0)]),
        ("big_here", elsewhere @ big),
        ("turn_first", np.repeat(turn[0], count)),
        ("turn_second", np.repeat(turn[min(1, last)], count)),
        ("turn_before_last", np.repeat(turn[max(0, last - 1)], count)),
        ("turn_sum", np.repeat(walked[-1], count)),
        ("turn_sum_inside", np.repeat(walked[-1] - turn[0], count)),
    ):
        columns.add(name, sign * values)
    columns.add("most_to_side", np.where(sign > 0, turn.max(), -turn.min()) + 0.0 * sign)
    columns.add("most_to_other", np.where(sign > 0, -turn.min(), turn.max()) + 0.0 * sign)
    columns.add(
        "right_side_here", (elsewhere * (np.outer(sign, turn) > _TURNED_RAD)).sum(axis=1) + 0.0 * sign
    )
    columns.add(
        "wrong_side_here", (elsewhere * (np.outer(sign, turn) < -_TURNED_RAD)).sum(axis=1) + 0.0 * sign
    )
    _ordinal_turns(columns, tokens, mentions, sign, turn)
    # where the way goes on, seen from each viewpoint on arriving
    for steps in (1, 2, 99):
        there = scene.xyz_m[np.minimum(index + steps, last), :2] - scene.xyz_m[:, :2]
        aside = np.cos(scene.yaw_in_rad) * there[:, 1] - np.sin(scene.yaw_in_rad) * there[:, 0]
        ahead = np.cos(scene.yaw_in_rad) * there[:, 0] + np.sin(scene.yaw_in_rad) * there[:, 1]
        columns.add(f"aside_{steps}", sign * (elsewhere @ aside))
        columns.add(f"ahead_{steps}", elsewhere @ ahead)
        columns.add(f"aside_{steps}_by_text", sign * aside[nearest])
    _linked_things(columns, scene, at_places, tokens, mentions, elsewhere, sign)
    others = np.full((4, count), np.nan)
    sides = [m for m in range(count) if mentions[m].concept in _SIDED]
    for k, m in enumerate(sides):
        if k:
            others[0, m] = sign[m] * sign[sides[k - 1]]
            others[1, m] = odds[sides[k - 1]]
        if k + 1 < len(sides):
            others[2, m] = sign[m] * sign[sides[k + 1]]
            others[3, m] = odds[sides[k + 1]]
    for name, values in zip(
        ("side_before", "side_before_odds", "side_after", "side_after_odds"), others, strict=True
    ):
        columns.add(name, values)
    height = scene.xyz_m[:, 2]
    up = np.array([{"up": 1.0, "down": -1.0}.get(m.concept, math.nan) for m in mentions])
    climb = height[after] - height[before]
    stairs = scene.range_m[:, 0]
    for name, values in (
        ("climb_here", elsewhere @ climb),
        ("climb_by_text", climb[nearest]),
        ("climb_all", np.repeat(height[-1] - height[0], count)),
        ("climb_most", np.repeat(climb[np.abs(climb).argmax()], count)),
    ):
        columns.add(name, up * values)
    columns.add("stairs_here", elsewhere @ stairs)
    change = np.abs(scene.rooms[after] - scene.rooms[before]).sum(axis=1)
    columns.add("room_change", elsewhere @ change)
    columns.add(
        "porch_change", elsewhere @ (scene.rooms[after] - scene.rooms[before])[:, ROOM_TYPES.index("porch")]
    )
    columns.add("porch_start", np.repeat(scene.rooms[0, ROOM_TYPES.index("porch")], count))
    columns.add("porch_end", np.repeat(scene.rooms[-1, ROOM_TYPES.index("porch")], count))
    columns.add("sharp", elsewhere @ np.abs(turn))


def _ordinal_turns(
    columns: _Columns, tokens: Sequence[str], mentions: Sequence[Mention], sign: Float64, turn: Float64
) -> None:
    """The k-th turn that is said beside the k-th that was made, from both ends."""
    count = len(mentions)
    said = [
        m for m in range(count) if mentions[m].concept in _SIDED and phrase_of(tokens, mentions[m]) == TURN
    ]
    made = [t for t in range(len(turn)) if abs(turn[t]) > _TURNED_RAD]
    found = np.full((4, count), np.nan)
    for k, m in enumerate(said):
        if k < len(made):
            found[0, m] = sign[m] * turn[made[k]]
        if len(said) - k <= len(made):
            found[1, m] = sign[m] * turn[made[len(made) - len(said) + k]]
        found[2, m] = k
        found[3, m] = len(said) - k
    columns.add("kth_turn", found[0])
    columns.add("kth_turn_from_end", found[1])
    columns.add("turns_said_before", found[2])
    columns.add("turns_said_after", found[3])
    columns.add("turns_made", np.full(count, float(len(made))))


def _linked_things(
    columns: _Columns,
    scene: Scene,
    at_places: Float64,
    tokens: Sequence[str],
    mentions: Sequence[Mention],
    elsewhere: Float64,
    sign: Float64,
) -> None:
    """The thing or room that a direction is said of: "the couch ON YOUR LEFT", "INTO the kitchen"."""
    count, last = len(mentions), len(scene) - 1
    index = np.arange(len(scene))
    before, after = np.maximum(index - 1, 0), np.minimum(index + 1, last)
    for name in ("after", "before"):
        found = np.full((12, count), np.nan)
        for m, mention in enumerate(mentions):
            if mention.kind != DIRECTION:
                continue
            thing = _linked(mentions, m, name)
            if thing is None:
                continue
            column = CONCEPT_NUMBER[thing.kind, thing.concept] - FIRST_OBJECT
            found[0, m] = column
            own, weight = at_places[:, column], elsewhere[m]
            found[1, m], found[2, m], found[3, m] = weight @ own[before], weight @ own, weight @ own[after]
            found[4, m], found[5, m] = own[0], own[-1]
            found[6, m] = weight @ (own[after] - own[before])
            if thing.kind != OBJECT:
                continue
            ranges, bearing = scene.range_m[:, column], scene.bearing_rad[:, column]
            share = np.where(np.isnan(bearing), 0.0, weight / (0.5 + ranges))
            if share.sum() <= 0.0:
                continue
            share = share / share.sum()
            bearing = np.nan_to_num(bearing)
            found[7, m] = sign[m] * (share @ np.sin(bearing))
            found[8, m] = sign[m] * (share @ np.sin(bearing - scene.turn_rad))
            top = int(share.argmax())
            found[9, m] = sign[m] * math.sin(bearing[top])
            found[10, m] = sign[m] * math.sin(bearing[top] - scene.turn_rad[top])
            found[11, m] = ranges[top]
        for k, what in enumerate(
            (
                *("concept", "previous", "here", "next", "start", "end", "rise"),
                *("side", "side_leaving", "side_top", "side_top_leaving", "range"),
            )
        ):
            columns.add(f"{name}_{what}", found[k])


def _linked(mentions: Sequence[Mention], m: int, where: str) -> Mention | None:
    step = 1 if where == "after" else -1
    if not 0 <= m + step < len(mentions):
        return None
    other = mentions[m + step]
    gap = (
        other.start - mentions[m].start - mentions[m].length
        if step > 0
        else mentions[m].start - other.start - other.length
    )
    near = gap <= (_LINK_AFTER if step > 0 else _LINK_BEFORE)
    return other if near and other.kind != DIRECTION else None


def _neighbour_columns(columns: _Columns, odds: Float64) -> None:
    """How doubtful the other mentions are."""
    columns.add("odds_before", np.where(np.arange(len(odds)) > 0, np.roll(odds, 1), np.nan))
    columns.add("odds_after", np.where(np.arange(len(odds)) < len(odds) - 1, np.roll(odds, -1), np.nan))
    columns.add("odds_worst_other", _worst_other(odds))
    columns.add("odds_own", odds)


def _worst_other(odds: Float64) -> Float64:
    if len(odds) < 2:
        return np.full(len(odds), np.nan)
    order = np.argsort(np.where(np.isnan(odds), -np.inf, odds))
    worst = np.full(len(odds), odds[order[-1]])
    worst[order[-1]] = odds[order[-2]]
    return worst
