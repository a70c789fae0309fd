"""All about one generated home: its places, what is seen there, walks, and what was said of them."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import md5

import numpy as np

from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.generated.choosing import all_facts
from robustnav_nodes.instruction.generated.dwelling import Dwelling, Vector3
from robustnav_nodes.instruction.generated.facts import Surroundings
from robustnav_nodes.instruction.generated.fixtures import with_fixtures
from robustnav_nodes.instruction.generated.places import Places, places_of
from robustnav_nodes.instruction.generated.room_words import WORDS, room_evidence
from robustnav_nodes.instruction.generated.seeing import MADE_UP_A_PLACE, Sighting, look_around
from robustnav_nodes.instruction.generated.sight import Sight
from robustnav_nodes.instruction.generated.telling import Told, tell
from robustnav_nodes.instruction.generated.walks import Walk, draw_walks
from robustnav_nodes.instruction.generated.writers import WRITERS
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import SeenObject, Trajectory, Viewpoint, wrapped

WALKS_A_HOME_NUMBER = 1000  # path numbers of one home follow one another within so many
_AT_DOOR_M = 0.45
_ROOM_BEHIND = 0.4  # how much of the evidence at a door is of the other room


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """One place of a home: its name in the pack, evidence in the order of ROOM_TYPES, what is reported."""

    name: str
    xy_m: tuple[float, float]
    kind: str
    evidence: tuple[float, ...]
    in_sight: tuple[int, ...]
    sightings: tuple[Sighting, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ToldWalk:
    """A walk with its number in the whole data set, and what writers said of it."""

    number: int
    walk: Walk
    surroundings: Surroundings
    told: tuple[Told, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Survey:
    """`walks` by the name of their split; `seen` by the number of the place, only for places of walks."""

    dwelling: Dwelling
    places: Places
    seen: Mapping[int, Place]
    walks: Mapping[str, tuple[ToldWalk, ...]]


def survey(dwelling: Dwelling, number: int, walks: Mapping[str, int], writers: int, seed: int) -> Survey:
    """Furnish a home further, draw its walks (so many of each split) and let so many writers tell each.

    `number` is the home's in the data set. The same arguments give the same survey.
    """
    rng = np.random.default_rng([seed, number])
    furnished = with_fixtures(dwelling, rng)
    places = places_of(furnished, rng)
    drawn: dict[str, list[Walk]] = {}
    taken: set[tuple[int, int]] = set()
    for split, count in walks.items():
        drawn[split] = list(draw_walks(furnished, places, count, rng, frozenset(taken)))
        taken.update((walk.places[0], walk.places[-1]) for walk in drawn[split])
    used = sorted({place for split in drawn.values() for walk in split for place in walk.places})
    seen = _look(furnished, places, used, rng)
    told: dict[str, tuple[ToldWalk, ...]] = {}
    at = number * WALKS_A_HOME_NUMBER
    for split, split_walks in drawn.items():
        numbered = []
        for walk in split_walks:
            numbered.append(_told(furnished, walk, seen, at, writers, np.random.default_rng([seed, at, 1])))
            at += 1
        told[split] = tuple(numbered)
    return Survey(dwelling=furnished, places=places, seen=seen, walks=told)


def instructions_of(surveyed: Survey, split: str) -> list[Instruction]:
    """The instructions of one split with what was seen on the way, as `R2rPack` would read them."""
    found = []
    for told_walk in surveyed.walks[split]:
        trajectory = trajectory_of(surveyed, told_walk.walk)
        for k, told in enumerate(told_walk.told):
            found.append(
                Instruction(
                    key=f"{told_walk.number}_{k}",
                    group=surveyed.dwelling.name,
                    tokens=tokenized(told.text),
                    trajectory=trajectory,
                )
            )
    return found


def trajectory_of(surveyed: Survey, walk: Walk) -> Trajectory:
    """What a robot goes through on a walk."""
    camera = surveyed.dwelling.camera_m
    viewpoints = []
    for at, number in enumerate(walk.places):
        place = surveyed.seen[number]
        x, y = place.xy_m
        total = sum(place.evidence)
        viewpoints.append(
            Viewpoint(
                x_m=x,
                y_m=y,
                z_m=camera,
                yaw_in_rad=walk.yaw_in_rad[at],
                yaw_out_rad=walk.yaw_out_rad[at],
                rooms=tuple(p / total for p in place.evidence),
                objects=tuple(
                    SeenObject(
                        name=sighting.name,
                        bearing_rad=wrapped(sighting.yaw_rad - walk.yaw_in_rad[at]),
                        elevation_rad=sighting.elevation_rad,
                        size_sr=sighting.size_sr,
                        range_m=float(np.linalg.norm(np.subtract(sighting.position_m, (x, y, camera)))),
                    )
                    for sighting in place.sightings
                ),
                place=f"{surveyed.dwelling.name}/{place.name}",
            )
        )
    return Trajectory(viewpoints=tuple(viewpoints))


def _look(
    dwelling: Dwelling, places: Places, used: Iterable[int], rng: np.random.Generator
) -> dict[int, Place]:
    sight = Sight(dwelling)
    made_up = len(dwelling.things)
    most_made_up = max(8, int(20 * MADE_UP_A_PLACE))
    found = {}
    for number in used:
        x, y = places.xy_m[number].tolist()
        camera: Vector3 = (x, y, dwelling.camera_m)
        in_sight = sight.in_sight(camera)
        kinds = _kinds_at(dwelling, x, y)
        found[number] = Place(
            name=md5(f"{dwelling.name}/{number}".encode(), usedforsecurity=False).hexdigest(),
            xy_m=(x, y),
            kind=max(kinds, key=kinds.__getitem__),
            evidence=room_evidence(kinds, rng),
            in_sight=in_sight,
            sightings=look_around(dwelling, camera, in_sight, made_up, rng),
        )
        made_up += most_made_up
    return found


def _kinds_at(dwelling: Dwelling, x_m: float, y_m: float) -> dict[str, float]:
    """Which kinds of rooms a place shows: near a door, the room behind it as well."""
    here = dwelling.room_at(x_m, y_m)
    door = min(dwelling.doors, key=lambda door: door.away_m(x_m, y_m), default=None)
    if door is None or door.away_m(x_m, y_m) > _AT_DOOR_M or door.joins is None:
        return {here.kind if here is not None else dwelling.rooms[0].kind: 1.0}
    first, second = (dwelling.room(name) for name in door.joins)
    own, other = (first, second) if here is None or here.name == first.name else (second, first)
    kinds = {own.kind: 1.0 - _ROOM_BEHIND}
    kinds[other.kind] = kinds.get(other.kind, 0.0) + _ROOM_BEHIND
    return kinds


def _told(
    dwelling: Dwelling,
    walk: Walk,
    seen: Mapping[int, Place],
    number: int,
    writers: int,
    rng: np.random.Generator,
) -> ToldWalk:
    around = Surroundings(
        dwelling=dwelling, walk=walk, in_sight=tuple(seen[place].in_sight for place in walk.places)
    )
    facts = all_facts(around)
    chosen = rng.permutation(len(WRITERS)).tolist()
    who: Sequence[int] = [chosen[k % len(chosen)] for k in range(writers)]
    return ToldWalk(
        number=number,
        walk=walk,
        surroundings=around,
        told=tuple(tell(facts, around, WRITERS[k], rng) for k in who),
    )


def room_type_of(kind: str) -> str | None:
    """The one type of ROOM_TYPES that a kind of room is; None where it is none of them."""
    types = WORDS[kind].types
    best = max(types, key=types.__getitem__)
    return best if types[best] > 0.5 else None
