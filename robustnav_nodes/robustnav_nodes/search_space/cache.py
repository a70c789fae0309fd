"""Observability tables kept on disk, so that a node started again need not look from every pose anew."""

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from robustnav_msgs_py.values import OccupancyMap, Pose2D
from robustnav_nodes.search_space import sight
from robustnav_nodes.search_space.camera_view import CameraView
from robustnav_nodes.search_space.observability import Observability, build_observability
from robustnav_nodes.search_space.parameters import SearchSpaceParameters
from robustnav_nodes.search_space.pose_graph import PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

_PREFIX = "observability-"


@dataclass(frozen=True, slots=True, kw_only=True)
class ObservabilityCache:
    """The tables in `folder`, each named by a hash of everything that decides it.

    A cache never stops a search: a file that cannot be read or written, or that holds something else, only
    costs the time to build the table. Several processes may use one folder.

    limit_bytes: of all tables together; beyond it, those used longest ago go first.
    min_sights: smaller tables are not kept, since building them takes no longer than a blink.
    """

    folder: Path
    limit_bytes: int = 500_000_000
    min_sights: int = 1_000_000

    def observability(
        self, view: CameraView, graph: PoseGraph, parameters: SearchSpaceParameters
    ) -> Observability:
        """What `build_observability` gives, from the folder where it is there."""
        path = self.folder / f"{_PREFIX}{_fingerprint(view, graph, parameters)}.npz"
        kept = _read(path, len(graph), len(view.candidates))
        if kept is not None:
            with contextlib.suppress(OSError):
                path.touch()
            return kept
        built = build_observability(view, graph, parameters)
        if len(built.seen) >= self.min_sights:
            with contextlib.suppress(OSError):
                self._write(path, built)
                self._make_room()
        return built

    def _write(self, path: Path, table: Observability) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(prefix=_PREFIX, suffix=".part", dir=self.folder)
        try:
            with os.fdopen(handle, "wb") as file:
                np.savez(file, seen_start=table.seen_start, seen=table.seen)
            Path(name).replace(path)
        finally:
            Path(name).unlink(missing_ok=True)

    def _make_room(self) -> None:
        files = [(path, path.stat()) for path in self.folder.glob(f"{_PREFIX}*")]
        files.sort(key=lambda file: file[1].st_mtime_ns, reverse=True)
        total = 0
        for path, status in files:
            total += status.st_size
            if total > self.limit_bytes:
                path.unlink(missing_ok=True)


def cached_search_space(
    floor_map: OccupancyMap,
    candidate_mask: OccupancyMap | None,
    parameters: SearchSpaceParameters,
    start: Pose2D | None,
    folder: Path | None,
) -> SearchSpace:
    """What `SearchSpace.build` gives, its table of what sees what kept in `folder`; None: not kept."""
    if folder is None:
        return SearchSpace.build(floor_map, candidate_mask, parameters, start)
    cache = ObservabilityCache(folder=folder)
    return SearchSpace.build(floor_map, candidate_mask, parameters, start, cache.observability)


def user_cache_folder(environ: Mapping[str, str] = os.environ) -> Path | None:
    """`$XDG_CACHE_HOME/robustnav`, else `~/.cache/robustnav`; None where the user has no home."""
    base = Path(environ.get("XDG_CACHE_HOME", ""))
    if base.is_absolute():  # the XDG standard says to ignore any other
        return base / "robustnav"
    try:
        return Path.home() / ".cache" / "robustnav"
    except RuntimeError:
        return None


def _fingerprint(view: CameraView, graph: PoseGraph, parameters: SearchSpaceParameters) -> str:
    """A hash of all that `build_observability` goes by, the rule of what is in view included."""
    digest = hashlib.sha256(Path(sight.__file__).read_bytes())
    of_scene = (value for value in view.scene if value is not view.scene.buckets)  # made of the others
    limit = parameters.max_observability_mb
    for value in (*of_scene, graph.x_m, graph.y_m, graph.yaw_rad, limit):
        if isinstance(value, np.ndarray):
            digest.update(f"{value.dtype} {value.shape}\n".encode())
            digest.update(value.tobytes())
        else:
            digest.update(f"{value!r}\n".encode())
    return digest.hexdigest()


def _read(path: Path, poses: int, candidates: int) -> Observability | None:
    try:
        with np.load(path, allow_pickle=False) as file:
            seen_start, seen = file["seen_start"], file["seen"]
        if (seen_start.dtype, seen.dtype, seen_start.shape) != (np.int64, np.int32, (poses + 1,)):
            return None
        return Observability.of_rows(seen_start, seen, candidates)
    except Exception:  # a damaged file makes zipfile and numpy raise almost anything; it is written anew
        return None
