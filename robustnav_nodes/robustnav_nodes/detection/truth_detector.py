"""A detector for the simulated home: ground truth seen through dials, so that it misses and imagines."""

import math
from collections.abc import Mapping, Sequence
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import CameraModel, Float32, Pose2D, VisibleObjects
from robustnav_nodes.detection.boxes import Boxes
from robustnav_nodes.detection.dials import Dials

RIGHT_SCORES = (0.6, 1.0)
IMAGINED_SCORES = (0.5, 0.9)
IMAGINED_BOX_PART = (0.05, 0.15)  # side of a box imagined on nothing, as a part of the image's width


class _Draw(IntEnum):
    """What a chance is about; keeps the draws of one view apart."""

    MISSED = 0
    IMAGINED = 1


class TruthDetector:
    """Turns what a perfect observer sees into what an imperfect detector says.

    An error belongs to a view, not to an image: the draws depend on the seed, the object (or class) and the
    cell of the robot's pose, and on nothing else, so looking again from the same pose tells nothing new and a
    run does not depend on how fast images come.
    """

    def __init__(
        self,
        *,
        labels: Sequence[str],
        dials: Mapping[str, Dials],
        seed: int,
        view_spacing_m: float,
        view_headings: int,
    ) -> None:
        self._labels = tuple(labels)
        self._dials = [dials[label] for label in self._labels]
        self._seed = seed
        self._spacing_m = view_spacing_m
        self._headings = view_headings

    def detect(self, seen: VisibleObjects, robot: Pose2D, camera: CameraModel) -> Boxes:
        """Boxes for one image taken from `robot`; `seen` lists what is really there.

        An imagined object of a class is another object in view that is taken for it, or nothing at all
        where no other is in view.
        """
        view = self._view(robot)
        distances_m = np.linalg.norm(seen.position_m, axis=1)
        boxes: list[Float32] = []
        scores: list[float] = []
        labels: list[int] = []
        for index, label in enumerate(seen.label):
            dials = self._dials[label]
            chance = self._chance(_Draw.MISSED, int(seen.instance[index]), view)
            within = (
                distances_m[index] <= dials.range_max_m
                and seen.visible_fraction[index] >= dials.visible_fraction_min
            )
            if within and chance.random() < dials.recall:
                boxes.append(seen.box_px[index])
                scores.append(chance.uniform(*RIGHT_SCORES))
                labels.append(int(label))
        for label, dials in enumerate(self._dials):
            chance = self._chance(_Draw.IMAGINED, label, view)
            if chance.random() < dials.p_imagined:
                boxes.append(
                    self._imagined_box(seen, label, distances_m <= dials.range_max_m, camera, chance)
                )
                scores.append(chance.uniform(*IMAGINED_SCORES))
                labels.append(label)
        return Boxes(
            box_px=np.array(boxes, dtype=np.float32).reshape(-1, 4),
            score=np.array(scores, dtype=np.float32),
            label=np.array(labels, dtype=np.uint32),
        )

    def _imagined_box(
        self,
        seen: VisibleObjects,
        label: int,
        near: NDArray[np.bool_],
        camera: CameraModel,
        chance: np.random.Generator,
    ) -> Float32:
        others = np.flatnonzero((seen.label != label) & near)
        if len(others) > 0:
            return np.asarray(seen.box_px[chance.choice(others)], dtype=np.float32)
        side = camera.width * chance.uniform(*IMAGINED_BOX_PART)
        u = chance.uniform(0.0, camera.width - side)
        v = chance.uniform(0.0, camera.height - side)
        return np.array([u, v, u + side, v + side], dtype=np.float32)

    def _view(self, robot: Pose2D) -> tuple[int, int, int]:
        heading = round(robot.yaw_rad / math.tau * self._headings) % self._headings
        return round(robot.x_m / self._spacing_m), round(robot.y_m / self._spacing_m), heading

    def _chance(self, draw: _Draw, subject: int, view: tuple[int, int, int]) -> np.random.Generator:
        # SeedSequence takes no negative numbers; a cell's sign goes into the lowest bit
        cells = [2 * abs(cell) + (cell < 0) for cell in view]
        return np.random.default_rng([self._seed, int(draw), subject, *cells])
