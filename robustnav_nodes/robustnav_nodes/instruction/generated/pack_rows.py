"""A survey as lines of the semantic R2R pack (its README lists the fields): headings clockwise from +y."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from robustnav_nodes.instruction.generated.survey import Survey, room_type_of
from robustnav_nodes.instruction.tokens import tokenized

Line = dict[str, Any]
_ENDS = frozenset(".,;:!?")


def viewpoint_lines(surveyed: Survey) -> Iterator[Line]:
    """A line for each place of a walk, with all that is reported there."""
    camera = surveyed.dwelling.camera_m
    for place in surveyed.seen.values():
        yield {
            "scan": surveyed.dwelling.name,
            "vp": place.name,
            "x": round(place.xy_m[0], 3),
            "y": round(place.xy_m[1], 3),
            "z": camera,
            "height": camera,
            "room": room_type_of(place.kind),
            "objects": [
                [
                    seen.name,
                    round(heading_of(seen.yaw_rad), 3),
                    round(seen.elevation_rad, 3),
                    round(seen.size_sr, 5),
                    round(seen.width_m, 3),
                    round(seen.height_m, 3),
                    seen.number,
                ]
                for seen in place.sightings
            ],
        }


def object_lines(surveyed: Survey) -> Iterator[Line]:
    """A line for each thing that is reported from somewhere; what was made up has a place as well."""
    positions = {seen.number: seen for place in surveyed.seen.values() for seen in place.sightings}
    views: dict[int, int] = {}
    for place in surveyed.seen.values():
        for seen in place.sightings:
            views[seen.number] = views.get(seen.number, 0) + 1
    things = surveyed.dwelling.things
    for number, seen in sorted(positions.items()):
        x, y, z = seen.position_m
        made_up = number >= len(things)
        yield {
            "scan": surveyed.dwelling.name,
            "id": number,
            "name": seen.name if made_up else things[number].name,
            "x": round(x, 3),
            "y": round(y, 3),
            "z": round(z, 3),
            "method": "made up" if made_up else "home",
            "views": views[number],
        }


def room_lines(surveyed: Survey) -> Iterator[Line]:
    for place in surveyed.seen.values():
        yield {"scan": surveyed.dwelling.name, "vp": place.name, "probs": list(place.evidence)}


def graph_line(surveyed: Survey) -> Line:
    """The places of walks and the ways between them.

    `visible` is empty: each place lists itself what is in sight of it up to 5 m.
    """
    number = {place: at for at, place in enumerate(surveyed.seen)}
    return {
        "scan": surveyed.dwelling.name,
        "viewpoints": [place.name for place in surveyed.seen.values()],
        "edges": [
            [number[a], number[b], round(length, 3)]
            for a, b, length in surveyed.places.edges
            if a in number and b in number
        ],
        "visible": [],
    }


def walk_lines(surveyed: Survey, split: str) -> Iterator[Line]:
    for told_walk in surveyed.walks.get(split, ()):
        walk = told_walk.walk
        yield {
            "path_id": told_walk.number,
            "scan": surveyed.dwelling.name,
            "heading": round(heading_of(walk.yaw_in_rad[0]), 4),
            "distance": round(walk.length_m, 2),
            "path": [surveyed.seen[place].name for place in walk.places],
            "instructions": [told.text for told in told_walk.told],
            "writers": [told.writer for told in told_walk.told],
            "sub_instructions": [
                [[_words(clause.text), clause.fact.first, clause.fact.last] for clause in told.clauses]
                for told in told_walk.told
            ],
        }


def heading_of(yaw_rad: float) -> float:
    """The pack's heading of a yaw, in 0..2 pi."""
    return float(np.mod(math.pi / 2.0 - yaw_rad, math.tau))


def _words(text: str) -> list[str]:
    return [token for token in tokenized(text) if token not in _ENDS]
