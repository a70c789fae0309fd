"""What a detector says of one image, before anything is placed in space."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float32


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Boxes:
    """Boxes in an image; n may be 0.

    box_px: float32 [n, 4] as u_min, v_min, u_max, v_max; score: float32 [n] in 0..1; label: uint32 [n].
    """

    box_px: Float32
    score: Float32
    label: NDArray[np.uint32]

    def __len__(self) -> int:
        return len(self.score)

    def __getitem__(self, kept: NDArray[np.bool_] | NDArray[np.int64]) -> "Boxes":
        """Those that a mask [n] is true for, or those of these numbers, in their order."""
        return Boxes(box_px=self.box_px[kept], score=self.score[kept], label=self.label[kept])

    def above(self, score_min: float) -> "Boxes":
        """Those with at least this score."""
        return self[self.score >= score_min]
