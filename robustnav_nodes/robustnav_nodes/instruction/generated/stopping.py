"""Facts about the end of a walk: near what, in which room, before or behind which door."""

import math
from collections.abc import Iterator
from typing import Any

from robustnav_nodes.instruction.generated.dwelling import DOOR, Thing
from robustnav_nodes.instruction.generated.facts import LEFT, RIGHT, Fact, Kind, Surroundings, side_of
from robustnav_nodes.instruction.trajectory import wrapped

_NEAR_M, _FACING_M, _BETWEEN_M = 1.2, 1.6, 1.3
_FACING_RAD, _ASIDE_RAD = math.radians(30.0), (math.radians(45.0), math.radians(135.0))
_OPPOSITE_RAD = math.radians(110.0)
_IN_DOOR_M = 0.4
_INSIDE_M, _OUTSIDE_M = 1.8, 1.5
_AHEAD_RAD = math.radians(75.0)
_APART_RAD = math.radians(12.0)


def stop_facts(around: Surroundings) -> Iterator[Fact]:
    """Everything that tells where the walk ends; there is always the room."""
    walk = around.walk
    end, yaw = len(walk) - 1, walk.yaw_out_rad[-1]
    in_door = any(walk.away_m(end, door) <= _IN_DOOR_M for door in around.dwelling.doors)

    def fact(kind: Kind, first: int = end, **more: Any) -> Fact:
        return Fact(kind=kind, event="stop", first=first, last=end, at_m=walk.length_m, **more)

    if in_door:
        door = min(around.dwelling.doors, key=lambda door: walk.away_m(end, door))
        yield fact(Kind.STOP_IN_DOOR, things=(door,))
    else:
        yield fact(Kind.STOP_IN, rooms=(walk.rooms[-1],))
        yield from _at_door(around, fact(Kind.STOP_INSIDE))
    near = [thing for thing in around.things(end) if thing.room == walk.rooms[-1] and thing.name != DOOR]
    for thing in near:
        bearing = walk.bearing_rad(end, thing, yaw)
        if walk.away_m(end, thing) <= _NEAR_M:
            yield fact(Kind.STOP_NEAR, things=(thing,))
            if _ASIDE_RAD[0] <= abs(bearing) <= _ASIDE_RAD[1]:
                yield fact(Kind.STOP_BESIDE, things=(thing,), side=side_of(bearing))
        if walk.away_m(end, thing) <= _FACING_M and abs(bearing) <= _FACING_RAD:
            yield fact(Kind.STOP_FACING, things=(thing,))
    beside = [thing for thing in near if thing.stands and walk.away_m(end, thing) <= _BETWEEN_M]
    for k, one in enumerate(beside):
        for other in beside[k + 1 :]:
            apart = walk.bearing_rad(end, one, yaw) - walk.bearing_rad(end, other, yaw)
            if abs(wrapped(apart)) >= _OPPOSITE_RAD:
                yield fact(Kind.STOP_BETWEEN, things=(one, other))
    for thing, side in _outermost(around, near):
        yield fact(Kind.STOP_OUTERMOST, first=end - 1, things=(thing,), side=side)


def _at_door(around: Surroundings, like: Fact) -> Iterator[Fact]:
    """Just through a door, or just before one that the walk would go through next."""
    walk, end = around.walk, len(around.walk) - 1
    if walk.crossings:
        last = walk.crossings[-1]
        if walk.length_m - last.at_m <= _INSIDE_M and last.entered == walk.rooms[-1]:
            yield _with(like, Kind.STOP_INSIDE, last.door, last.entered)
    passed = {crossing.door.number for crossing in walk.crossings}
    for door in around.dwelling.doors:
        here, there = _sides(door, walk.rooms[-1])
        bearing = walk.bearing_rad(end, door, walk.yaw_out_rad[-1])
        is_next = door.number not in passed and walk.away_m(end, door) <= _OUTSIDE_M
        if here and is_next and abs(bearing) <= _AHEAD_RAD and around.sees(end, door):
            yield _with(like, Kind.STOP_OUTSIDE, door, there)


def _with(like: Fact, kind: Kind, door: Thing, room: str) -> Fact:
    return Fact(
        kind=kind,
        event=like.event,
        first=like.first,
        last=like.last,
        at_m=like.at_m,
        things=(door,),
        rooms=(room,),
    )


def _sides(door: Thing, room: str) -> tuple[bool, str]:
    """Whether a door is one of the room's, and where it leads from there."""
    joins = door.joins or ("", "")
    return room in joins, joins[1] if joins[0] == room else joins[0]


def _outermost(around: Surroundings, near: list[Thing]) -> Iterator[tuple[Thing, str]]:
    """Things near the end that are the farthest to a side of several alike, seen on the last steps."""
    walk = around.walk
    at = len(walk) - 2
    yaw = walk.yaw_out_rad[at]
    for thing in near:
        if walk.away_m(at + 1, thing) > _NEAR_M or not around.sees(at, thing):
            continue
        own = walk.bearing_rad(at, thing, yaw)
        others = [
            walk.bearing_rad(at, other, yaw)
            for other in around.things(at)
            if other.name == thing.name and other != thing and other.room == thing.room
        ]
        if not others or max(abs(own), *(abs(other) for other in others)) > _AHEAD_RAD:
            continue
        if own > max(others) + _APART_RAD:
            yield thing, LEFT
        elif own < min(others) - _APART_RAD:
            yield thing, RIGHT
