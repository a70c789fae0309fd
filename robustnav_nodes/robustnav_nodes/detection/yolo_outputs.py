"""What models of the YOLO family say, as boxes: the layouts of versions 5 and 8 (and 9, 11, 12, as 8)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.detection.boxes import Boxes

Output = NDArray[np.float32]


def decoded(outputs: Sequence[Output], classes: int, score_min: float) -> Boxes:
    """Boxes in the model's own pixels, before suppression, each with its best class.

    The first output counts that has a known layout: [1, 4 + classes, n] with scores by class (version 8), or
    [1, n, 5 + classes] whose fifth number says whether there is anything at all (version 5); either may be
    transposed. Raises BadFileError where none has.
    """
    for output in outputs:
        rows = _rows(output, classes)
        if rows is not None:
            return _boxes(rows, classes, score_min)
    shapes = ", ".join(str(list(output.shape)) for output in outputs)
    raise BadFileError(
        f"the model's output is {shapes}; with {classes} class names it should be [1, {4 + classes}, n] or "
        f"[1, n, {5 + classes}]: is this the model's list of class names, and a YOLO model without "
        "suppression in it?"
    )


def _rows(output: Output, classes: int) -> Output | None:
    """[n, 4 + classes] or [n, 5 + classes]."""
    if output.ndim != 3 or output.shape[0] != 1:
        return None
    table: Output = output[0]
    if table.shape[0] == 4 + classes:
        return table.T
    if table.shape[1] in (5 + classes, 4 + classes):
        return table
    return table.T if table.shape[0] == 5 + classes else None


def _boxes(rows: Output, classes: int, score_min: float) -> Boxes:
    by_class = rows[:, -classes:]
    if rows.shape[1] == 5 + classes:
        by_class = by_class * rows[:, 4:5]
    label = by_class.argmax(axis=1)
    score = by_class[np.arange(len(rows)), label]
    kept = (score >= score_min) & np.isfinite(rows).all(axis=1) & (rows[:, 2] > 0.0) & (rows[:, 3] > 0.0)
    centre, half = rows[kept, :2], rows[kept, 2:4] / 2.0
    return Boxes(
        box_px=np.concatenate([centre - half, centre + half], axis=1).astype(np.float32),
        score=np.clip(score[kept], 0.0, 1.0).astype(np.float32),
        label=label[kept].astype(np.uint32),
    )
