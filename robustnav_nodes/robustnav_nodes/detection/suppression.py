"""Of boxes that show the same thing, the best one stays: non-maximum suppression within each class."""

import numpy as np

from robustnav_nodes.detection.boxes import Boxes

MOST_BOXES = 1000  # the best ones; a detector that says more says nothing


def suppress(boxes: Boxes, iou_max: float) -> Boxes:
    """Best first, without those whose IoU with a better one of their class is more than `iou_max`.

    Boxes without area, such as one that was cut off at the image's edge, are dropped too.
    """
    order = np.argsort(-boxes.score, kind="stable")[:MOST_BOXES]
    box_px = boxes.box_px[order].astype(np.float64)
    label = boxes.label[order]
    area = np.prod(np.maximum(box_px[:, 2:] - box_px[:, :2], 0.0), axis=1)
    stays = area > 0.0
    kept: list[int] = []
    for best in range(len(order)):
        if not stays[best]:
            continue
        kept.append(best)
        low = np.maximum(box_px[best, :2], box_px[:, :2])
        high = np.minimum(box_px[best, 2:], box_px[:, 2:])
        shared = np.prod(np.maximum(high - low, 0.0), axis=1)
        union = area[best] + area - shared
        stays &= (label != label[best]) | (shared <= iou_max * union)
    return boxes[order[kept]]
