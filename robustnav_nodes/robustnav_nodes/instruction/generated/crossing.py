"""Facts about rooms and doors: which are left and entered, at which side, the how-manieth, how far inside."""

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.generated.dwelling import Thing
from robustnav_nodes.instruction.generated.facts import Fact, Kind, Surroundings, side_of
from robustnav_nodes.instruction.generated.turning import turn_event
from robustnav_nodes.instruction.generated.walks import Crossing

_ASIDE_RAD = (math.radians(40.0), math.radians(140.0))
_TURNING_RAD = math.radians(40.0)
_FRONT_RAD, _APART_RAD = math.radians(100.0), math.radians(15.0)
_NEXT_M = 0.3  # doors this much farther along come after
_AT_WALL_M = 0.4
_THROUGH_M = 1.5


def crossing_facts(around: Surroundings) -> Iterator[Fact]:
    """What can be said of each door that is walked through, and of each room from door to door."""
    walk = around.walk
    for number, crossing in enumerate(walk.crossings):
        came_by = walk.crossings[number - 1].door if number else None
        yield _fact(crossing, Kind.CROSS)
        yield from _aside(around, crossing)
        yield from _turning(around, crossing)
        yield from _counted(around, crossing, came_by)
        yield from _outermost(around, crossing, came_by)
    for entering, leaving in pairwise(walk.crossings):
        first, last = entering.after + 1, leaving.after
        is_inside = first <= last and set(walk.rooms[first : last + 1]) == {entering.entered}
        if is_inside and leaving.at_m - entering.at_m >= _THROUGH_M:
            yield Fact(
                kind=Kind.THROUGH,
                event=f"through {entering.at_m:.2f}",
                first=first,
                last=last,
                at_m=entering.at_m + 0.1,
                rooms=(entering.entered,),
            )


def _fact(crossing: Crossing, kind: Kind, at: int | None = None, **more: Any) -> Fact:
    first = crossing.after if at is None else at
    return Fact(
        kind=kind,
        event=f"cross {crossing.at_m:.2f}",
        first=first,
        last=crossing.after + 1,
        at_m=crossing.at_m,
        things=(crossing.door,),
        rooms=(crossing.left, crossing.entered),
        **more,
    )


def _aside(around: Surroundings, crossing: Crossing) -> Iterator[Fact]:
    """The door lies at a side when its room has been walked so far."""
    walk, at = around.walk, crossing.after
    if at == 0 or walk.rooms[at] != crossing.left or not around.sees(at, crossing.door):
        return
    bearing = walk.bearing_rad(at, crossing.door, walk.yaw_in_rad[at])
    if _ASIDE_RAD[0] <= abs(bearing) <= _ASIDE_RAD[1]:
        yield _fact(crossing, Kind.CROSS_ASIDE, side=side_of(bearing), instead_of=(turn_event(at),))


def _turning(around: Surroundings, crossing: Crossing) -> Iterator[Fact]:
    walk, at = around.walk, crossing.after
    turned = walk.turn_rad(at)
    if at > 0 and abs(turned) >= _TURNING_RAD and walk.rooms[at] == crossing.left:
        yield _fact(crossing, Kind.CROSS_TURNING, side=side_of(turned), instead_of=(turn_event(at),))


def _counted(around: Surroundings, crossing: Crossing, came_by: Thing | None) -> Iterator[Fact]:
    """The n-th door of one side, counted along the way through its room."""
    walk, room = around.walk, crossing.left
    first = crossing.after + 1
    while first > 0 and walk.rooms[first - 1] == room:
        first -= 1
    inside = range(first, crossing.after + 1)
    if not inside:
        return
    yaw = walk.yaw_out_rad[first]
    if any(abs(math.remainder(walk.yaw_out_rad[at] - yaw, math.tau)) > 0.5 for at in inside[:-1]):
        return
    forward = np.array([math.cos(yaw), math.sin(yaw)])
    along, across = _relative(walk.xy_m[first], forward, crossing.door)
    if abs(across) < _AT_WALL_M or along < _NEXT_M or not _is_in_side_wall(crossing.door, forward):
        return
    others = []
    for door in around.dwelling.doors:
        if door in (crossing.door, came_by) or room not in (door.joins or ()):
            continue
        there, beside = _relative(walk.xy_m[first], forward, door)
        is_same_side = beside * across > 0.0 and abs(beside) >= _AT_WALL_M
        if is_same_side and _is_in_side_wall(door, forward) and there > 0.2:
            others.append(there)
    before = sum(there < along - _NEXT_M for there in others)
    if before + sum(there > along + _NEXT_M for there in others) < len(others):
        return  # two doors side by side
    side = side_of(across)
    replaced = tuple(turn_event(at) for at in inside)
    yield _fact(crossing, Kind.CROSS_COUNTED, at=first, side=side, count=before + 1, instead_of=replaced)
    if before and before == len(others):
        yield _fact(crossing, Kind.CROSS_COUNTED, at=first, side=side, count=-1, instead_of=replaced)


def _outermost(around: Surroundings, crossing: Crossing, came_by: Thing | None) -> Iterator[Fact]:
    """Of several doors in front, the one farthest to a side."""
    walk = around.walk
    for at in (crossing.after - 1, crossing.after):
        if at < 0 or walk.rooms[at] != crossing.left or not around.sees(at, crossing.door):
            continue
        bearings = {
            door.number: walk.bearing_rad(at, door, walk.yaw_in_rad[at])
            for door in around.things(at)
            if door.joins is not None and crossing.left in door.joins and door != came_by
        }
        bearings = {number: b for number, b in bearings.items() if abs(b) <= _FRONT_RAD}
        own = bearings.pop(crossing.door.number, None)
        if own is None or not bearings:
            continue
        if own > max(bearings.values()) + _APART_RAD or own < min(bearings.values()) - _APART_RAD:
            side = side_of(own - max(bearings.values()))
            yield _fact(crossing, Kind.CROSS_OUTERMOST, at=at, side=side)
            return


def _relative(origin: Float64, forward: Float64, thing: Thing) -> tuple[float, float]:
    """How far ahead and how far to the left."""
    x, y = np.subtract(thing.centre_m[:2], origin).tolist()
    return x * forward[0] + y * forward[1], forward[0] * y - forward[1] * x


def _is_in_side_wall(door: Thing, forward: Float64) -> bool:
    """Whether the wall of a door runs along the way."""
    runs_along_x = door.high_m[0] - door.low_m[0] > door.high_m[1] - door.low_m[1]
    return bool(abs(forward[0 if runs_along_x else 1]) > 0.8)
