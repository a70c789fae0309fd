"""Named columns of one value per mention, and what all of them are computed from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.alignment import place_mentions
from robustnav_nodes.instruction.concepts import CONCEPT_NUMBER, FIRST_OBJECT
from robustnav_nodes.instruction.mention_features.replacements import Replacements
from robustnav_nodes.instruction.mentions import Mention
from robustnav_nodes.instruction.place_model import PlaceModel, expected_at
from robustnav_nodes.instruction.scene import Scene
from robustnav_nodes.instruction.wording import Wording


@dataclass(frozen=True, slots=True, kw_only=True)
class Knowledge:
    """Learned from clean instructions: what is said where, how people write, what may be confused."""

    places: PlaceModel
    wording: Wording
    replacements: Replacements


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Told:
    """M mentions as they read: `numbers` int64 [M] of CONCEPTS, `fits` float64 [M, CONCEPTS] by `Wording`."""

    tokens: Sequence[str]
    mentions: Sequence[Mention]
    numbers: NDArray[np.int64]
    fits: Float64

    def __len__(self) -> int:
        return len(self.mentions)

    @property
    def sided(self) -> NDArray[np.bool_]:
        """bool [M]: which are directions."""
        return self.numbers < FIRST_OBJECT


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Walked:
    """The walk of T viewpoints as the mentions see it.

    `at_places` float64 [T, objects and rooms] is the evidence of every concept, `own` [M, T] that of each
    mention. `expected_at` [M] tells how far along the way it is to be expected by its place in the text,
    0..1; `placed` and `elsewhere` [M, T] where on the way it belongs, by all evidence and by that of the
    other mentions only: a wrong word cannot pull the place where it is looked up towards itself.
    """

    scene: Scene
    at_places: Float64
    own: Float64
    expected_at: Float64
    placed: Float64
    elsewhere: Float64

    @property
    def last(self) -> int:
        return len(self.scene) - 1

    @property
    def before(self) -> NDArray[np.int64]:
        """int64 [T]: the viewpoint before each."""
        return np.maximum(np.arange(len(self.scene)) - 1, 0)

    @property
    def after(self) -> NDArray[np.int64]:
        """int64 [T]: the viewpoint after each."""
        return np.minimum(np.arange(len(self.scene)) + 1, self.last)

    @property
    def by_text(self) -> NDArray[np.int64]:
        """int64 [M]: the viewpoint where it is to be expected by its place in the text."""
        return np.rint(self.expected_at * self.last).astype(np.int64)


def told(tokens: Sequence[str], mentions: Sequence[Mention], wording: Wording) -> Told:
    """Read an instruction."""
    return Told(
        tokens=tokens,
        mentions=mentions,
        numbers=np.array([CONCEPT_NUMBER[m.kind, m.concept] for m in mentions], dtype=np.int64),
        fits=wording.log_fits(tokens, mentions),
    )


def walked(scene: Scene, at_places: Float64, instruction: Told, places: PlaceModel) -> Walked:
    """Place its mentions on a walk; `at_places` is `places.evidence(scene)`."""
    own = places.of_mentions(scene, instruction.tokens, instruction.mentions, at_places)
    at = expected_at(instruction.tokens, instruction.mentions)
    placed, elsewhere = place_mentions(own, at)
    return Walked(
        scene=scene, at_places=at_places, own=own, expected_at=at, placed=placed, elsewhere=elsewhere
    )


class Columns:
    """Collects columns in their order."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self._values: list[Float64] = []

    def add(self, name: str, values: Float64) -> None:
        """`values` float64 [M]; NaN where the column says nothing of a mention."""
        self.names.append(name)
        self._values.append(values)

    def rows(self, count: int) -> NDArray[np.float32]:
        """float32 [count, columns]."""
        rows = np.empty((count, len(self.names)), dtype=np.float32)
        for k, values in enumerate(self._values):
            rows[:, k] = values
        return rows
