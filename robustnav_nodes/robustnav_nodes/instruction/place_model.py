"""What people mention at a place that looks like this one: log P(concept | place) / P(concept).

Rooms and objects: a small network over the room evidence here, before and after, the objects in sight and the
climb. Left and right: `side_model`. Up and down: counts of climbs. It looks at each viewpoint alone; where on
the way a mention belongs is `alignment`'s business.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.alignment import place_mentions
from robustnav_nodes.instruction.concepts import CONCEPT_NUMBER, CONCEPTS, DIRECTION, FIRST_OBJECT
from robustnav_nodes.instruction.mentions import Mention
from robustnav_nodes.instruction.scene import Scene
from robustnav_nodes.instruction.side_model import SIDES, SideModel, learn_sides, side_features, walk_sides

CLIMB_EDGES_M = np.array([-1.5, -0.7, -0.25, -0.08, 0.08, 0.25, 0.7, 1.5])
_NEAR_M = 2.3
_FADE_M = 2.0
_EPOCHS = ((10, 2), (10, 2), (60, 6))  # of the networks for things and for sides, by round
# In the middle the walk is ahead of the text: at x of the text, x + _AHEAD x (1 - x) of the way. Fitted to
# texts whose parts are known to speak of parts of the walk: 0.32 of people's words, 0.45 of generated ones.
_AHEAD = 0.35
_LIMIT = 4.0  # of one mention's log evidence: nothing that is seen or missed decides alone

UP, DOWN = (CONCEPT_NUMBER[DIRECTION, word] for word in ("up", "down"))


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaceModel:
    """Weights of the network, the concepts' overall shares, the sides, and the table of the climbs."""

    mean: Float64
    scale: Float64
    hidden: Float64  # [features + 1, units]
    out: Float64  # [units + 1, objects and rooms]
    log_share: Float64
    sides: SideModel
    climbs: Float64  # [bins], of "up"

    def evidence(self, scene: Scene) -> Float64:
        """float64 [T, objects and rooms]: log ratio of each concept at each viewpoint."""
        x = (place_features(scene) - self.mean) / self.scale
        units = np.maximum(x @ self.hidden[:-1] + self.hidden[-1], 0.0)
        logits = units @ self.out[:-1] + self.out[-1]
        logits -= logits.max(axis=1, keepdims=True)
        logs = logits - np.log(np.exp(logits).sum(axis=1, keepdims=True)) - self.log_share
        kept: Float64 = np.clip(logs, -_LIMIT, _LIMIT)
        return kept

    def of_mentions(
        self,
        scene: Scene,
        tokens: Sequence[str],
        mentions: Sequence[Mention],
        at_places: Float64,
        *,
        opposite: bool = False,
    ) -> Float64:
        """float64 [M, T]: log evidence of each mention at each viewpoint; `at_places` is `evidence`'s.

        `opposite`: as if each side and each way up or down were its opposite.
        """
        found = np.zeros((len(mentions), len(scene)))
        climb_bins = climb_bins_of(scene)
        walk = walk_sides(scene)
        turned = -1.0 if opposite else 1.0
        for m, mention in enumerate(mentions):
            number = CONCEPT_NUMBER[mention.kind, mention.concept]
            if number >= FIRST_OBJECT:
                found[m] = at_places[:, number - FIRST_OBJECT]
            elif mention.concept in SIDES:
                sign = turned * SIDES[mention.concept]
                found[m] = self.sides.log_ratio(side_features(walk, scene, tokens, mentions, m, sign))
            elif number in (UP, DOWN):
                found[m] = (self.climbs if (number == UP) != opposite else self.climbs[::-1])[climb_bins]
        return found


def place_features(scene: Scene) -> Float64:
    """float64 [T, features]."""
    places = len(scene)
    before = np.maximum(np.arange(places) - 1, 0)
    after = np.minimum(np.arange(places) + 1, places - 1)
    along = np.arange(places) / max(1, places - 1)
    z = scene.xyz_m[:, 2]
    return np.column_stack(
        [
            scene.rooms,
            scene.rooms[before],
            scene.rooms[after],
            np.exp(-scene.range_m / _FADE_M),
            scene.range_m < _NEAR_M,
            along,
            along == 0.0,
            along == 1.0,
            np.abs(z[after] - z),
            np.abs(z - z[before]),
            np.abs(scene.turn_rad),
            np.hypot(*(scene.xyz_m[after] - scene.xyz_m)[:, :2].T),
        ]
    ).astype(float)


def climb_bins_of(scene: Scene) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """The bin of the climb around each viewpoint."""
    z = scene.xyz_m[:, 2]
    places = np.arange(len(scene))
    climb = z[np.minimum(places + 1, len(scene) - 1)] - z[np.maximum(places - 1, 0)]
    return np.searchsorted(CLIMB_EDGES_M, climb)


@dataclass(frozen=True, slots=True, kw_only=True)
class SaidOnWalk:
    """A clean instruction as the place model learns from it; `walk` is the number of its scene."""

    walk: int
    tokens: tuple[str, ...]
    mentions: tuple[Mention, ...]


def expected_at(tokens: Sequence[str], mentions: Sequence[Mention]) -> Float64:
    """How far along the walk, 0..1, each mention is to be expected by where it stands in the text alone."""
    last = max(1, len(tokens) - 1)
    at = np.array([(m.start + (m.length - 1) / 2.0) / last for m in mentions], dtype=float)
    return at + _AHEAD * at * (1.0 - at)


def learn_places(scenes: Sequence[Scene], said: Sequence[SaidOnWalk], *, seed: int) -> PlaceModel:
    """Expectation and maximisation: place the mentions, learn what is said there, place them anew.

    Only the networks of the last round have to be good ones.
    """
    features = [place_features(scene) for scene in scenes]
    first = np.concatenate([[0], np.cumsum([len(scene) for scene in scenes])])
    rows = np.concatenate(features)
    mean, scale = rows.mean(axis=0), rows.std(axis=0) + 0.05
    x = (rows - mean) / scale
    climb_bins = [climb_bins_of(scene) for scene in scenes]
    side_rows = _side_rows(scenes, said)
    model: PlaceModel | None = None
    concepts = len(CONCEPTS) - FIRST_OBJECT
    for number, (epochs, side_epochs) in enumerate(_EPOCHS):
        counts = np.zeros((len(rows), concepts))
        placed_sides: list[Float64] = []
        climbs = np.full(len(CLIMB_EDGES_M) + 1, 2.0)
        evidence = [model.evidence(scene) for scene in scenes] if model is not None else None
        for one in said:
            scene = scenes[one.walk]
            shape = (len(one.mentions), len(scene))
            log_e = (
                model.of_mentions(scene, one.tokens, one.mentions, evidence[one.walk])
                if model is not None and evidence is not None
                else np.zeros(shape)
            )
            placed, _ = place_mentions(log_e, expected_at(one.tokens, one.mentions))
            for m, mention in enumerate(one.mentions):
                concept = CONCEPT_NUMBER[mention.kind, mention.concept]
                if concept >= FIRST_OBJECT:
                    counts[first[one.walk] : first[one.walk + 1], concept - FIRST_OBJECT] += placed[m]
                elif mention.concept in SIDES:
                    placed_sides.append(placed[m])
                elif concept in (UP, DOWN):
                    bins = climb_bins[one.walk]
                    np.add.at(climbs, bins if concept == UP else len(CLIMB_EDGES_M) - bins, placed[m])
        hidden, out = _fit_network(x, counts, seed + number, epochs)
        share = counts.sum(axis=0) + 1.0
        model = PlaceModel(
            mean=mean,
            scale=scale,
            hidden=hidden,
            out=out,
            log_share=np.log(share / share.sum()),
            sides=learn_sides(side_rows, placed_sides, seed=seed + number, epochs=side_epochs),
            climbs=_log_ratio(climbs, np.bincount(np.concatenate(climb_bins), minlength=len(climbs))),
        )
    assert model is not None
    return model


def _side_rows(scenes: Sequence[Scene], said: Sequence[SaidOnWalk]) -> list[Float64]:
    """The rows of every side that was said, [T, features] each, in the order in which they are said."""
    walks = [walk_sides(scene) for scene in scenes]
    return [
        side_features(walks[one.walk], scenes[one.walk], one.tokens, one.mentions, m, SIDES[mention.concept])
        for one in said
        for m, mention in enumerate(one.mentions)
        if mention.concept in SIDES
    ]


def _log_ratio(counts: Float64, everywhere: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Float64:
    """log P(bin | said) / P(bin), the latter as often to the left as to the right."""
    both = everywhere + everywhere[::-1] + 2.0
    ratio = (counts / counts.sum(axis=-1, keepdims=True)) / (both / both.sum())
    kept: Float64 = np.clip(np.log(ratio), -_LIMIT, _LIMIT)
    return kept


def _fit_network(x: Float64, counts: Float64, seed: int, epochs: int) -> tuple[Float64, Float64]:
    import torch

    from robustnav_nodes.instruction.small_network import teach

    torch.manual_seed(seed)
    units = 96
    network = torch.nn.Sequential(
        torch.nn.Dropout(0.1),
        torch.nn.Linear(x.shape[1], units),
        torch.nn.ReLU(),
        torch.nn.Dropout(0.3),
        torch.nn.Linear(units, counts.shape[1]),
    )
    inputs = torch.from_numpy(x.astype(np.float32))
    targets = torch.from_numpy(counts.astype(np.float32))

    def loss_of(some: torch.Tensor) -> torch.Tensor:
        logs = torch.log_softmax(network(inputs[some]), dim=1)
        return -(targets[some] * logs).sum() / targets[some].sum().clamp(min=1.0)

    teach(network, loss_of, len(x), rate=3e-3, decay=0.02, batch=512, epochs=epochs, seed=seed)
    weights = [parameter.detach().double().numpy() for parameter in network.parameters()]
    return (np.vstack([weights[0].T, weights[1]]), np.vstack([weights[2].T, weights[3]]))
