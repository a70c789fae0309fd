"""What the networks are taught: heat maps and boxes of the detector, and which looks are alike.

Heat maps and the cells that learn a box follow Liu et al., "Training-Time-Friendly Network for Real-Time
Object Detection" (2020): many cells of an object learn its box, which makes learning fast.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional

from robustnav_msgs_py.values import Float32
from robustnav_nodes.detection.learned.network import STRIDE

# The part of a box, along each axis, in which a heat map is above 0.
HOT_PART = 0.54
COLD_POWER = 4.0
BOX_WEIGHT = 5.0
TEMPERATURE = 0.07


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Targets:
    """What a batch should have come to.

    hot: int64 [objects], the cells of the heat maps in the middles of objects, counted over images, classes,
    rows and columns; cold: float32 [n, classes, rows, columns], how cold a cell should be: 1, less around
    a middle, 0 there and where it does not matter; cells: int64 [m], all that learn a box, counted over
    images, rows and columns; box_px: float32 [m, 4] what each learns; weight: float32 [m], 1 in all for each
    object.
    """

    hot: torch.Tensor
    cold: torch.Tensor
    cells: torch.Tensor
    box_px: torch.Tensor
    weight: torch.Tensor


def targets(
    boxes: list[Float32],
    labels: list[NDArray[np.int32]],
    taught: list[NDArray[np.bool_]],
    shape: tuple[int, int, int, int],
) -> Targets:
    """Targets of a batch: per image boxes [k, 4], labels [k], which are `taught`; others do not matter.

    shape: of the heat maps, n, classes, rows, columns.
    """
    cold = np.ones(shape, dtype=np.float32)
    hot, cells, box_px, weights = [], [], [], []
    rows, columns = shape[2:]
    for image, (some, their_labels, are_taught) in enumerate(zip(boxes, labels, taught, strict=True)):
        for box, label in zip(some[~are_taught], their_labels[~are_taught].tolist(), strict=True):
            left, top = np.floor(box[:2] / STRIDE).astype(int)
            right, bottom = np.ceil(box[2:] / STRIDE).astype(int)
            cold[image, label, top:bottom, left:right] = 0.0
        for box, label in zip(some[are_taught], their_labels[are_taught].tolist(), strict=True):
            u, v = np.minimum((box[:2] + box[2:]) / 2.0 / STRIDE, (columns - 1, rows - 1)).astype(int)
            bump, near_v, near_u = _bump(box, int(u), int(v), rows, columns)
            near = cold[image, label, near_v, near_u]
            np.minimum(near, (1.0 - bump) ** COLD_POWER, out=near)
            hot.append(((image * shape[1] + label) * rows + int(v)) * columns + int(u))
            at_v, at_u = np.mgrid[near_v, near_u]
            cells.append(((image * rows + at_v) * columns + at_u).ravel())
            box_px.append(np.broadcast_to(box, (bump.size, 4)))
            weights.append(bump.ravel() / bump.sum())
    return Targets(
        hot=torch.tensor(hot, dtype=torch.int64),
        cold=torch.from_numpy(cold),
        cells=torch.from_numpy(np.concatenate([np.zeros(0, dtype=np.int64), *cells])),
        box_px=torch.from_numpy(np.concatenate([np.zeros((0, 4), dtype=np.float32), *box_px])),
        weight=torch.from_numpy(np.concatenate([np.zeros(0, dtype=np.float32), *weights])),
    )


def _bump(box: Float32, u: int, v: int, rows: int, columns: int) -> tuple[Float32, slice, slice]:
    """A normal's bump around cell (u, v), cut at three standard deviations, and where it lies."""
    reach_u, reach_v = (
        max(0, int((high - low) / 2.0 / STRIDE * HOT_PART))
        for low, high in zip(box[:2], box[2:], strict=True)
    )
    near_u = slice(max(0, u - reach_u), min(columns, u + reach_u + 1))
    near_v = slice(max(0, v - reach_v), min(rows, v + reach_v + 1))
    across = (np.arange(near_u.start, near_u.stop) - u) / ((2 * reach_u + 1) / 6.0)
    down = (np.arange(near_v.start, near_v.stop) - v) / ((2 * reach_v + 1) / 6.0)
    bump = np.exp(-0.5 * (down[:, None] ** 2 + across[None, :] ** 2))
    return bump.astype(np.float32), near_v, near_u


class _ColdLoss(torch.autograd.Function):
    """The focal loss of cells that should be cold, sum of w p^2 log(1 + e^x) with p = sigmoid(x).

    Its gradient, w (2 p^2 (1 - p) log(1 + e^x) + p^3), is computed on the way: on a whole batch of heat maps
    every pass counts.
    """

    @staticmethod
    def forward(context: Any, logits: torch.Tensor, weight: torch.Tensor) -> torch.Tensor:
        p = torch.sigmoid(logits)
        cost = functional.softplus(logits)
        each = p.square().mul_(weight)
        total = torch.dot(each.flatten(), cost.flatten())
        # 2 (1 - p) cost + p, times w p^2
        cost.mul_(1.0 - p).mul_(2.0).add_(p).mul_(each)
        context.save_for_backward(cost)
        return total

    @staticmethod
    def backward(context: Any, gradient: torch.Tensor) -> tuple[torch.Tensor, None]:
        (slope,) = context.saved_tensors
        return slope * gradient, None


def detection_loss(
    logits: torch.Tensor, reach_px: torch.Tensor, wanted: Targets
) -> tuple[torch.Tensor, torch.Tensor]:
    """The loss of the heat maps (focal) and that of the boxes (generalised IoU), each for one object."""
    objects = max(1, len(wanted.hot))
    of_hot = logits.contiguous().flatten()[wanted.hot]
    hot_loss = (functional.softplus(-of_hot) * torch.sigmoid(-of_hot).square()).sum()
    heat_loss = (hot_loss + _ColdLoss.apply(logits.contiguous(), wanted.cold)) / objects
    columns, rows = reach_px.shape[3], reach_px.shape[2]
    reach = reach_px.permute(0, 2, 3, 1).reshape(-1, 4)[wanted.cells]
    u = (wanted.cells % columns + 0.5) * STRIDE
    v = (wanted.cells // columns % rows + 0.5) * STRIDE
    found = torch.stack([u - reach[:, 0], v - reach[:, 1], u + reach[:, 2], v + reach[:, 3]], dim=1)
    box_loss = ((1.0 - generalised_iou(found, wanted.box_px)) * wanted.weight).sum() / objects
    return heat_loss, BOX_WEIGHT * box_loss


def generalised_iou(first: torch.Tensor, second: torch.Tensor) -> torch.Tensor:
    """Of boxes [n, 4] with boxes [n, 4], in -1..1 (Rezatofighi et al., 2019)."""
    low = torch.maximum(first[:, :2], second[:, :2])
    high = torch.minimum(first[:, 2:], second[:, 2:])
    shared = (high - low).clamp(min=0.0).prod(dim=1)
    areas = (first[:, 2:] - first[:, :2]).prod(dim=1) + (second[:, 2:] - second[:, :2]).prod(dim=1)
    union = areas - shared
    low = torch.minimum(first[:, :2], second[:, :2])
    high = torch.maximum(first[:, 2:], second[:, 2:])
    around = (high - low).prod(dim=1).clamp(min=1e-6)
    return shared / union.clamp(min=1e-6) - (around - union) / around


def look_loss(embeddings: torch.Tensor, look: torch.Tensor, label: torch.Tensor) -> torch.Tensor:
    """Those of one look near each other, all others away (Khosla et al., "Supervised Contrastive Learning").

    Asked twice: among all, and among those of the same class, which are what a look has to be told from.
    embeddings: float [n, EMBEDDING] of unit length; look, label: int [n]. Every look is there at least twice.
    """
    itself = torch.eye(len(look), dtype=torch.bool)
    alike = (look[:, None] == look[None, :]) & ~itself
    total = torch.zeros(())
    for apart in (itself, itself | (label[:, None] != label[None, :])):
        likeness = (embeddings @ embeddings.T / TEMPERATURE).masked_fill(apart, -math.inf)
        log_p = likeness - likeness.logsumexp(dim=1, keepdim=True)
        total = total - (log_p.masked_fill(~alike, 0.0).sum(dim=1) / alike.sum(dim=1)).mean()
    return total
