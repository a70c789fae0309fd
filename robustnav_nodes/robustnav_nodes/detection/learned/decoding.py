"""From the detector's output to boxes: the peaks of the heat maps, each peak once."""

import numpy as np
import torch
from torch.nn import functional

from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.evaluation import iou
from robustnav_nodes.detection.learned.network import STRIDE

MAX_PEAKS = 100
# Two boxes of a class that overlap more are one object.
SAME_IOU = 0.5


def decode(logits: torch.Tensor, reach_px: torch.Tensor, score_min: float) -> Boxes:
    """The boxes of one image, best first: logits [classes, rows, columns], reach_px [4, rows, columns]."""
    score = torch.sigmoid(logits)
    peaks = score * (functional.max_pool2d(score[None], 3, stride=1, padding=1)[0] == score)
    best, at = peaks.flatten().topk(min(MAX_PEAKS, peaks.numel()))
    at = at[best >= score_min]
    rows, columns = score.shape[1:]
    label, cell = at // (rows * columns), at % (rows * columns)
    u, v = (cell % columns + 0.5) * STRIDE, (cell // columns + 0.5) * STRIDE
    reach = reach_px.reshape(4, -1)[:, cell]
    box_px = torch.stack([u - reach[0], v - reach[1], u + reach[2], v + reach[3]], dim=1)
    found = Boxes(
        box_px=box_px.numpy().astype(np.float32),
        score=best[: len(at)].numpy().astype(np.float32),
        label=label.numpy().astype(np.uint32),
    )
    return _each_once(found)


def _each_once(boxes: Boxes) -> Boxes:
    """Without boxes that overlap a better one of their class."""
    same = (iou(boxes.box_px, boxes.box_px) > SAME_IOU) & (boxes.label[:, None] == boxes.label[None, :])
    kept: list[int] = []
    for at in range(len(boxes)):
        if not same[at, kept].any():
            kept.append(at)
    return boxes[np.array(kept, dtype=np.int64)]
