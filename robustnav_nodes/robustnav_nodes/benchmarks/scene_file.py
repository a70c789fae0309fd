"""Search scenes in files of our own.

A scene file is a zip archive of arrays, as numpy's .npz is; n poses, k candidates, d detections:

    about                            uint8: JSON, with names, statistics and whatever is no array
    pose/x_m, y_m, yaw_rad           float64 [n]
    pose/successors                  int32 [n, 4]
    candidate/x_m, y_m               float64 [k]
    observability/seen_start, seen   int64 [n + 1], int32: as in Observability
    starts                           int32
    target/T/in_view, destination    bool [n]; no destination where nobody says
    target/T/detector/D/pose, start, candidate, weight
                                     int32 [d], int64 [d + 1], int32, float64: as in DetectionRecord
"""

import contextlib
import io
import json
import math
import os
import zipfile
import zlib
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import DTypeLike, NDArray

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import Float64
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene, SearchTarget
from robustnav_nodes.search_space.candidates import Candidates
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action, PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

FORMAT = "robustnav search scene"
VERSION = 1

_MAX_BYTES = 2**30  # unpacked; a larger file is not one of ours
_DAMAGE = (OSError, ValueError, EOFError, RuntimeError, MemoryError, zipfile.BadZipFile, zlib.error)

Arrays = dict[str, NDArray[Any]]
T = TypeVar("T")


def write_scene(scene: SearchScene, path: Path) -> None:
    """Write `scene` to a new file, whole or not at all. What looks between the poses (`view`) is left out.

    Raises BadFileError where `path` exists already or cannot be written.
    """
    if path.exists():
        raise BadFileError(f"the scene file {str(path)!r} exists already: remove it, or name another one")
    unfinished = path.with_name(path.name + ".part")
    try:
        with unfinished.open("wb") as output:
            with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED) as archive:
                for name, array in _arrays_of(scene).items():
                    with archive.open(f"{name}.npy", "w") as entry:
                        np.lib.format.write_array(entry, array, allow_pickle=False)
            output.flush()
            os.fsync(output.fileno())
        unfinished.replace(path)
    except OSError as error:
        raise BadFileError(f"cannot write the scene file {str(path)!r}: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            unfinished.unlink()


def read_scene(path: Path) -> SearchScene:
    """The scene that `write_scene` wrote to `path`, bit for bit, without a `view`.

    Raises BadFileError where the file cannot be read, is damaged, not a scene file, or does not hold
    together.
    """
    source = _Source(path)
    about = source.about()
    poses = len(source.array("pose/x_m", np.float64, None))
    candidates = len(source.array("candidate/x_m", np.float64, None))
    graph = PoseGraph(
        x_m=source.numbers("pose/x_m", poses),
        y_m=source.numbers("pose/y_m", poses),
        yaw_rad=source.numbers("pose/yaw_rad", poses),
        successors=source.indices("pose/successors", NOWHERE, poses, poses, len(Action)),
        headings=source.entry(about, "headings", int),
    )
    size_m = source.entry(about, "candidate_size_m", float)
    if graph.headings < 1 or not (math.isfinite(size_m) and size_m > 0.0):
        raise source.bad(f"{graph.headings} headings and candidates of {size_m!r} m make no sense")
    space = SearchSpace(
        graph=graph,
        candidates=Candidates(
            x_m=source.numbers("candidate/x_m", candidates),
            y_m=source.numbers("candidate/y_m", candidates),
            size_m=size_m,
        ),
        observability=_observability(source, poses, candidates),
        frame_id=source.entry(about, "frame_id", str),
    )
    return SearchScene(
        name=source.entry(about, "name", str),
        difficulty=source.entry(about, "difficulty", str),
        space=space,
        targets=tuple(
            _target(source, f"target/{number}", table, poses, candidates)
            for number, table in enumerate(source.entry(about, "targets", list))
        ),
        starts=source.indices("starts", 0, poses, None),
    )


def _arrays_of(scene: SearchScene) -> Arrays:
    graph, observability = scene.space.graph, scene.space.observability
    arrays: Arrays = {
        "about": np.frombuffer(json.dumps(_about(scene)).encode(), dtype=np.uint8),
        "pose/x_m": np.ascontiguousarray(graph.x_m, dtype=np.float64),
        "pose/y_m": np.ascontiguousarray(graph.y_m, dtype=np.float64),
        "pose/yaw_rad": np.ascontiguousarray(graph.yaw_rad, dtype=np.float64),
        "pose/successors": np.ascontiguousarray(graph.successors, dtype=np.int32),
        "candidate/x_m": np.ascontiguousarray(scene.space.candidates.x_m, dtype=np.float64),
        "candidate/y_m": np.ascontiguousarray(scene.space.candidates.y_m, dtype=np.float64),
        "observability/seen_start": np.ascontiguousarray(observability.seen_start, dtype=np.int64),
        "observability/seen": np.ascontiguousarray(observability.seen, dtype=np.int32),
        "starts": np.ascontiguousarray(scene.starts, dtype=np.int32),
    }
    for number, target in enumerate(scene.targets):
        name = f"target/{number}"
        arrays[f"{name}/in_view"] = np.ascontiguousarray(target.in_view, dtype=np.bool_)
        if target.destination is not None:
            arrays[f"{name}/destination"] = np.ascontiguousarray(target.destination, dtype=np.bool_)
        for place, record in enumerate(target.detections.values()):
            detector = f"{name}/detector/{place}"
            arrays[f"{detector}/pose"] = np.ascontiguousarray(record.pose, dtype=np.int32)
            arrays[f"{detector}/start"] = np.ascontiguousarray(record.start, dtype=np.int64)
            arrays[f"{detector}/candidate"] = np.ascontiguousarray(record.candidate, dtype=np.int32)
            arrays[f"{detector}/weight"] = np.ascontiguousarray(record.weight, dtype=np.float64)
    return arrays


def _about(scene: SearchScene) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "version": VERSION,
        "name": scene.name,
        "difficulty": scene.difficulty,
        "frame_id": scene.space.frame_id,
        "headings": int(scene.space.graph.headings),
        "candidate_size_m": float(scene.space.candidates.size_m),
        "targets": [
            {
                "label": target.label,
                "has_destination": target.destination is not None,
                "detectors": [
                    {
                        "name": name,
                        "precision": float(record.statistics.precision),
                        "recall": float(record.statistics.recall),
                    }
                    for name, record in target.detections.items()
                ],
            }
            for target in scene.targets
        ],
    }


def _observability(source: "_Source", poses: int, candidates: int) -> Observability:
    seen = source.indices("observability/seen", 0, candidates, None)
    seen_start = source.spans("observability/seen_start", poses, len(seen))
    row = np.repeat(np.arange(poses), np.diff(seen_start))
    if np.any((np.diff(row) == 0) & (np.diff(seen) <= 0)):
        raise source.bad("'observability/seen' does not ascend within each pose")
    return Observability.of_rows(seen_start, seen, candidates)


def _target(source: "_Source", name: str, about: Any, poses: int, candidates: int) -> SearchTarget:
    has_destination = source.entry(about, "has_destination", bool)
    return SearchTarget(
        label=source.entry(about, "label", str),
        in_view=source.array(f"{name}/in_view", np.bool_, poses),
        destination=source.array(f"{name}/destination", np.bool_, poses) if has_destination else None,
        detections={
            source.entry(table, "name", str): _record(
                source, f"{name}/detector/{place}", table, poses, candidates
            )
            for place, table in enumerate(source.entry(about, "detectors", list))
        },
    )


def _record(source: "_Source", name: str, about: Any, poses: int, candidates: int) -> DetectionRecord:
    try:
        statistics = ClassStatistics(
            precision=source.entry(about, "precision", float), recall=source.entry(about, "recall", float)
        )
    except BadParameterError as error:
        raise source.bad(str(error)) from error
    pose = source.indices(f"{name}/pose", 0, poses, None)
    candidate = source.indices(f"{name}/candidate", 0, candidates, None)
    weight = source.numbers(f"{name}/weight", len(candidate))
    if np.any(np.diff(pose) < 0) or np.any(weight <= 0.0):
        raise source.bad(f"the poses of {name!r} do not ascend, or a weight is not positive")
    start = source.spans(f"{name}/start", len(pose), len(candidate))
    return DetectionRecord(statistics=statistics, pose=pose, start=start, candidate=candidate, weight=weight)


class _Source:
    """What a scene file holds; each array is checked when it is taken."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            stream = path.open("rb")
        except OSError as error:
            raise BadFileError(f"cannot read the scene file {str(path)!r}: {error.strerror}") from error
        with stream:
            try:
                self._arrays = self._unpacked(zipfile.ZipFile(stream))
            except _DAMAGE as error:
                raise self.bad(f"it cannot be unpacked ({error})") from error

    def bad(self, what: str) -> BadFileError:
        return BadFileError(
            f"the scene file {str(self._path)!r} is damaged or is none: {what}; write or import it anew"
        )

    def about(self) -> dict[str, Any]:
        try:
            about = json.loads(self.array("about", np.uint8, None).tobytes())
        except (ValueError, RecursionError) as error:
            raise self.bad(f"its 'about' is not JSON ({error})") from error
        found, version = self.entry(about, "format", str), self.entry(about, "version", int)
        if found != FORMAT:
            raise self.bad(f"its format is {found!r}, not {FORMAT!r}")
        if version != VERSION:
            raise BadFileError(
                f"the scene file {str(self._path)!r} is of version {version}, this robustnav reads version "
                f"{VERSION}: install the robustnav that wrote it, or import the scene anew"
            )
        return dict(about)

    def entry(self, table: Any, name: str, kind: type[T]) -> T:
        """Entry `name` of a JSON object, of exactly this type."""
        value = table.get(name) if isinstance(table, dict) else None
        if type(value) is not kind:
            raise self.bad(f"{name!r} in its 'about' must be of type {kind.__name__}, not {value!r:.60}")
        return value

    def array(self, name: str, dtype: DTypeLike, *shape: int | None) -> NDArray[Any]:
        """Array `name`, of exactly this type and shape; None: any length."""
        array = self._arrays.get(name)
        if array is None:
            raise self.bad(f"it lacks {name!r}")
        fits = len(array.shape) == len(shape) and all(
            wanted is None or length == wanted for length, wanted in zip(array.shape, shape, strict=True)
        )
        if array.dtype != dtype or not fits:
            wanted = [length if length is not None else "any" for length in shape]
            raise self.bad(f"{name!r} is {array.dtype} {list(array.shape)}, not {np.dtype(dtype)} {wanted}")
        return array

    def numbers(self, name: str, count: int) -> Float64:
        """float64 [count], all finite."""
        array = self.array(name, np.float64, count)
        if not np.isfinite(array).all():
            raise self.bad(f"{name!r} holds numbers that are not finite")
        return array

    def indices(self, name: str, lowest: int, limit: int, *shape: int | None) -> NDArray[np.int32]:
        """int32 of this shape, all in lowest .. limit - 1."""
        array = self.array(name, np.int32, *shape)
        if array.size and not (lowest <= array.min() and array.max() < limit):
            raise self.bad(
                f"{name!r} holds {array.min()} .. {array.max()}, which is not within {lowest} .. {limit - 1}"
            )
        return array

    def spans(self, name: str, count: int, total: int) -> NDArray[np.int64]:
        """int64 [count + 1]: where each of `count` spans of an array of length `total` begins."""
        array = self.array(name, np.int64, count + 1)
        if array[0] != 0 or array[-1] != total or np.any(array[1:] < array[:-1]):
            raise self.bad(f"{name!r} does not ascend from 0 to {total}")
        return array

    def _unpacked(self, archive: zipfile.ZipFile) -> Arrays:
        size = sum(entry.file_size for entry in archive.infolist())
        if size > _MAX_BYTES:
            raise self.bad(f"it holds {size / 1e9:.1f} GB")
        return {
            name.removesuffix(".npy"): np.lib.format.read_array(
                io.BytesIO(archive.read(name)), allow_pickle=False
            )
            for name in archive.namelist()
        }
