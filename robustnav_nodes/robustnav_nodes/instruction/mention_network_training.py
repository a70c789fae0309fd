"""How the transformer over mentions is learned."""

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from robustnav_nodes.instruction.mention_data import LearnedRows
from robustnav_nodes.instruction.mention_network import (
    HEADS,
    LAYERS,
    MentionNetwork,
    NetworkSettings,
    row_scale,
)
from robustnav_nodes.instruction.small_network import teach

_SCALE_ROWS = 150_000  # so many tell the scale of all


class Network(nn.Module):  # type: ignore[misc, unused-ignore]
    """Numbers float [B, M, K], categories int64 [B, M, C] and `absent` bool [B, M] to log odds [B, M]."""

    def __init__(self, numbers: int, tables: list[int], settings: NetworkSettings) -> None:
        super().__init__()
        width = settings.width
        self.numbers = nn.Linear(numbers, width)
        self.tables = nn.ModuleList(nn.Embedding(size, width) for size in tables)
        for table in self.tables:
            nn.init.normal_(table.weight, std=0.1)
        self.dropout = nn.Dropout(settings.dropout)
        layer = nn.TransformerEncoderLayer(
            width, HEADS, 2 * width, settings.dropout, batch_first=True, norm_first=True
        )
        self.layers = nn.TransformerEncoder(layer, LAYERS, enable_nested_tensor=False)
        self.norm = nn.LayerNorm(width)
        self.inner = nn.Linear(width, width)
        self.out = nn.Linear(width, 1)
        nn.init.normal_(self.out.weight, std=0.02)

    def forward(self, numbers: Tensor, categories: Tensor, absent: Tensor) -> Tensor:
        x = self.numbers(numbers)
        for k, table in enumerate(self.tables):
            x = x + table(categories[..., k])
        x = self.layers(self.dropout(x), src_key_padding_mask=absent)
        x = self.dropout(torch.relu(self.inner(self.norm(x))))
        odds: Tensor = self.out(x).squeeze(-1)
        return odds


def learn_network(rows: LearnedRows, settings: NetworkSettings, *, blind: bool, seed: int) -> MentionNetwork:
    """Learn which mentions are wrong; a blind one from the columns that need no look at the walk."""
    features = rows.blind if blind else len(rows.names)
    some = np.random.default_rng(seed).permutation(len(rows.values))[:_SCALE_ROWS]
    scale = row_scale(rows.values[some, :features], rows.names[:features])
    tables = (rows.values[:, scale.categories].max(axis=0).astype(int) + 2).tolist()
    torch.manual_seed(seed)
    network = Network(len(scale.numbers) + len(scale.missing), tables, settings)
    starts = rows.starts
    told = np.flatnonzero(np.diff(starts))  # instructions that mention anything
    wrong = rows.wrong.astype(np.float32)

    def loss_of(batch: Tensor) -> Tensor:
        at, absent = padded(starts, told[batch.numpy()])
        numbers, categories = scale.inputs(rows.values[at, :features])
        odds = network(torch.from_numpy(numbers), torch.from_numpy(categories), torch.from_numpy(absent))
        kept = torch.from_numpy(~absent)
        return nn.functional.binary_cross_entropy_with_logits(odds[kept], torch.from_numpy(wrong[at])[kept])

    teach(
        network,
        loss_of,
        len(told),
        rate=settings.learning_rate,
        decay=settings.weight_decay,
        batch=settings.batch,
        epochs=settings.epochs,
        seed=seed,
        lengths=np.diff(starts)[told],
    )
    weights = {name: value.detach().numpy().copy() for name, value in network.state_dict().items()}
    for k, column in enumerate(scale.categories):
        # what was never seen says nothing: its row is 0, and so is one for all beyond the table
        table = weights[f"tables.{k}.weight"]
        table[np.setdiff1d(np.arange(len(table)), rows.values[:, column].astype(int) + 1)] = 0.0
        weights[f"tables.{k}.weight"] = np.concatenate([table, np.zeros((1, settings.width), np.float32)])
    return MentionNetwork(scale=scale, weights=weights)


def padded(
    starts: NDArray[np.int64], episodes: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """The rows of some episodes, int64 [B, M], and where there is none (row 0 stands there), bool [B, M]."""
    lengths = starts[episodes + 1] - starts[episodes]
    place = np.arange(lengths.max())
    absent = place >= lengths[:, None]
    return np.where(absent, 0, starts[episodes][:, None] + place), absent
