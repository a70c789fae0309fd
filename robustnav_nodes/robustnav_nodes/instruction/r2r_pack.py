"""The semantic R2R pack: people's instructions for walks through scanned homes, and what was seen there.

The pack counts headings clockwise from +y; here everything becomes yaw, counter-clockwise from +x. The pack
lists the objects within about 2 m of a viewpoint; those of the viewpoints in line of sight are added up to
SIGHT_M. A pack may hold pictures, too: see `pack_images`.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.common_sense import CommonSense
from robustnav_nodes.instruction.concepts import DIRECTION, KINDS, OPPOSITES
from robustnav_nodes.instruction.episodes import ERROR_TYPES, ErrorEpisode, Instruction, WrongSpan
from robustnav_nodes.instruction.injection import Protocol
from robustnav_nodes.instruction.pack_lines import PackFolder, Row, as_number
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import (
    ROOM_TYPES,
    UNKNOWN_ROOM,
    SeenObject,
    Trajectory,
    Viewpoint,
    wrapped,
)

SIGHT_M = 5.0
_FIELDS_OF_AN_OBJECT = 7


@dataclass(frozen=True, slots=True, kw_only=True)
class PackPath:
    """A walk of the pack with the instructions that people wrote for it."""

    path_id: int
    scan: str
    trajectory: Trajectory
    instructions: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Place:
    scan: str
    x_m: float
    y_m: float
    z_m: float
    rooms: tuple[float, ...]
    near: tuple[tuple[str, float | None, float | None, float | None, int], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Thing:
    name: str
    x_m: float
    y_m: float
    z_m: float


class R2rPack:
    """A pack on disk; reads what all splits share at once, and each split when it is asked for.

    Raises BadFileError where a file is missing, was changed, or holds what it should not.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = PackFolder(folder)
        meta = self._folder.row("meta.json")
        if tuple(meta.texts("rooms")) != ROOM_TYPES:
            raise meta.wrong("rooms", meta.texts("rooms"), f"the room types {', '.join(ROOM_TYPES)}")
        rooms = {
            row.text("vp"): row.numbers("probs", len(ROOM_TYPES))
            for row in self._folder.rows("rooms.jsonl.gz")
        }
        self._places: dict[str, _Place] = {}
        for row in self._folder.rows("viewpoints.jsonl.gz"):
            self._places[row.text("vp")] = _Place(
                scan=row.text("scan"),
                x_m=row.number("x"),
                y_m=row.number("y"),
                z_m=row.number("z"),
                rooms=_normalised(rooms.get(row.text("vp"))),
                near=_near(row),
            )
        self._things = {
            (row.text("scan"), row.whole("id")): _Thing(
                name=row.text("name"), x_m=row.number("x"), y_m=row.number("y"), z_m=row.number("z")
            )
            for row in self._folder.rows("objects3d.jsonl.gz")
        }
        self._visible: dict[str, tuple[str, ...]] = {}
        for row in self._folder.rows("graph.jsonl.gz"):
            unknown = [name for name in row.texts("viewpoints") if name not in self._places]
            if unknown:
                raise row.wrong("viewpoints", unknown[0], "viewpoints of viewpoints.jsonl.gz")
            self._visible.update(_visible(row))
        self._paths: dict[str, dict[int, PackPath]] = {}

    @property
    def splits(self) -> tuple[str, ...]:
        """Names of the splits that the folder holds: train, val_seen, val_unseen."""
        names = sorted(path.name for path in self._folder.path.glob("r2r_*.jsonl.gz"))
        return tuple(name.removeprefix("r2r_").removesuffix(".jsonl.gz") for name in names)

    def paths(self, split: str) -> dict[int, PackPath]:
        """The walks of a split by their number."""
        if split not in self._paths:
            if split not in self.splits:
                raise BadFileError(
                    f"the pack {str(self._folder.path)!r} has no split {split!r}; "
                    f"it has {', '.join(self.splits)}"
                )
            found: dict[int, PackPath] = {}
            for row in self._folder.rows(f"r2r_{split}.jsonl.gz"):
                path = self._path(row)
                if path.path_id in found:
                    raise row.wrong("path_id", path.path_id, "another number than the paths before")
                found[path.path_id] = path
            self._paths[split] = found
        return self._paths[split]

    def instructions(self, split: str) -> list[Instruction]:
        """All instructions of a split; they are grouped by scan."""
        return [
            Instruction(
                key=f"{path.path_id}_{number}",
                group=path.scan,
                tokens=tokenized(text),
                trajectory=path.trajectory,
            )
            for path in self.paths(split).values()
            for number, text in enumerate(path.instructions)
        ]

    def has_episodes(self, split: str, protocol: Protocol) -> bool:
        """Whether the pack holds errors of every type for a split."""
        return all(self._folder.has(_error_file(split, protocol, name)) for name in ERROR_TYPES)

    def episodes(self, split: str, protocol: Protocol, error_type: str) -> list[ErrorEpisode]:
        """The pack's own episodes of one type of error, clean and perturbed."""
        if error_type not in ERROR_TYPES:
            raise BadFileError(f"{error_type!r} is no type of error; there are {', '.join(ERROR_TYPES)}")
        paths = self.paths(split)
        rows = self._folder.rows(_error_file(split, protocol, error_type))
        return [_episode(row, error_type, paths) for row in rows]

    def common_sense(self) -> CommonSense:
        """The adjoining rooms and co-located objects that the pack's own errors were drawn from."""
        row = self._folder.row("priors.json")
        return CommonSense(
            rooms=row.named_texts("room_adjacency"), objects=row.named_texts("object_colocation")
        )

    def _path(self, row: Row) -> PackPath:
        names = row.texts("path")
        unknown = [name for name in names if name not in self._places]
        if unknown:
            raise row.wrong("path", unknown[0], "viewpoints of viewpoints.jsonl.gz")
        places = [self._places[name] for name in names]
        scan = row.text("scan")
        strange = [name for name, place in zip(names, places, strict=True) if place.scan != scan]
        if strange:
            raise row.wrong(
                "scan", scan, f"the scan of viewpoint {strange[0]!r}, {self._places[strange[0]].scan!r}"
            )
        yaws = [_yaw(row.number("heading"))]
        for here, there in pairwise(places):
            yaws.append(math.atan2(there.y_m - here.y_m, there.x_m - here.x_m))
        yaws.append(yaws[-1])
        return PackPath(
            path_id=row.whole("path_id"),
            scan=scan,
            trajectory=Trajectory(
                viewpoints=tuple(
                    Viewpoint(
                        x_m=place.x_m,
                        y_m=place.y_m,
                        z_m=place.z_m,
                        yaw_in_rad=yaws[k],
                        yaw_out_rad=yaws[k + 1],
                        rooms=place.rooms,
                        objects=tuple(self._in_sight(scan, names[k], yaws[k])),
                        place=f"{scan}/{names[k]}",
                    )
                    for k, place in enumerate(places)
                )
            ),
            instructions=tuple(row.texts("instructions")),
        )

    def _in_sight(self, scan: str, name: str, yaw_rad: float) -> Iterator[SeenObject]:
        here = self._places[name]
        listed = set()
        for label, heading, elevation, size, number in here.near:
            listed.add(number)
            thing = self._things.get((scan, number))
            yield SeenObject(
                name=label,
                bearing_rad=None if heading is None else wrapped(_yaw(heading) - yaw_rad),
                elevation_rad=elevation,
                size_sr=size,
                range_m=None if thing is None else _distance(here, thing),
            )
        for other in self._visible.get(name, ()):
            for _, _, _, _, number in self._places[other].near:
                thing = self._things.get((scan, number))
                if number in listed or thing is None:
                    continue
                listed.add(number)
                range_m = _distance(here, thing)
                if range_m <= SIGHT_M:
                    bearing = math.atan2(thing.y_m - here.y_m, thing.x_m - here.x_m) - yaw_rad
                    yield SeenObject(
                        name=thing.name,
                        bearing_rad=wrapped(bearing),
                        elevation_rad=math.asin((thing.z_m - here.z_m) / max(range_m, 1e-3))
                        if abs(thing.z_m - here.z_m) < range_m
                        else 0.0,
                        range_m=range_m,
                    )


def _error_file(split: str, protocol: Protocol, error_type: str) -> str:
    return f"errors_{protocol}/{split}_{error_type}.jsonl.gz"


def _near(row: Row) -> tuple[tuple[str, float | None, float | None, float | None, int], ...]:
    found = []
    for item in row.items("objects"):
        if not isinstance(item, list) or len(item) != _FIELDS_OF_AN_OBJECT or not isinstance(item[0], str):
            raise row.wrong(
                "objects", item, "[name, heading, elevation, solid angle, width, height, id] each"
            )
        label, heading, elevation, size, _, _, number = item
        if isinstance(number, bool) or not isinstance(number, int):
            raise row.wrong("objects", item, "objects with a whole number as their id")
        angles = [as_number(value) for value in (heading, elevation, size)]
        if any(a is None and v is not None for a, v in zip(angles, (heading, elevation, size), strict=True)):
            raise row.wrong("objects", item, "objects whose angles are finite numbers or null")
        found.append((label, *angles, number))
    return tuple(found)


def _visible(row: Row) -> Iterator[tuple[str, tuple[str, ...]]]:
    names = row.texts("viewpoints")
    seen: list[list[str]] = [[] for _ in names]
    for pair in row.items("visible"):
        if not isinstance(pair, list) or len(pair) != 2 or not all(_is_index(k, len(names)) for k in pair):
            raise row.wrong("visible", pair, f"pairs of numbers below {len(names)}")
        seen[pair[0]].append(names[pair[1]])
        seen[pair[1]].append(names[pair[0]])
    for name, others in zip(names, seen, strict=True):
        yield name, tuple(others)


def _is_index(value: object, count: int) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < count


def _episode(row: Row, error_type: str, paths: dict[int, PackPath]) -> ErrorEpisode:
    path = paths.get(row.whole("path_id"))
    if path is None:
        raise row.wrong("path_id", row.whole("path_id"), "a path of the same split")
    for name, wanted in (("scan", path.scan), ("type", error_type)):
        if row.text(name) != wanted:
            raise row.wrong(name, row.text(name), f"{wanted!r}, as its path and file have it")
    tokens = tuple(row.texts("tokens"))
    wrong = []
    for error in row.rows("errors"):
        start, length, kind = error.whole("pos"), error.whole("len"), error.text("kind")
        if kind not in KINDS:
            raise error.wrong("kind", kind, f"one of {', '.join(KINDS)}")
        if not 0 <= start < start + length <= len(tokens):
            raise error.wrong("pos", start, f"inside the {len(tokens)} tokens")
        # For directions the pack names the pair in `frm` and `to`; the words say which is which.
        names = ("orig", "new") if kind == DIRECTION else ("frm", "to")
        right, put_in = (error.text(name) for name in names)
        for name, word in zip(names, (right, put_in), strict=True):
            if kind == DIRECTION and word not in OPPOSITES:
                raise error.wrong(name, word, f"a direction: {', '.join(OPPOSITES)}")
        wrong.append(WrongSpan(start=start, length=length, kind=kind, right=right, wrong=put_in))
    if row.whole("label") != int(bool(wrong)):
        raise row.wrong("label", row.whole("label"), f"{int(bool(wrong))}, for it has {len(wrong)} errors")
    return ErrorEpisode(
        key=row.text("id"),
        group=path.scan,
        error_type=error_type,
        tokens=tokens,
        trajectory=path.trajectory,
        wrong=tuple(wrong),
    )


def _normalised(probs: Sequence[float] | None) -> tuple[float, ...]:
    """The pack rounds to three decimals; without any evidence every room is as likely."""
    if probs is None or not all(p >= 0.0 for p in probs) or sum(probs) <= 0.0:
        return UNKNOWN_ROOM
    total = sum(probs)
    return tuple(p / total for p in probs)


def _yaw(heading_rad: float) -> float:
    return math.pi / 2.0 - heading_rad


def _distance(place: _Place, thing: _Thing) -> float:
    return math.dist((place.x_m, place.y_m, place.z_m), (thing.x_m, thing.y_m, thing.z_m))
