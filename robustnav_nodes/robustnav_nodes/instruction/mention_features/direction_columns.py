"""What a direction says beside what was turned, climbed and passed.

Sides are counted from the word that was said: a turn to the right is positive where "right" was said, so that
left and right are one question. Columns are NaN where the mention has no side.
"""

import math

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import DIRECTION
from robustnav_nodes.instruction.direction_phrases import OUTERMOST, TURNS, phrase_of
from robustnav_nodes.instruction.mention_features.columns import Columns, Told, Walked
from robustnav_nodes.instruction.scene import FAR_M, OBJECT_INDEX, TO_THE_END, way_ahead_m
from robustnav_nodes.instruction.side_model import SIDES
from robustnav_nodes.instruction.thing_beside import nearest_views, outermost, thing_beside
from robustnav_nodes.instruction.trajectory import ROOM_TYPES

_UP = {"up": 1.0, "down": -1.0}
_TURNED_RAD = 0.6  # what counts as a turn that people mention
_SOFT_RAD = 0.8
_LEAST = 1e-9
_STAIRS = OBJECT_INDEX["stairs"]
_PORCH = ROOM_TYPES.index("porch")


def add_directions(columns: Columns, said: Told, walk: Walked, odds: Float64) -> None:
    """`odds` [M]: log odds of a replacement of every mention, for what stands beside a side."""
    sign = np.array([SIDES.get(m.concept, math.nan) for m in said.mentions])
    _add_turns(columns, walk, sign)
    _add_ordinal_turns(columns, said, walk, sign)
    _add_way_ahead(columns, walk, sign)
    _add_things_beside(columns, said, walk, sign)
    _add_other_sides(columns, sign, odds)
    _add_climbs(columns, said, walk)
    _add_room_changes(columns, walk)


def _add_turns(columns: Columns, walk: Walked, sign: Float64) -> None:
    turn, elsewhere, last = walk.scene.turn_rad, walk.elsewhere, walk.last
    soft = np.tanh(turn / _SOFT_RAD)
    big = (np.abs(turn) > _TURNED_RAD) * np.sign(turn)
    # a corner is often taken in two steps
    with_next = np.tanh((turn + turn[walk.after] * (walk.after != np.arange(last + 1))) / _SOFT_RAD)
    window = np.tanh(np.convolve(turn, np.ones(3))[1:-1] / _SOFT_RAD)
    total = turn.sum()
    nearest = walk.by_text
    for name, values in (
        ("turn_here", elsewhere @ soft),
        ("turn_next", elsewhere @ soft[walk.after]),
        ("turn_previous", elsewhere @ soft[walk.before]),
        ("turn_with_next", elsewhere @ with_next),
        ("turn_around", elsewhere @ window),
        ("turn_by_text", soft[nearest]),
        ("turn_by_text_next", soft[np.minimum(nearest + 1, last)]),
        ("turn_by_text_previous", soft[np.maximum(nearest - 1, 0)]),
        ("turn_by_text_around", window[nearest]),
        ("big_here", elsewhere @ big),
        ("turn_first", turn[0]),
        ("turn_second", turn[min(1, last)]),
        ("turn_before_last", turn[max(0, last - 1)]),
        ("turn_sum", total),
        ("turn_sum_inside", total - turn[0]),
    ):
        columns.add(name, sign * values)
    columns.add("most_to_side", np.where(sign > 0, turn.max(), -turn.min()) + 0.0 * sign)
    columns.add("most_to_other", np.where(sign > 0, -turn.min(), turn.max()) + 0.0 * sign)
    to_side = np.nan_to_num(sign)[:, None] * turn
    columns.add("right_side_here", (elsewhere * (to_side > _TURNED_RAD)).sum(axis=1) + 0.0 * sign)
    columns.add("wrong_side_here", (elsewhere * (to_side < -_TURNED_RAD)).sum(axis=1) + 0.0 * sign)
    columns.add("sharp", elsewhere @ np.abs(turn))


def _add_ordinal_turns(columns: Columns, said: Told, walk: Walked, sign: Float64) -> None:
    """The k-th turn that is said beside the k-th that was made, from both ends."""
    turn = walk.scene.turn_rad
    turns = [
        m
        for m, mention in enumerate(said.mentions)
        if mention.concept in SIDES and phrase_of(said.tokens, mention) in TURNS
    ]
    made = np.flatnonzero(np.abs(turn) > _TURNED_RAD)
    found = np.full((4, len(said)), np.nan)
    for k, m in enumerate(turns):
        from_end = len(turns) - k
        if k < len(made):
            found[0, m] = sign[m] * turn[made[k]]
        if from_end <= len(made):
            found[1, m] = sign[m] * turn[made[-from_end]]
        found[2, m], found[3, m] = k, from_end
    names = ("kth_turn", "kth_turn_from_end", "turns_said_before", "turns_said_after")
    for name, values in zip(names, found, strict=True):
        columns.add(name, values)
    columns.add("turns_made", np.full(len(said), float(len(made))))


def _add_way_ahead(columns: Columns, walk: Walked, sign: Float64) -> None:
    """Where the way goes on, seen from each viewpoint on arriving."""
    for steps in (1, 2, TO_THE_END):
        ahead, aside = way_ahead_m(walk.scene, steps)
        columns.add(f"aside_{steps}", sign * (walk.elsewhere @ aside))
        columns.add(f"ahead_{steps}", walk.elsewhere @ ahead)
        columns.add(f"aside_{steps}_by_text", sign * aside[walk.by_text])


_BESIDE = (
    *("side", "side_leaving", "side_top", "side_end", "range", "way_by_1", "way_by_2", "way_by_top"),
    *("outermost", "outermost_top"),
)


def _add_things_beside(columns: Columns, said: Told, walk: Walked, sign: Float64) -> None:
    """Where the nearest thing named beside a side stands, on which side of it the way goes on, and whether it
    is the outermost of several.
    """
    found = {name: np.full(len(said), np.nan) for name in _BESIDE}
    scene = walk.scene
    way_1, way_2 = (np.arctan2(aside, ahead) for ahead, aside in (way_ahead_m(scene, k) for k in (1, 2)))
    for m in np.flatnonzero(~np.isnan(sign)).tolist():
        thing = thing_beside(scene, said.tokens, said.mentions, m)
        if thing is None:
            continue
        ranges, bearing = nearest_views(scene, thing)
        share = np.where(ranges < FAR_M, walk.elsewhere[m] / (0.5 + ranges), 0.0)
        share /= max(float(share.sum()), _LEAST)
        top = int(share.argmax())
        found["side"][m] = sign[m] * float(share @ np.sin(bearing))
        found["side_leaving"][m] = sign[m] * float(share @ np.sin(bearing - scene.turn_rad))
        found["side_top"][m] = sign[m] * math.sin(bearing[top])
        if ranges[-1] < FAR_M:
            found["side_end"][m] = sign[m] * math.sin(bearing[-1])
        found["range"][m] = ranges[top]
        found["way_by_1"][m] = sign[m] * float(share @ np.sin(way_1 - bearing))
        found["way_by_2"][m] = sign[m] * float(share @ np.sin(way_2 - bearing))
        found["way_by_top"][m] = sign[m] * math.sin(way_1[top] - bearing[top])
        if phrase_of(said.tokens, said.mentions[m]) == OUTERMOST:
            rank = outermost(scene, thing)
            found["outermost"][m] = sign[m] * float(walk.elsewhere[m] @ rank)
            found["outermost_top"][m] = sign[m] * rank[int((walk.elsewhere[m] * np.abs(rank)).argmax())]
    for name, values in found.items():
        columns.add(f"beside_{name}", values)


def _add_other_sides(columns: Columns, sign: Float64, odds: Float64) -> None:
    """Whether the side said before and after is the same one, and how doubtful that is."""
    found = np.full((4, len(sign)), np.nan)
    sides = np.flatnonzero(~np.isnan(sign))
    first, second = sides[:-1], sides[1:]
    found[0, second] = found[2, first] = sign[first] * sign[second]
    found[1, second], found[3, first] = odds[first], odds[second]
    names = ("side_before", "side_before_odds", "side_after", "side_after_odds")
    for name, values in zip(names, found, strict=True):
        columns.add(name, values)


def _add_climbs(columns: Columns, said: Told, walk: Walked) -> None:
    height = walk.scene.xyz_m[:, 2]
    up = np.array([_UP.get(m.concept, math.nan) for m in said.mentions])
    climb = height[walk.after] - height[walk.before]
    columns.add("climb_here", up * (walk.elsewhere @ climb))
    columns.add("climb_by_text", up * climb[walk.by_text])
    columns.add("climb_all", up * (height[-1] - height[0]))
    columns.add("climb_most", up * climb[np.abs(climb).argmax()])
    columns.add("stairs_here", walk.elsewhere @ walk.scene.range_m[:, _STAIRS])


def _add_room_changes(columns: Columns, walk: Walked) -> None:
    rooms = walk.scene.rooms
    change = rooms[walk.after] - rooms[walk.before]
    columns.add("room_change", walk.elsewhere @ np.abs(change).sum(axis=1))
    columns.add("porch_change", walk.elsewhere @ change[:, _PORCH])
    columns.add("porch_start", np.full(len(walk.expected_at), rooms[0, _PORCH]))
    columns.add("porch_end", np.full(len(walk.expected_at), rooms[-1, _PORCH]))


def add_linked_things(columns: Columns, said: Told, walk: Walked) -> None:
    """The thing or room that a direction is said of: "the couch ON YOUR LEFT", "INTO the kitchen"."""
    for name, step, reach in (("after", 1, 5), ("before", -1, 4)):
        found = np.full((len(_LINKED), len(said)), np.nan)
        for m, mention in enumerate(said.mentions):
            if mention.kind == DIRECTION:
                other = _linked(said, m, step, reach)
                if other is not None:
                    found[:, m] = _linked_values(said, walk, m, other)
        for what, values in zip(_LINKED, found, strict=True):
            columns.add(f"{name}_{what}", values)


# Which thing it is; evidence for it around the place, at both ends, and what it rises by; its side on
# arriving and on leaving (mean over viewpoints, and at the likeliest one), and its range there.
_LINKED = (
    *("concept", "previous", "here", "next", "start", "end", "rise"),
    *("side", "side_leaving", "side_top", "side_top_leaving", "range"),
)


def _linked(said: Told, m: int, step: int, reach: int) -> int | None:
    """The mention beside it, where that is no direction and at most `reach` tokens away."""
    if not 0 <= m + step < len(said):
        return None
    first, second = sorted((said.mentions[m], said.mentions[m + step]), key=lambda one: one.start)
    near = second.start - first.start - first.length <= reach
    return m + step if near and said.mentions[m + step].kind != DIRECTION else None


def _linked_values(said: Told, walk: Walked, m: int, other: int) -> list[float]:
    own, weight = walk.own[other], walk.elsewhere[m]
    scene = walk.scene
    rise = own[walk.after] - own[walk.before]
    values = [
        float(said.numbers[other]),
        float(weight @ own[walk.before]),
        float(weight @ own),
        float(weight @ own[walk.after]),
        float(own[0]),
        float(own[-1]),
        float(weight @ rise),
    ]
    column = OBJECT_INDEX.get(said.mentions[other].concept)
    sign = SIDES.get(said.mentions[m].concept, math.nan)
    unknown = [math.nan] * (len(_LINKED) - len(values))
    if column is None:
        return values + unknown
    ranges, bearing = scene.range_m[:, column], scene.bearing_rad[:, column]
    share = np.where(np.isnan(bearing), 0.0, weight / (0.5 + ranges))
    if share.sum() <= 0.0:
        return values + unknown
    share = share / share.sum()
    bearing = np.nan_to_num(bearing)
    leaving = bearing - scene.turn_rad
    top = int(share.argmax())
    return [
        *values,
        sign * float(share @ np.sin(bearing)),
        sign * float(share @ np.sin(leaving)),
        sign * math.sin(bearing[top]),
        sign * math.sin(leaving[top]),
        float(ranges[top]),
    ]
