"""Search scenes for the released POMP-BE-PD planner: the inverse of `import_pomp`, one target at a time."""

import json
from pathlib import Path

import numpy as np

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_msgs_py.values import Bool, Float64
from robustnav_nodes.benchmarks.import_pomp import COLUMNS, MAX_COLUMNS
from robustnav_nodes.benchmarks.search_scene import DetectionRecord, SearchScene, SearchTarget
from robustnav_nodes.search_space.observability import Observability
from robustnav_nodes.search_space.pose_graph import NOWHERE

TARGET_ID = 0  # of the only object in an exported folder


def export_pomp(scene: SearchScene, label: str, detector: str, folder: Path) -> None:
    """Write the first target called `label`, with what `detector` says of it, into a new folder.

    GaussObsvMatrix.txt is what the released planner multiplies its belief by, scaled to sum one: where the
    detector fired, its densities in view and 0 outside; elsewhere 1 - F1 in view and F1 outside. A row that
    would be all 0 is uniform. Coordinates, starts and destinations have no place in the format.

    Raises BadParameterError where the scene has no such target or the target no such detector, BadFileError
    where the folder exists already or cannot be written; what is in it then is not whole.
    """
    target = _target(scene, label)
    record = target.detections.get(detector)
    if record is None:
        raise BadParameterError(
            f"there is no detector {detector!r} for {label!r} in scene {scene.name!r}: choose one of "
            f"{sorted(target.detections)}"
        )
    observability = scene.space.observability
    poses, candidates = observability.poses, observability.candidates
    fired = np.isin(np.arange(poses), record.pose)
    statistics = {"precision": record.statistics.precision, "recall": record.statistics.recall}
    texts = {
        # Without a newline at its end: the released planner would count one pose more.
        "ListView.txt": "\n".join(f"pose_{pose:06d}" for pose in range(poses)),
        "MatrixG.txt": _successor_rows(scene),
        "MatrixL_gt.txt": _bit_rows(target.in_view[:, np.newaxis]),
        "MatrixL_dt.txt": _bit_rows(fired[:, np.newaxis]),
        "ObservMatrix.txt": "".join(_bit_rows(observability.row(pose)[np.newaxis]) for pose in range(poses)),
        "GaussObsvMatrix.txt": "".join(
            _number_row(_factor(record, observability, pose, is_fired=bool(fired[pose])))
            for pose in range(poses)
        ),
        "particles_that_are_inside_home.txt": "1\n" * candidates,
        "detector_stat.json": json.dumps({str(TARGET_ID): statistics}) + "\n",
        "instance_id_map.txt": f"{' '.join(label.split())} {TARGET_ID}\n",
    }
    try:
        folder.mkdir()
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
    except FileExistsError as error:
        raise BadFileError(
            f"the folder {str(folder)!r} exists already: remove it, or name another"
        ) from error
    except OSError as error:
        raise BadFileError(f"cannot write the folder {str(folder)!r}: {error.strerror}") from error


def _target(scene: SearchScene, label: str) -> SearchTarget:
    for target in scene.targets:
        if target.label == label:
            return target
    raise BadParameterError(
        f"there is no target {label!r} in scene {scene.name!r}: choose one of "
        f"{sorted({target.label for target in scene.targets})}"
    )


def _successor_rows(scene: SearchScene) -> str:
    successors = scene.space.graph.successors[:, COLUMNS]
    unused = np.full((len(successors), MAX_COLUMNS - len(COLUMNS)), NOWHERE, dtype=np.int32)
    rows = np.hstack([successors, unused]).tolist()
    return "".join(" ".join(map(str, row)) + "\n" for row in rows)


def _bit_rows(bits: Bool) -> str:
    """Rows of 0 and 1 without blanks."""
    return "".join((row + np.uint8(ord("0"))).tobytes().decode("ascii") + "\n" for row in bits)


def _factor(record: DetectionRecord, observability: Observability, pose: int, *, is_fired: bool) -> Float64:
    in_view = observability.row(pose)
    if is_fired:
        factor = np.where(in_view, record.at(pose, observability.candidates).sum(axis=0), 0.0)
    else:
        f1 = record.statistics.f1
        factor = np.where(in_view, 1.0 - f1, f1)
    total = factor.sum()
    if total <= 0.0:
        return np.full(len(factor), 1.0 / len(factor))
    return np.asarray(factor / total, dtype=np.float64)


def _number_row(numbers: Float64) -> str:
    """Numbers between single blanks; one that is too small for the planner's reader (std::stod) is 0."""
    values, place = np.unique(
        np.where(numbers < np.finfo(np.float64).tiny, 0.0, numbers), return_inverse=True
    )
    words = [f"{value:.9g}" for value in values.tolist()]
    return " ".join(words[index] for index in place.tolist()) + "\n"
