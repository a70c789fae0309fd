"""The two networks: one finds objects in an image, the other turns a box into an embedding of its look."""

from dataclasses import dataclass

import torch
from torch import nn
from torch.nn import functional

from robustnav_nodes.detection.learned.extents import EXTENTS

# One cell of the detector's output for so many pixels along each axis, and what sides it needs multiples of.
STRIDE, MULTIPLE = 4, 16
# A box whose sides are all exp(0) reaches this far from its cell's middle.
BOX_UNIT_PX, MAX_LOG_SIDE = 8.0, 4.0
# The bias that makes every class improbable before anything is learned.
P_BEFORE_LEARNING = 0.01
EMBEDDING = 64
PATCH_PX = 48
# The look network's last features lie on a grid of so many cells; of each, so many numbers are kept.
LAYOUT_CELLS, LAYOUT_CHANNELS = (PATCH_PX // 8) ** 2, 12


@dataclass(frozen=True, slots=True, kw_only=True)
class Widths:
    """Channels at strides 2, 4, 8 and 16, residual blocks at 4, 8 and 16, and channels of the head."""

    channels: tuple[int, int, int, int] = (16, 32, 64, 128)
    blocks: tuple[int, int, int] = (1, 2, 3)
    neck: int = 32
    head: int = 64


class DetectorNetwork(nn.Module):
    """Images to heat maps of the classes and boxes: centre-based (Zhou et al., "Objects as Points", 2019).

    It works on a quarter of the image's resolution, for objects of a few pixels; what is around an object
    comes from an eighth and a sixteenth.
    """

    def __init__(self, classes: int, widths: Widths) -> None:
        super().__init__()
        half, quarter, eighth, sixteenth = widths.channels
        self.classes = classes
        self.to_half = _convolution(3, half, stride=2)
        self.to_quarter = _stage(half, quarter, widths.blocks[0])
        self.to_eighth = _stage(quarter, eighth, widths.blocks[1])
        self.to_sixteenth = _stage(eighth, sixteenth, widths.blocks[2])
        self.up_to_eighth = nn.Conv2d(sixteenth, eighth, 1)
        self.at_eighth = _convolution(eighth, eighth)
        self.up_to_quarter = nn.Conv2d(eighth, widths.neck, 1)
        self.across_quarter = nn.Conv2d(quarter, widths.neck, 1)
        self.head = _convolution(widths.neck, widths.head)
        self.out = nn.Conv2d(widths.head, classes + 4, 1)
        with torch.no_grad():
            p = torch.tensor(P_BEFORE_LEARNING)
            self.out.bias[:classes] = torch.log(p / (1.0 - p))
            self.out.bias[classes:] = 0.0

    def forward(self, images: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Logits [n, classes, rows, columns] and how far boxes reach [n, 4, rows, columns] in px.

        images: float [n, 3, height, width] in 0..1, sides multiples of MULTIPLE. A box reaches left, up,
        right and down from the middle of its cell.
        """
        quarter = self.to_quarter(self.to_half(images - 0.5))
        eighth = self.to_eighth(quarter)
        above = self.up_to_eighth(self.to_sixteenth(eighth))
        eighth = self.at_eighth(eighth + _doubled(above))
        features = self.across_quarter(quarter) + _doubled(self.up_to_quarter(eighth))
        out = self.out(self.head(features)).float()
        reach = torch.exp(out[:, self.classes :].clamp(max=MAX_LOG_SIDE)) * BOX_UNIT_PX
        return out[:, : self.classes], reach


class LookNetwork(nn.Module):
    """Pieces of images, PATCH_PX on a side, to unit vectors: near each other where the looks are alike.

    How large what they show is goes in, too (`extents`): a small mug looks like a large one afar. Boxes are
    seldom exact, so it also keeps, in `layout`, what is where in the piece: there the object ends.
    """

    def __init__(self) -> None:
        super().__init__()
        self.features = nn.Sequential(
            _convolution(3, 24, stride=2),
            _convolution(24, 48, stride=2),
            _Residual(48),
            _convolution(48, 96, stride=2),
            _Residual(96),
            _convolution(96, 128),
        )
        self.layout = nn.Sequential(
            nn.Conv2d(128, LAYOUT_CHANNELS, 1),
            nn.ReLU(),
            nn.Flatten(),
            nn.Linear(LAYOUT_CHANNELS * LAYOUT_CELLS, 64),
            nn.ReLU(),
        )
        self.size = nn.Sequential(nn.Linear(EXTENTS, 32), nn.ReLU())
        self.both = nn.Sequential(nn.Linear(256 + 64 + 32, 192), nn.ReLU())
        self.out = nn.Linear(192, EMBEDDING)

    def forward(self, patches: torch.Tensor, extents: torch.Tensor) -> torch.Tensor:
        """float [n, 3, PATCH_PX, PATCH_PX] in 0..1 and [n, EXTENTS] to float [n, EMBEDDING]."""
        features = self.features(patches - 0.5)
        seen = [
            features.mean(dim=(2, 3)),
            features.amax(dim=(2, 3)),
            self.layout(features),
            self.size(extents),
        ]
        return functional.normalize(self.out(self.both(torch.cat(seen, dim=1))).float(), dim=1)


class _Residual(nn.Module):
    def __init__(self, channels: int) -> None:
        super().__init__()
        self.first = _convolution(channels, channels)
        self.second = nn.Sequential(
            nn.Conv2d(channels, channels, 3, padding=1, bias=False), nn.BatchNorm2d(channels)
        )

    def forward(self, features: torch.Tensor) -> torch.Tensor:
        return functional.relu(features + self.second(self.first(features)))


def _convolution(before: int, after: int, stride: int = 1) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(before, after, 3, stride=stride, padding=1, bias=False),
        nn.BatchNorm2d(after),
        nn.ReLU(inplace=True),
    )


def _stage(before: int, after: int, blocks: int) -> nn.Sequential:
    return nn.Sequential(_convolution(before, after, stride=2), *(_Residual(after) for _ in range(blocks)))


def _doubled(features: torch.Tensor) -> torch.Tensor:
    return functional.interpolate(features, scale_factor=2.0, mode="nearest")
