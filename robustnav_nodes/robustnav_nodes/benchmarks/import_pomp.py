"""Search scenes from the text folder that the released POMP-BE-PD planner reads (`input_pomp_be_pd`).

| file | holds |
|---|---|
| `ListView.txt` | one image per line: the n poses |
| `MatrixG.txt` | n rows: the row that rotate_ccw, rotate_cw, forward and backward lead to, -1 where none |
| `MatrixL_gt.txt`, `MatrixL_dt.txt` | n rows x objects, 0 or 1: in view, and found by the detector |
| `ObservMatrix.txt` | n rows x cells, 0 or 1: L |
| `GaussObsvMatrix.txt` | n rows x cells: the belief's factor at each pose, for one object |
| `particles_that_are_inside_home.txt` | 0 or 1 for each cell |
| `detector_stat.json` | `{"3": {"precision": 0.8, "recall": 0.6}}`, by number of the object |
| `instance_id_map.txt` | name and number of each object; may be missing |
"""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.detector_statistics import ClassStatistics
from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.benchmarks.pose_layout import lay_out
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene, SearchTarget, Sighting
from robustnav_nodes.benchmarks.text_files import read_instance_names, read_json_object, read_lines
from robustnav_nodes.search_space.candidates import Candidates
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE, Action, PoseGraph
from robustnav_nodes.search_space.space import SearchSpace

COLUMNS = (Action.TURN_LEFT, Action.TURN_RIGHT, Action.FORWARD, Action.BACKWARD)  # of MatrixG.txt
MAX_COLUMNS = 6  # two more that nobody uses now

_AHEAD_M = 2.0  # where a candidate is drawn, from each pose that sees it
_CELL_M = 0.20


def import_pomp(folder: Path, target_id: int) -> SearchScene:
    """The scene in `folder` with one target: the object whose GaussObsvMatrix.txt lies there.

    A cell is a candidate where it is inside the home and some pose has it in view. "perfect" fires where
    MatrixL_gt.txt says so; "noisy" where MatrixL_dt.txt does, with precision and recall from
    detector_stat.json. A detection is uniform over the candidates in view; a noisy one follows its row of
    GaussObsvMatrix.txt where that row is above 0 somewhere in view. One at a pose without any candidate in
    view says nothing of where, and is left out.

    The format has no coordinates. What the scene says of metres and headings is made up from the graph's
    turns and moves (see `lay_out`): good for pictures, not for docking.

    Raises BadFileError where a file is missing or wrong, or nothing is known of `target_id`.
    """
    poses = len(read_lines(folder / "ListView.txt"))
    if poses == 0:
        raise BadFileError(f"{str(folder / 'ListView.txt')!r} names no image: it must have a line per pose")
    truth = _read_bits(folder / "MatrixL_gt.txt", poses)
    fired = _read_bits(folder / "MatrixL_dt.txt", poses)
    statistics = read_json_object(folder / "detector_stat.json")
    known = [
        column
        for column in np.nonzero(truth.any(axis=0))[0].tolist()
        if column < fired.shape[1] and str(column) in statistics
    ]
    if target_id not in known:
        raise BadFileError(
            f"object {target_id!r} cannot be looked for in {str(folder)!r}: choose of {known}, which have "
            "statistics in detector_stat.json, a column in MatrixL_dt.txt and a pose that sees them in "
            "MatrixL_gt.txt"
        )
    noisy = _statistics(statistics[str(target_id)], target_id, folder / "detector_stat.json")
    visible = _read_bits(folder / "ObservMatrix.txt", poses)
    density = _read_densities(folder / "GaussObsvMatrix.txt", *visible.shape)
    inside = _read_inside(folder / "particles_that_are_inside_home.txt", visible.shape[1])
    kept = inside & visible.any(axis=0)
    if not kept.any():
        raise BadFileError(
            f"no cell of {str(folder)!r} is both inside the home and in view of a pose: check "
            "particles_that_are_inside_home.txt and ObservMatrix.txt"
        )
    space = _space(_read_successors(folder / "MatrixG.txt", poses), visible[:, kept])
    in_view, found = truth[:, target_id], fired[:, target_id]
    perfect = ClassStatistics(precision=1.0, recall=1.0)
    uniform = np.ones((poses, len(space.candidates)))
    names = read_instance_names(folder / "instance_id_map.txt")
    target = SearchTarget(
        label=names.get(target_id, f"object {target_id}"),
        in_view=in_view,
        destination=None,
        detections={
            "perfect": _record(perfect, in_view, space.observability, uniform),
            "noisy": _record(noisy, found, space.observability, density[:, kept]),
        },
    )
    name = folder.resolve().name
    return SearchScene(
        name=name, difficulty=name, space=space, targets=(target,), starts=np.zeros(0, dtype=np.int32)
    )


def _rows(path: Path, poses: int) -> list[str]:
    rows = read_lines(path)
    if len(rows) != poses:
        raise BadFileError(
            f"{str(path)!r} has {len(rows)} rows, ListView.txt has {poses}: both must have one for each pose"
        )
    return rows


def _read_bits(path: Path, poses: int) -> Bool:
    """bool [poses, columns]: rows of 0 and 1, with or without blanks between them."""
    rows = []
    for number, line in enumerate(_rows(path, poses), start=1):
        row = "".join(line.split())
        if not row:
            raise BadFileError(f"line {number} of {str(path)!r} is empty: it needs a 0 or 1 for each column")
        if row.strip("01"):
            raise BadFileError(
                f"line {number} of {str(path)!r} holds {row.strip('01')[0]!r}: it may hold 0 and 1 only"
            )
        rows.append(np.frombuffer(row.encode("ascii"), dtype=np.uint8) == ord("1"))
        _check_width(path, number, len(row), len(rows[0]))
    return np.stack(rows)


def _read_densities(path: Path, poses: int, cells: int) -> Float64:
    """float64 [poses, cells], finite and not negative."""
    rows = np.empty((poses, cells))
    for number, line in enumerate(_rows(path, poses), start=1):
        words = line.split()
        _check_width(path, number, len(words), cells)
        try:
            row = np.array(words, dtype=np.float64)
        except ValueError as error:
            raise BadFileError(f"line {number} of {str(path)!r} holds no number: {error}") from error
        wrong = ~(np.isfinite(row) & (row >= 0.0))
        if wrong.any():
            raise BadFileError(
                f"line {number} of {str(path)!r} holds {words[int(np.argmax(wrong))]!r}: factors of a belief "
                "are finite and not negative"
            )
        rows[number - 1] = row
    return rows


def _read_successors(path: Path, poses: int) -> NDArray[np.int32]:
    """int32 [poses, 4], the columns in the order of Action."""
    successors = np.full((poses, len(Action)), NOWHERE, dtype=np.int32)
    for number, line in enumerate(_rows(path, poses), start=1):
        words = line.split()
        if not len(COLUMNS) <= len(words) <= MAX_COLUMNS:
            raise BadFileError(
                f"line {number} of {str(path)!r} has {len(words)} columns: it needs {len(COLUMNS)} to "
                f"{MAX_COLUMNS}, for rotate_ccw, rotate_cw, forward, backward"
            )
        for action, word in zip(COLUMNS, words, strict=False):
            if not word.removeprefix("-").isdecimal() or not NOWHERE <= int(word) < poses:
                raise BadFileError(
                    f"line {number} of {str(path)!r} holds {word!r}: a successor is a row, 0 to {poses - 1}, "
                    f"or {NOWHERE} for none"
                )
            successors[number - 1, action] = int(word)
    return successors


def _read_inside(path: Path, cells: int) -> Bool:
    """bool [cells]."""
    words = " ".join(read_lines(path)).split()
    if len(words) != cells or not set(words) <= {"0", "1"}:
        odd = next((word for word in words if word not in ("0", "1")), None)
        wrong = f"{odd!r}" if odd is not None else f"{len(words)} values"
        raise BadFileError(
            f"{str(path)!r} holds {wrong}: it must hold a 0 or 1 for each of the {cells} columns of "
            "ObservMatrix.txt"
        )
    return np.array([word == "1" for word in words], dtype=np.bool_)


def _statistics(row: Any, target_id: int, path: Path) -> ClassStatistics:
    values: list[Any] = [row.get(name) if isinstance(row, dict) else None for name in ("precision", "recall")]
    if any(type(value) not in (int, float) for value in values):
        raise BadFileError(
            f"object '{target_id}' in {str(path)!r} must be {{'precision': 0..1, 'recall': 0..1}}, "
            f"not {row!r:.80}"
        )
    precision, recall = map(float, values)
    try:
        return ClassStatistics(precision=precision, recall=recall)
    except BadParameterError as error:
        raise BadFileError(f"object '{target_id}' in {str(path)!r}: {error}") from error


def _check_width(path: Path, number: int, width: int, wanted: int) -> None:
    if width != wanted:
        raise BadFileError(f"line {number} of {str(path)!r} has {width} columns, not {wanted} as it should")


def _space(successors: NDArray[np.int32], visible: Bool) -> SearchSpace:
    layout = lay_out(successors)
    seen_start = np.concatenate([[0], np.cumsum(np.count_nonzero(visible, axis=1))])
    seen = np.nonzero(visible)[1].astype(np.int32)
    seers = np.count_nonzero(visible, axis=0)
    return SearchSpace(
        graph=PoseGraph(successors=successors, **layout._asdict()),
        candidates=Candidates(
            x_m=(layout.x_m + _AHEAD_M * np.cos(layout.yaw_rad)) @ visible / seers,
            y_m=(layout.y_m + _AHEAD_M * np.sin(layout.yaw_rad)) @ visible / seers,
            size_m=_CELL_M,
        ),
        observability=Observability.of_rows(seen_start, seen, visible.shape[1]),
    )


def _record(
    statistics: ClassStatistics, fired: Bool, observability: Observability, density: Float64
) -> DetectionRecord:
    """One detection at each pose that fired (bool [n]), by its row of `density` (float64 [n, k])."""
    sightings: list[Sighting] = []
    for pose in np.nonzero(fired)[0].tolist():
        seen = observability.seen_by(pose)
        weight = density[pose, seen]
        if not weight.any():
            weight = np.ones(len(seen))
        kept = weight > 0.0
        if kept.any():
            sightings.append((pose, seen[kept], weight[kept] / weight.max()))
    return DetectionRecord.of(statistics, sightings)
