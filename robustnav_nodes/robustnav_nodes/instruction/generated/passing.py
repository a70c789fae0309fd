"""Facts about things on the way: at which side they are passed, between which, towards which, how far."""

import math
from collections.abc import Iterator

import numpy as np

from robustnav_nodes.instruction.generated.facts import LEFT, Fact, Kind, Surroundings, side_of
from robustnav_nodes.instruction.generated.turning import START, turn_event

_BESIDE_M = 1.6  # farther from the way nothing is passed
_ASIDE_M = 0.4
_FROM_RAD, _TO_RAD = math.radians(8.0), math.radians(120.0)
_AHEAD_RAD = math.radians(14.0)
_NEARER_M = 0.8
_REACHED_M = 1.0
_STRAIGHT_RAD, _STRAIGHT_M = math.radians(22.0), 2.4
_AROUND_RAD, _AROUND_M = math.radians(50.0), 1.1
_INNER_RAD = math.radians(25.0)
_WALKED_AROUND = frozenset(
    {
        *("dining table", "coffee table", "side table", "couch", "armchair", "chair", "bed", "desk"),
        *("ottoman", "stool", "piano", "statue", "column"),
    }
)
_SEEN_RAD = (math.radians(30.0), math.radians(110.0))


def passing_facts(around: Surroundings) -> Iterator[Fact]:
    """What can be said of each step."""
    for at in range(len(around.walk) - 1):
        passed = list(_passed(around, at))
        yield from passed
        yield from _between(passed)
        yield from _towards(around, at)
        yield from _seen(around, at)
    yield from _straight(around)
    yield from _around(around)


def _passed(around: Surroundings, at: int) -> Iterator[Fact]:
    walk = around.walk
    start, end = walk.xy_m[at], walk.xy_m[at + 1]
    length = float(np.linalg.norm(end - start))
    forward = (end - start) / length
    for thing in around.things(at):
        if thing.room not in walk.rooms[at : at + 2]:
            continue
        x, y = np.subtract(thing.centre_m[:2], start).tolist()
        along, across = x * forward[0] + y * forward[1], forward[0] * y - forward[1] * x
        bearing = walk.bearing_rad(at, thing, walk.yaw_out_rad[at])
        nearest = start + min(max(along, 0.0), length) * forward
        if (
            0.2 < along < length - 0.1
            and abs(across) >= _ASIDE_M
            and _FROM_RAD <= abs(bearing) <= _TO_RAD
            and thing.away_m(*nearest.tolist()) <= _BESIDE_M
        ):
            yield Fact(
                kind=Kind.PASS,
                event=f"pass {at}",
                first=at,
                last=at + 1,
                at_m=walk.so_far_m[at] + along,
                side=side_of(across),
                things=(thing,),
            )


def _between(passed: list[Fact]) -> Iterator[Fact]:
    """One thing at each side at the same time."""
    left = [fact for fact in passed if fact.side == LEFT]
    right = [fact for fact in passed if fact.side != LEFT]
    for one in left:
        for other in right:
            if abs(one.at_m - other.at_m) <= 0.6 and one.things[0].stands and other.things[0].stands:
                yield Fact(
                    kind=Kind.PASS_BETWEEN,
                    event=one.event,
                    first=one.first,
                    last=one.last,
                    at_m=one.at_m,
                    things=(one.things[0], other.things[0]),
                )


def _towards(around: Surroundings, at: int) -> Iterator[Fact]:
    walk = around.walk
    for thing in around.things(at):
        before, after = walk.away_m(at, thing), walk.away_m(at + 1, thing)
        is_ahead = abs(walk.bearing_rad(at, thing, walk.yaw_out_rad[at])) <= _AHEAD_RAD
        if not is_ahead or before - after < _NEARER_M:
            continue

        kinds = [Kind.TOWARDS]
        if after <= _REACHED_M and around.sees(at + 1, thing):
            kinds += [Kind.UNTIL, Kind.AHEAD_TO]
        for kind in kinds:
            yield Fact(
                kind=kind,
                event=f"leg {at}",
                first=at,
                last=at + 1,
                at_m=walk.so_far_m[at] + 0.15,
                things=(thing,),
                needs=_turn_before(around, at) if kind is Kind.AHEAD_TO else None,
            )


def _seen(around: Surroundings, at: int) -> Iterator[Fact]:
    """Something near, at a side, before the next step."""
    walk = around.walk
    if at == 0:
        return
    for thing in around.things(at):
        bearing = walk.bearing_rad(at, thing, walk.yaw_in_rad[at])
        if _SEEN_RAD[0] <= abs(bearing) <= _SEEN_RAD[1] and walk.away_m(at, thing) <= 2.5:
            yield Fact(
                kind=Kind.SEE,
                event=f"pass {at}",
                first=at,
                last=at,
                at_m=walk.so_far_m[at] - 0.05,
                side=side_of(bearing),
                things=(thing,),
            )


def _straight(around: Surroundings) -> Iterator[Fact]:
    walk = around.walk
    first = 0
    for at in range(1, len(walk)):
        if at < len(walk) - 1 and abs(walk.turn_rad(at)) < _STRAIGHT_RAD:
            continue
        metres = walk.so_far_m[at] - walk.so_far_m[first]
        if metres >= _STRAIGHT_M:
            yield Fact(
                kind=Kind.STRAIGHT,
                event=f"leg {first}",
                first=first,
                last=at,
                at_m=walk.so_far_m[first] + 0.1,
                metres=metres,
                needs=_turn_before(around, first),
            )
        first = at


def _turn_before(around: Surroundings, at: int) -> str | None:
    """The event without which nobody goes straight on from there."""
    if abs(around.walk.turn_rad(at)) < _STRAIGHT_RAD:
        return None
    return START if at == 0 else turn_event(at)


def _around(around: Surroundings) -> Iterator[Fact]:
    """A wide turn, at one place or at two, with something near on its inner side."""
    walk = around.walk
    for at in range(1, len(walk) - 1):
        for last in range(at, min(at + 2, len(walk) - 1)):
            turns = [walk.turn_rad(k) for k in range(at, last + 1)]
            turned = sum(turns)
            if min(turns) < 0.0 < max(turns) or not _AROUND_RAD <= abs(turned) <= math.pi:
                continue
            for thing in around.things(at - 1):
                bearing = walk.bearing_rad(at, thing, walk.yaw_in_rad[at])
                is_inside = bearing * turned > 0.0 and abs(bearing) > _INNER_RAD
                if is_inside and thing.name in _WALKED_AROUND and walk.away_m(at, thing) <= _AROUND_M:
                    yield Fact(
                        kind=Kind.AROUND,
                        event=turn_event(at),
                        first=at - 1,
                        last=last,
                        at_m=walk.so_far_m[at],
                        side=side_of(turned),
                        things=(thing,),
                    )
