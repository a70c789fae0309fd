"""Teaches a small network: shuffled batches, AdamW, one cycle of the learning rate."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import torch

_SORTED_TOGETHER = 16  # batches


def teach(
    network: "torch.nn.Module",
    loss_of: "Callable[[torch.Tensor], torch.Tensor]",
    rows: int,
    *,
    rate: float,
    decay: float,
    batch: int,
    epochs: int,
    seed: int,
    lengths: NDArray[np.int64] | None = None,
) -> None:
    """Lower `loss_of`, which maps numbers of some of the `rows` rows to their loss; the seed orders them.

    Rows that are padded to the longest of their batch have `lengths` [rows]; like ones come together.
    """
    import torch

    optimiser = torch.optim.AdamW(network.parameters(), lr=rate, weight_decay=decay)
    steps = epochs * -(-rows // batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, max_lr=rate, total_steps=steps)
    order = torch.Generator().manual_seed(seed)
    network.train()
    for _ in range(epochs):
        for some in batches(rows, batch, lengths, order):
            loss = loss_of(some)
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()


def batches(
    rows: int, batch: int, lengths: NDArray[np.int64] | None, order: "torch.Generator"
) -> "list[torch.Tensor]":
    """Numbers of all rows, in batches of at most `batch`, in an order that `order` draws."""
    import torch

    shuffled = torch.randperm(rows, generator=order)
    if lengths is None:
        return list(shuffled.split(batch))
    length = torch.from_numpy(lengths)
    found = [
        some
        for together in shuffled.split(_SORTED_TOGETHER * batch)
        for some in together[torch.argsort(length[together], stable=True)].split(batch)
    ]
    return [found[k] for k in torch.randperm(len(found), generator=order)]
