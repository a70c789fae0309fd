"""Facts about turns: at the start, on the way, and what they are near."""

import math
from collections.abc import Iterator
from typing import Any

from robustnav_nodes.instruction.generated.facts import Fact, Kind, Surroundings, side_of
from robustnav_nodes.instruction.trajectory import wrapped

_NONE_RAD, _SLIGHT_RAD = math.radians(20.0), math.radians(45.0)
_SHARP_RAD, _AROUND_RAD = math.radians(112.0), math.radians(140.0)
_CLEAR_RAD = math.radians(60.0)  # even where the next turn undoes it
_ONE_TURN_M = 1.7  # turns the same way so near each other are one
_UNDONE_M = 1.6
_AT_M = 1.1
_AHEAD_RAD, _BESIDE_RAD = math.radians(15.0), (math.radians(50.0), math.radians(130.0))
_FAR_M = 4.0
START = "start"  # the event of what is done first


def start_facts(around: Surroundings) -> Iterator[Fact]:
    """What somebody does first, by how they stand."""
    walk = around.walk
    turned = walk.turn_rad(0)
    yaw_in, yaw_out = walk.yaw_in_rad[0], walk.yaw_out_rad[0]

    def fact(kind: Kind, **more: Any) -> Fact:
        return Fact(kind=kind, event=START, first=0, last=1, at_m=0.0, **more)

    near = [thing for thing in around.things(0) if walk.away_m(0, thing) <= _FAR_M]
    ahead = [t for t in near if abs(walk.bearing_rad(0, t, yaw_in)) <= _AHEAD_RAD and t.joins is None]
    if abs(turned) < _NONE_RAD:
        yield fact(Kind.START_FORWARD)
        for thing in near:
            bearing = walk.bearing_rad(0, thing, yaw_in)
            if _BESIDE_RAD[0] <= abs(bearing) <= _BESIDE_RAD[1] and thing.joins is None:
                yield fact(Kind.START_BESIDE, side=side_of(bearing), things=(thing,))
    elif abs(turned) < _SLIGHT_RAD:
        yield fact(Kind.START_SLIGHTLY, side=side_of(turned))
    elif abs(turned) < _AROUND_RAD:
        yield fact(Kind.START_TURN, side=side_of(turned))
        for thing in ahead:
            yield fact(Kind.START_FACING, side=side_of(turned), things=(thing,))
    else:
        yield fact(Kind.START_AROUND)
        for thing in ahead:
            yield fact(Kind.START_BACKWARD, things=(thing,))
        for thing in near:
            if abs(walk.bearing_rad(0, thing, yaw_out)) <= _AHEAD_RAD and walk.away_m(0, thing) > 1.0:
                yield fact(Kind.START_BACK, things=(thing,))


def turn_facts(around: Surroundings) -> Iterator[Fact]:
    """The turns on the way that somebody would mention."""
    walk = around.walk
    at = 1
    while at < len(walk) - 1:
        first, turned = at, walk.turn_rad(at)
        at += 1
        if abs(turned) < _NONE_RAD:
            continue
        while (
            at < len(walk) - 1
            and walk.so_far_m[at] - walk.so_far_m[at - 1] <= _ONE_TURN_M
            and walk.turn_rad(at) * turned > 0.0
            and abs(walk.turn_rad(at)) >= _NONE_RAD
        ):
            turned += walk.turn_rad(at)
            at += 1
        last = at - 1
        if abs(turned) < _CLEAR_RAD and _is_undone(around, first, last, turned):
            continue
        yield from _one_turn(around, first, last, turned)


def _is_undone(around: Surroundings, first: int, last: int, turned: float) -> bool:
    """Whether a turn the other way is so near that both only lead past something."""
    walk = around.walk
    for own, other in ((first, first - 1), (last, last + 1)):
        if 0 < other < len(walk) - 1 and abs(walk.so_far_m[own] - walk.so_far_m[other]) <= _UNDONE_M:
            back = walk.turn_rad(other)
            if back * turned < 0.0 and abs(back) >= _NONE_RAD:
                return True
    return False


def _one_turn(around: Surroundings, first: int, last: int, turned: float) -> Iterator[Fact]:
    walk = around.walk
    side = side_of(turned)
    kind = (
        Kind.TURN_SLIGHTLY
        if abs(turned) < _SLIGHT_RAD
        else Kind.TURN_SHARPLY
        if abs(turned) > _SHARP_RAD
        else Kind.TURN
    )

    def fact(kind: Kind, **more: Any) -> Fact:
        return Fact(
            kind=kind,
            event=turn_event(first),
            first=first,
            last=last,
            at_m=walk.so_far_m[first],
            side=side,
            **more,
        )

    yield fact(kind)
    if kind is Kind.TURN_SHARPLY:
        yield fact(Kind.TURN)
    if kind is Kind.TURN_SLIGHTLY:
        return
    for thing in around.things(first):
        if thing.joins is None and walk.away_m(first, thing) <= _AT_M:
            yield fact(Kind.TURN_AT, things=(thing,))
    for thing in around.things(last):
        after = walk.bearing_rad(last, thing, walk.yaw_out_rad[last])
        before = walk.bearing_rad(last, thing, walk.yaw_in_rad[first])
        aside = abs(before) > _SLIGHT_RAD and wrapped(before) * turned > 0.0
        if abs(after) <= _AHEAD_RAD and aside and 1.0 < walk.away_m(last, thing) <= _FAR_M:
            yield fact(Kind.TURN_TOWARDS, things=(thing,))


def turn_event(first: int) -> str:
    """The event of a turn that begins at place `first`."""
    return f"turn {first}"
