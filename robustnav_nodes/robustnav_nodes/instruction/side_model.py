"""How well "left" or "right" fits a viewpoint: log P(what is there | said) / P(what is there).

A small network tells viewpoints where a side was said from all others (density ratio by logistic regression).
Everything is seen from the side that was said: a turn towards it is positive, so that left and right are one
question and the mirror image of a walk is as good as the walk.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.direction_phrases import OUTERMOST, PHRASES, phrase_of
from robustnav_nodes.instruction.mentions import Mention
from robustnav_nodes.instruction.scene import FAR_M, TO_THE_END, Scene, way_ahead_m
from robustnav_nodes.instruction.thing_beside import nearest_views, outermost, thing_beside

# +1 where the side is the left one.
SIDES = {"left": 1.0, "leftmost": 1.0, "right": -1.0, "rightmost": -1.0}
_SOFT_RAD, _SOFT_M, _FADE_M = 0.8, 2.0, 3.0
FEATURES = 37
ODD = slice(0, 15)  # the columns of `side_features` that change their sign in the mirror
# The last of these: where the thing stands that is named beside the side, on arriving and on leaving, on
# which side of it the way goes by, to the next viewpoint and to the one after it, and which of several it is.
ARRIVING, LEAVING, WAY_BY_1, WAY_BY_2, RANK = range(ODD.stop - 5, ODD.stop)
_LIMIT = 4.0  # of the log evidence: nothing that is seen or missed decides alone
_UNITS = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class SideModel:
    """Weights of the network: `hidden` [FEATURES + 1, units], `out` [units + 1]."""

    hidden: Float64
    out: Float64

    def log_ratio(self, features: Float64) -> Float64:
        """float64 [n] of rows of `side_features`."""
        units = np.maximum(features @ self.hidden[:-1] + self.hidden[-1], 0.0)
        kept: Float64 = np.clip(units @ self.out[:-1] + self.out[-1], -_LIMIT, _LIMIT)
        return kept


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class WalkSides:
    """A walk as sides see it: `odd` [T, .] changes its sign in the mirror, `even` [T, .] does not; `way_rad`
    [T, 2] is the bearing of the next viewpoint and of the one after it, straight on where the walk ends.
    """

    odd: Float64
    even: Float64
    way_rad: Float64


def walk_sides(scene: Scene) -> WalkSides:
    """What is turned around each viewpoint, and where the way goes on from it."""
    count = len(scene)
    index = np.arange(count)
    turn = np.concatenate([[0.0, 0.0], scene.turn_rad, [0.0, 0.0]])
    soft = np.tanh(turn / _SOFT_RAD)
    around = np.stack([soft[2 + step : 2 + step + count] for step in (-2, -1, 0, 1, 2)], axis=1)
    with_next = np.tanh((turn[2:-2] + turn[3:-1]) / _SOFT_RAD)
    with_both = np.tanh((turn[1:-3] + turn[2:-2] + turn[3:-1]) / _SOFT_RAD)
    odd = [around, with_next[:, None], with_both[:, None]]
    even = [np.abs(around), index[:, None] == 0, index[:, None] == 1, index[:, None] >= count - 1]
    bearings = []
    for steps in (1, 2, TO_THE_END):
        ahead, aside = way_ahead_m(scene, steps)
        bearings.append(np.arctan2(aside, ahead))
        odd.append(np.tanh(aside / _SOFT_M)[:, None])
        even.append(np.tanh(ahead / _SOFT_M)[:, None])
    return WalkSides(
        odd=np.hstack(odd),
        even=np.hstack(even).astype(float),
        way_rad=np.column_stack(bearings[:2]),
    )


def side_features(
    walk: WalkSides, scene: Scene, tokens: Sequence[str], mentions: Sequence[Mention], m: int, sign: float
) -> Float64:
    """float64 [T, FEATURES] of mention `m` as if it said the left (`sign` 1) or the right (-1)."""
    count = len(scene)
    said = phrase_of(tokens, mentions[m])
    phrase = np.zeros((count, PHRASES))
    phrase[:, said] = 1.0
    odd = np.hstack([sign * walk.odd, np.zeros((count, 5))])
    near = np.zeros(count)
    name = thing_beside(scene, tokens, mentions, m)
    if name is not None:
        ranges, bearing = nearest_views(scene, name)
        near = np.where(ranges < FAR_M, np.exp(-ranges / _FADE_M), 0.0)
        odd[:, ARRIVING] = sign * near * np.sin(bearing)
        odd[:, LEAVING] = sign * near * np.sin(bearing - scene.turn_rad)
        odd[:, WAY_BY_1] = sign * near * np.sin(walk.way_rad[:, 0] - bearing)
        odd[:, WAY_BY_2] = sign * near * np.sin(walk.way_rad[:, 1] - bearing)
        if said == OUTERMOST:
            odd[:, RANK] = sign * outermost(scene, name)
    return np.hstack([odd, walk.even, phrase, near[:, None]])


def mirrored(rows: Float64) -> Float64:
    """Rows of `side_features` as if the other side had been said."""
    other = rows.copy()
    other[:, ODD] *= -1.0
    return other


def learn_sides(rows: Sequence[Float64], placed: Sequence[Float64], *, seed: int, epochs: int) -> SideModel:
    """Learn from the `rows` [T, FEATURES] of every side that was said, and where it was `placed` [T].

    They are told from both sides at all viewpoints of the same walks, all of which count alike. Where no side
    was said, nothing is known of them.
    """
    if not rows:
        return SideModel(hidden=np.zeros((FEATURES + 1, _UNITS)), out=np.zeros(_UNITS + 1))
    import torch

    from robustnav_nodes.instruction.small_network import teach

    torch.manual_seed(seed)
    network = torch.nn.Sequential(
        torch.nn.Linear(FEATURES, _UNITS), torch.nn.ReLU(), torch.nn.Linear(_UNITS, 1)
    )
    said = np.concatenate(rows)
    anywhere = np.concatenate([np.full(len(own), 0.5 / len(own)) for own in rows])
    x = torch.from_numpy(np.concatenate([said, said, mirrored(said)]).astype(np.float32))
    weight = torch.from_numpy(np.concatenate([*placed, anywhere, anywhere]).astype(np.float32))
    is_said = torch.zeros(len(x))
    is_said[: len(said)] = 1.0

    def loss_of(some: torch.Tensor) -> torch.Tensor:
        each = torch.nn.functional.binary_cross_entropy_with_logits(
            network(x[some])[:, 0], is_said[some], reduction="none"
        )
        return (weight[some] * each).sum() / weight[some].sum().clamp(min=1e-9)

    teach(network, loss_of, len(x), rate=5e-3, decay=0.01, batch=2048, epochs=epochs, seed=seed)
    first, first_bias, last, last_bias = (p.detach().double().numpy() for p in network.parameters())
    return SideModel(hidden=np.vstack([first.T, first_bias]), out=np.concatenate([last[0], last_bias]))
