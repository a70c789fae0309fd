"""What IEDL sees of a viewpoint: an encoder turns each into a vector (thesis 4.1.3).

The thesis' encoder looks at pictures (CLIP ViT-B/16); ours at what a detector says, which any robot has.
Another one need only be a `PanoramicEncoder`.
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from robustnav_nodes.instruction.scene import FAR_M, scene_of
from robustnav_nodes.instruction.trajectory import Trajectory

SEMANTIC = "semantic"  # the name of the encoder that needs nothing but a detector


class PanoramicEncoder(Protocol):
    """Turns the viewpoints of a trajectory into vectors, without learning anything."""

    @property
    def name(self) -> str:
        """Written into the files of what was trained with it: equal names, equal vectors."""

    @property
    def width(self) -> int:
        """Length of the vectors."""

    def encode(self, trajectory: Trajectory) -> NDArray[np.float32]:
        """Float32 [T, width], T >= 1; a trajectory without viewpoints gives one row."""


class SemanticEncoder:
    """Room evidence, nearness and bearing of the nearest object of each concept, turn and climb."""

    def __init__(self) -> None:
        self._width: int = self.encode(Trajectory()).shape[1]

    @property
    def name(self) -> str:
        return SEMANTIC

    @property
    def width(self) -> int:
        return self._width

    def encode(self, trajectory: Trajectory) -> NDArray[np.float32]:
        scene = scene_of(trajectory)
        seen = scene.range_m < FAR_M
        near = np.where(seen, np.exp(-scene.range_m / 3.0), 0.0)
        known = seen & ~np.isnan(scene.bearing_rad)
        bearing = np.where(known, scene.bearing_rad, 0.0)
        climb = np.diff(scene.xyz_m[:, 2], append=scene.xyz_m[-1, 2])
        step = np.linalg.norm(np.diff(scene.xyz_m[:, :2], axis=0, append=scene.xyz_m[-1:, :2]), axis=1)
        return np.column_stack(
            [
                scene.rooms,
                near,
                near * known * np.sin(bearing),
                near * known * np.cos(bearing),
                np.sin(scene.turn_rad),
                np.cos(scene.turn_rad),
                climb,
                step / 3.0,
            ]
        ).astype(np.float32)
