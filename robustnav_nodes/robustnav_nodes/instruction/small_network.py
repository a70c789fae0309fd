"""Teaches a small network: shuffled batches, AdamW, one cycle of the learning rate."""

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import torch


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
) -> None:
    """Lower `loss_of`, which maps numbers of some of the `rows` rows to their loss; the seed orders them."""
    import torch

    optimiser = torch.optim.AdamW(network.parameters(), lr=rate, weight_decay=decay)
    steps = epochs * -(-rows // batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, max_lr=rate, total_steps=steps)
    order = torch.Generator().manual_seed(seed)
    network.train()
    for _ in range(epochs):
        shuffled = torch.randperm(rows, generator=order)
        for start in range(0, rows, batch):
            loss = loss_of(shuffled[start : start + batch])
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
