"""The thing that a side is said of, "the COUCH on your left", and where it stands from each viewpoint."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import OBJECT
from robustnav_nodes.instruction.direction_phrases import SIDE_OF, phrase_of
from robustnav_nodes.instruction.mentions import Mention
from robustnav_nodes.instruction.scene import FAR_M, UNKNOWN_RANGE_M, Scene

_REACH = 5  # tokens between a side and its thing
_MOST_WORDS = 3  # of a detector's name
_ENDS = frozenset(".!?")
_FRONT_RAD, _APART_RAD = math.radians(100.0), math.radians(10.0)
_ON_THE_WAY_M, _SAME_M = 0.25, 0.6


def thing_beside(scene: Scene, tokens: Sequence[str], mentions: Sequence[Mention], m: int) -> str | None:
    """The name, of those in `scene.things`, that stands nearest to mention `m`; None: none within reach.

    Within the sentence and up to the mentions beside `m`; of "left of" something only what is named after it.
    Objects that have a concept go by it, others by the detector's own name, where it is written out.
    """
    named = [(gap, name) for gap, name in _named_around(tokens, mentions, m) if name in scene.things]
    return min(named, key=lambda one: one[0])[1] if named else None


def _named_around(tokens: Sequence[str], mentions: Sequence[Mention], m: int) -> Iterator[tuple[int, str]]:
    """(tokens in between, name) of all that may be a thing beside `m`."""
    start, end = mentions[m].start, mentions[m].start + mentions[m].length
    low, high = max(0, start - _REACH - _MOST_WORDS), min(len(tokens), end + _REACH + _MOST_WORDS)
    if phrase_of(tokens, mentions[m]) == SIDE_OF:
        low = end
    first = max([low, *(at + 1 for at in range(low, start) if tokens[at] in _ENDS)])
    last = min([high, *(at for at in range(end, high) if tokens[at] in _ENDS)])
    for other, gap in _beside(mentions, m):
        if first <= other.start < last and other.kind == OBJECT and gap <= _REACH:
            yield gap, other.concept
    for other, _ in _beside(mentions, m):
        if other.start < start:
            first = max(first, other.start + other.length)
        else:
            last = min(last, other.start)
    for low, high in ((first, start), (end, last)):
        for begin in range(low, high):
            for stop in range(begin + 1, min(begin + _MOST_WORDS, high) + 1):
                gap = max(start - stop, begin - end)
                if gap <= _REACH:
                    yield gap, " ".join(tokens[begin:stop])


def _beside(mentions: Sequence[Mention], m: int) -> Iterator[tuple[Mention, int]]:
    """The mentions before and after `m`, and how many tokens stand in between."""
    own = mentions[m]
    if m > 0:
        yield mentions[m - 1], own.start - mentions[m - 1].start - mentions[m - 1].length
    if m + 1 < len(mentions):
        yield mentions[m + 1], mentions[m + 1].start - own.start - own.length


def nearest_views(scene: Scene, name: str) -> tuple[Float64, Float64]:
    """Range [T] and bearing [T] of the nearest thing of a name; FAR_M and 0 where none is in sight."""
    ranges, bearings = np.full(len(scene), FAR_M), np.zeros(len(scene))
    seen = scene.things[name]
    known = np.where(np.isnan(seen.range_m), UNKNOWN_RANGE_M, seen.range_m)
    for at, distance, bearing in zip(seen.at, known, seen.bearing_rad, strict=True):
        if distance < ranges[at]:
            ranges[at], bearings[at] = distance, bearing
    return ranges, bearings


def outermost(scene: Scene, name: str) -> Float64:
    """float64 [T] in -1..1: of several alike in front, does the way lead to the leftmost (1) or rightmost?

    Those that the next two steps come near to are compared with all others; 0 where there are none.
    """
    found = np.zeros(len(scene))
    seen = scene.things[name]
    yaw = scene.yaw_in_rad[seen.at] + seen.bearing_rad
    places = scene.xyz_m[seen.at, :2] + seen.range_m[:, None] * np.column_stack([np.cos(yaw), np.sin(yaw)])
    for at in range(len(scene)):
        off_by = np.where(np.isnan(seen.range_m), np.inf, np.abs(seen.at - at))
        fresh = [k for k in np.argsort(off_by, kind="stable").tolist() if off_by[k] <= 1]
        offsets = _told_apart(places[fresh]) - scene.xyz_m[at, :2]
        bearings = np.arctan2(offsets[:, 1], offsets[:, 0]) - scene.yaw_in_rad[at]
        bearings = np.remainder(bearings + math.pi, math.tau) - math.pi
        in_front = np.abs(bearings) <= _FRONT_RAD
        if in_front.sum() < 2:
            continue
        offsets, bearings = offsets[in_front], bearings[in_front]
        near = np.exp(-_from_way(offsets, scene.xyz_m[at : at + 3, :2] - scene.xyz_m[at, :2]) / _ON_THE_WAY_M)
        apart = bearings[:, None] - bearings[None, :]
        ranks = ((apart > _APART_RAD) * 1.0 - (apart < -_APART_RAD)).sum(axis=1) / (len(bearings) - 1)
        found[at] = float(near @ ranks) / max(1.0, float(near.sum()))
    return found


def _told_apart(places: Float64) -> Float64:
    """[k, 2] of [n, 2]: what is seen twice, from two viewpoints, counts once."""
    kept: list[Float64] = []
    for place in places:
        if not kept or np.hypot(*(np.array(kept) - place).T).min() > _SAME_M:
            kept.append(place)
    return np.array(kept).reshape(-1, 2)


def _from_way(points: Float64, way: Float64) -> Float64:
    """float64 [n]: how far points [n, 2] are from the polyline `way` [k, 2]."""
    nearest: Float64 = np.hypot(*(points - way[-1]).T)
    for start, end in pairwise(way):
        leg = end - start
        share = np.clip((points - start) @ leg / max(float(leg @ leg), 1e-9), 0.0, 1.0)
        nearest = np.minimum(nearest, np.hypot(*(points - start - share[:, None] * leg).T))
    return nearest
