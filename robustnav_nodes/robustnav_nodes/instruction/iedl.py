"""IEDL as the thesis builds it (4.1.3): a cross-modal transformer with one error score and one place.

Queries are the trajectory, with a [CLS] before it; keys and values the instruction, padded to 80 tokens.
Both heads read [CLS] alone. The score is high when the instruction is wrong: `error_score` (C9; the thesis
calls it alignment score).
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import torch
from torch import nn

if TYPE_CHECKING:
    from torch import Tensor

MAX_WORDS = 80


@dataclass(frozen=True, slots=True, kw_only=True)
class IedlShape:
    """Sizes of the network; the thesis has 4 layers of width 768."""

    words: int
    places: int  # width of the panoramic encoder's vectors
    width: int = 256
    layers: int = 4
    heads: int = 4
    dropout: float = 0.1


class Iedl(nn.Module):  # type: ignore[misc]
    """Error score and token logits from token numbers [B, W <= 80] and encoded viewpoints [B, T, places]."""

    def __init__(self, shape: IedlShape) -> None:
        super().__init__()
        self.shape = shape
        self.word = nn.Embedding(shape.words, shape.width, padding_idx=0)
        self.place = nn.Linear(shape.places, shape.width)
        self.cls = nn.Parameter(torch.randn(1, 1, shape.width) * 0.02)
        self.layers = nn.ModuleList(CrossModalLayer(shape) for _ in range(shape.layers))
        self.detect = _head(shape.width, 1)
        self.localise = _head(shape.width, MAX_WORDS)

    def forward(self, words: "Tensor", places: "Tensor", walked: "Tensor") -> "tuple[Tensor, Tensor]":
        """Logit of the error score [B] and of each token [B, W]; `walked` [B, T] marks real viewpoints."""
        padded = words == 0
        padded[:, 0] = False  # an instruction of no word is one of a padding token
        said = self.word(words) + _sinusoids(words.shape[1], self.shape.width)
        seen = self.place(places) + _sinusoids(places.shape[1], self.shape.width)
        seen = torch.cat([self.cls.expand(len(words), -1, -1), seen], dim=1)
        hidden = torch.cat([torch.zeros_like(walked[:, :1]), ~walked], dim=1)
        for layer in self.layers:
            seen = layer(seen, said, hidden, padded)
        top = seen[:, 0]
        return self.detect(top).squeeze(1), self.localise(top)[:, : words.shape[1]].masked_fill(padded, -1e4)


class CrossModalLayer(nn.Module):  # type: ignore[misc]
    """Cross-attention from the trajectory to the instruction, self-attention, feed-forward."""

    def __init__(self, shape: IedlShape) -> None:
        super().__init__()
        self.cross = nn.MultiheadAttention(shape.width, shape.heads, dropout=shape.dropout, batch_first=True)
        self.own = nn.MultiheadAttention(shape.width, shape.heads, dropout=shape.dropout, batch_first=True)
        self.forward_block = nn.Sequential(
            nn.Linear(shape.width, 4 * shape.width),
            nn.GELU(),
            nn.Dropout(shape.dropout),
            nn.Linear(4 * shape.width, shape.width),
        )
        self.norms = nn.ModuleList(nn.LayerNorm(shape.width) for _ in range(3))
        self.dropout = nn.Dropout(shape.dropout)

    def forward(self, seen: "Tensor", said: "Tensor", hidden: "Tensor", padded: "Tensor") -> "Tensor":
        looked, _ = self.cross(seen, said, said, key_padding_mask=padded, need_weights=False)
        seen = self.norms[0](seen + self.dropout(looked))
        looked, _ = self.own(seen, seen, seen, key_padding_mask=hidden, need_weights=False)
        seen = self.norms[1](seen + self.dropout(looked))
        return self.norms[2](seen + self.dropout(self.forward_block(seen)))


def iedl_loss(score: "Tensor", places: "Tensor", label: "Tensor", wrong: "Tensor") -> "Tensor":
    """Binary cross-entropy, and cross-entropy summed over the E wrong tokens, by E (both weights 1).

    `wrong` [B, W] holds 1 where a wrong span begins; clean instructions have none and only the first term.
    """
    detection = nn.functional.binary_cross_entropy_with_logits(score, label)
    errors = wrong.sum(dim=1)
    per_error = -(wrong * torch.log_softmax(places, dim=1)).sum(dim=1) / errors.clamp(min=1.0)
    return detection + (per_error * (errors > 0)).sum() / (errors > 0).sum().clamp(min=1)


def _head(width: int, out: int) -> nn.Sequential:
    return nn.Sequential(nn.Linear(width, width), nn.ReLU(), nn.LayerNorm(width), nn.Linear(width, out))


def _sinusoids(length: int, width: int) -> "Tensor":
    at = torch.arange(length).unsqueeze(1)
    rate = torch.exp(torch.arange(0, width, 2) * (-9.2103 / width))
    table = torch.zeros(length, width)
    table[:, 0::2] = torch.sin(at * rate)
    table[:, 1::2] = torch.cos(at * rate)
    return table
