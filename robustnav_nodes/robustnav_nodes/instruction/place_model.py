"""What people mention at a place that looks like this one: log P(concept | place) / P(concept).

Rooms and objects: a small network over the room evidence here, before and after, the objects in sight and the
climb. Left, right, up, down: counts of turns and climbs. It looks at each viewpoint alone; where on the way a
mention belongs is `alignment`'s business.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.alignment import place_mentions
from robustnav_nodes.instruction.concepts import CONCEPT_NUMBER, CONCEPTS, DIRECTION, FIRST_OBJECT
from robustnav_nodes.instruction.direction_phrases import PHRASES, phrase_of
from robustnav_nodes.instruction.mentions import Mention
from robustnav_nodes.instruction.scene import Scene

TURN_EDGES = np.radians([-135.0, -100.0, -70.0, -45.0, -25.0, -10.0, 10.0, 25.0, 45.0, 70.0, 100.0, 135.0])
CLIMB_EDGES_M = np.array([-1.5, -0.7, -0.25, -0.08, 0.08, 0.25, 0.7, 1.5])
_NEAR_M = 2.3
_FADE_M = 2.0
_LIMIT = 4.0  # of one mention's log evidence: nothing that is seen or missed decides alone

LEFT, RIGHT = (CONCEPT_NUMBER[DIRECTION, word] for word in ("left", "right"))
UP, DOWN = (CONCEPT_NUMBER[DIRECTION, word] for word in ("up", "down"))


@dataclass(frozen=True, slots=True, kw_only=True)
class PlaceModel:
    """Weights of the network, the concepts' overall shares, and both tables of log ratios."""

    mean: Float64
    scale: Float64
    hidden: Float64  # [features + 1, units]
    out: Float64  # [units + 1, objects and rooms]
    log_share: Float64
    turns: Float64  # [phrases, bins], of "left"; of "right" it is the mirror image
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
        self, scene: Scene, tokens: Sequence[str], mentions: Sequence[Mention], at_places: Float64
    ) -> Float64:
        """float64 [M, T]: log evidence of each mention at each viewpoint; `at_places` is `evidence`'s."""
        found = np.zeros((len(mentions), len(scene)))
        turn_bins, climb_bins = turn_bins_of(scene), climb_bins_of(scene)
        for m, mention in enumerate(mentions):
            number = CONCEPT_NUMBER[mention.kind, mention.concept]
            if number >= FIRST_OBJECT:
                found[m] = at_places[:, number - FIRST_OBJECT]
            elif number in (LEFT, RIGHT):
                table = self.turns[phrase_of(tokens, mention)]
                found[m] = (table if number == LEFT else table[::-1])[turn_bins]
            elif number in (UP, DOWN):
                found[m] = (self.climbs if number == UP else self.climbs[::-1])[climb_bins]
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


def turn_bins_of(scene: Scene) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """The bin of the turn at each viewpoint; mirrored bins are counted from the other end."""
    return np.searchsorted(TURN_EDGES, scene.turn_rad)


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


def said_at(tokens: Sequence[str], mentions: Sequence[Mention]) -> Float64:
    """Where in the text each mention stands, 0..1."""
    last = max(1, len(tokens) - 1)
    return np.array([(m.start + (m.length - 1) / 2.0) / last for m in mentions], dtype=float)


def learn_places(
    scenes: Sequence[Scene], said: Sequence[SaidOnWalk], *, seed: int, epochs: Sequence[int] = (10, 10, 60)
) -> PlaceModel:
    """Expectation and maximisation: place the mentions, learn what is said there, place them anew.

    `epochs` has one number for each round: only the last network has to be a good one.
    """
    features = [place_features(scene) for scene in scenes]
    first = np.concatenate([[0], np.cumsum([len(scene) for scene in scenes])])
    rows = np.concatenate(features)
    mean, scale = rows.mean(axis=0), rows.std(axis=0) + 0.05
    x = (rows - mean) / scale
    turn_bins = [turn_bins_of(scene) for scene in scenes]
    climb_bins = [climb_bins_of(scene) for scene in scenes]
    model: PlaceModel | None = None
    concepts = len(CONCEPTS) - FIRST_OBJECT
    for number, epochs_of_round in enumerate(epochs):
        counts = np.zeros((len(rows), concepts))
        turns = np.full((PHRASES, len(TURN_EDGES) + 1), 2.0)
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
            placed, _ = place_mentions(log_e, said_at(one.tokens, one.mentions))
            for m, mention in enumerate(one.mentions):
                concept = CONCEPT_NUMBER[mention.kind, mention.concept]
                if concept >= FIRST_OBJECT:
                    counts[first[one.walk] : first[one.walk + 1], concept - FIRST_OBJECT] += placed[m]
                elif concept in (LEFT, RIGHT):
                    bins = turn_bins[one.walk]
                    mirrored = bins if concept == LEFT else len(TURN_EDGES) - bins
                    np.add.at(turns[phrase_of(one.tokens, mention)], mirrored, placed[m])
                elif concept in (UP, DOWN):
                    bins = climb_bins[one.walk]
                    np.add.at(climbs, bins if concept == UP else len(CLIMB_EDGES_M) - bins, placed[m])
        hidden, out = _fit_network(x, counts, seed + number, epochs_of_round)
        share = counts.sum(axis=0) + 1.0
        model = PlaceModel(
            mean=mean,
            scale=scale,
            hidden=hidden,
            out=out,
            log_share=np.log(share / share.sum()),
            turns=_log_ratio(turns, np.bincount(np.concatenate(turn_bins), minlength=turns.shape[1])),
            climbs=_log_ratio(climbs, np.bincount(np.concatenate(climb_bins), minlength=len(climbs))),
        )
    assert model is not None
    return model


def _log_ratio(counts: Float64, everywhere: np.ndarray[tuple[int], np.dtype[np.int64]]) -> Float64:
    """log P(bin | said) / P(bin), the latter as often to the left as to the right."""
    both = everywhere + everywhere[::-1] + 2.0
    ratio = (counts / counts.sum(axis=-1, keepdims=True)) / (both / both.sum())
    kept: Float64 = np.clip(np.log(ratio), -_LIMIT, _LIMIT)
    return kept


def _fit_network(x: Float64, counts: Float64, seed: int, epochs: int) -> tuple[Float64, Float64]:
    import torch

    torch.manual_seed(seed)
    units = 96
    network = torch.nn.Sequential(
        torch.nn.Dropout(0.1),
        torch.nn.Linear(x.shape[1], units),
        torch.nn.ReLU(),
        torch.nn.Dropout(0.3),
        torch.nn.Linear(units, counts.shape[1]),
    )
    optimiser = torch.optim.AdamW(network.parameters(), lr=3e-3, weight_decay=0.02)
    inputs = torch.from_numpy(x.astype(np.float32))
    targets = torch.from_numpy(counts.astype(np.float32))
    batch = 512
    steps = epochs * -(-len(x) // batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, max_lr=3e-3, total_steps=steps)
    order = torch.Generator().manual_seed(seed)
    network.train()
    for _ in range(epochs):
        shuffled = torch.randperm(len(x), generator=order)
        for start in range(0, len(x), batch):
            rows = shuffled[start : start + batch]
            logs = torch.log_softmax(network(inputs[rows]), dim=1)
            loss = -(targets[rows] * logs).sum() / targets[rows].sum().clamp(min=1.0)
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
    weights = [parameter.detach().double().numpy() for parameter in network.parameters()]
    return (np.vstack([weights[0].T, weights[1]]), np.vstack([weights[2].T, weights[3]]))
