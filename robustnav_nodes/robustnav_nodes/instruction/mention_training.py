"""How our model is learned from instructions and the walks they were written for.

Errors are put in anew for training (`injection`), besides those that the data hold. The place model and the
wording that describe a home are always learned without it, in folds over homes: trees that saw their rows on
homes known by heart would trust them too much.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.instruction.common_sense import CommonSense
from robustnav_nodes.instruction.concepts import KINDS
from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.injection import PROTOCOLS, Injector, Protocol
from robustnav_nodes.instruction.mention_data import (
    Errors,
    LearnedRows,
    Say,
    part_of,
    rows_of,
    scenes_of,
    training_episodes,
)
from robustnav_nodes.instruction.mention_features.columns import Knowledge
from robustnav_nodes.instruction.mention_features.replacements import replacements_of
from robustnav_nodes.instruction.mention_model import Scorer
from robustnav_nodes.instruction.mention_network import NetworkSettings
from robustnav_nodes.instruction.mentions import find_mentions
from robustnav_nodes.instruction.model_file import LearnedModel
from robustnav_nodes.instruction.place_model import SaidOnWalk, learn_places
from robustnav_nodes.instruction.scene import Scene
from robustnav_nodes.instruction.score_scale import UNSCALED, JudgedInstructions, learn_scale
from robustnav_nodes.instruction.surprise import learn_surprise
from robustnav_nodes.instruction.trees import Trees, trees_of
from robustnav_nodes.instruction.wording import learn_wording

_HOMES_TO_CALIBRATE = 12  # one in so many


@dataclass(frozen=True, slots=True, kw_only=True)
class TreeSettings:
    """How the trees grow; chosen on homes that were left out of training."""

    iterations: int = 300
    learning_rate: float = 0.07
    leaves: int = 31
    least_in_leaf: int = 60
    features_at_a_split: float = 0.3
    clean_share: float = 0.5  # of the mentions that are right, so many are learned from
    ensembles: int = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class MentionSettings:
    """How our model is learned."""

    trees: TreeSettings = field(default_factory=TreeSettings)
    network: NetworkSettings = field(default_factory=NetworkSettings)
    # matched errors are found in few instructions at a time
    draws: Mapping[Protocol, int] = field(default_factory=lambda: {"uniform": 1, "matched": 3})
    folds: int = 4


def learn_knowledge(
    instructions: Sequence[Instruction], scenes: dict[int, Scene], common_sense: CommonSense, seed: int
) -> Knowledge:
    """What clean instructions teach: the wording, and what is mentioned at which places."""
    numbers: dict[int, int] = {}
    said = [
        SaidOnWalk(
            walk=numbers.setdefault(id(one.trajectory), len(numbers)),
            tokens=one.tokens,
            mentions=find_mentions(one.tokens),
        )
        for one in instructions
    ]
    return Knowledge(
        places=learn_places([scenes[key] for key in numbers], said, seed=seed),
        wording=learn_wording((one.tokens for one in instructions), seed=seed),
        replacements=replacements_of(common_sense),
    )


def fold_of_groups(groups: Sequence[str], folds: int, seed: int) -> dict[str, int]:
    """A fold for each home, by chance; fold 0 is for the scale of scores, and small.

    Raises BadParameterError for fewer than two homes.
    """
    names = sorted(set(groups))
    if len(names) < 2:
        raise BadParameterError(
            f"there is only {len(names)} home to learn from; at least two are needed, so that what is "
            "learned in one can be tried in another"
        )
    order = np.random.default_rng(seed).permutation(len(names))
    calibrating = max(1, len(names) // _HOMES_TO_CALIBRATE)
    return {
        names[k]: 0 if place < calibrating else 1 + place % min(folds, len(names) - calibrating)
        for place, k in enumerate(order)
    }


def learn_trees(
    rows: LearnedRows, kind: str, settings: TreeSettings, *, blind: bool, seed: int
) -> tuple[Trees, ...]:
    """Ensembles for one kind of mention, each from other clean rows and other chances."""
    from sklearn.ensemble import HistGradientBoostingClassifier

    _require_both(rows.wrong[rows.kind == KINDS.index(kind)], f"{kind} words")
    found = []
    shift = math.log(settings.clean_share)  # only this share of the right ones was seen
    for number in range(settings.ensembles):
        rng = np.random.default_rng([seed, number])
        kept = (rows.kind == KINDS.index(kind)) & (
            (rows.wrong == 1) | (rng.uniform(size=len(rows.wrong)) < settings.clean_share)
        )
        x = rows.values[kept][:, : rows.blind] if blind else rows.values[kept]
        x[:, np.isnan(x).all(axis=0)] = 0.0  # scikit-learn cannot bin a column without a value
        classifier = HistGradientBoostingClassifier(
            max_iter=settings.iterations,
            learning_rate=settings.learning_rate,
            max_leaf_nodes=settings.leaves,
            min_samples_leaf=settings.least_in_leaf,
            l2_regularization=1.0,
            max_features=settings.features_at_a_split,
            early_stopping=False,
            random_state=seed + number,
        )
        trees = trees_of(classifier.fit(x, rows.wrong[kept]))
        found.append(replace(trees, base=trees.base + shift))
    return tuple(found)


def _require_both(wrong: NDArray[np.int64], what: str) -> None:
    """Raises BadParameterError where nothing of it is wrong, or all."""
    if len(np.unique(wrong)) < 2:
        raise BadParameterError(
            f"too few to learn from: of {len(wrong)} {what} {int(wrong.sum())} are wrong; "
            "right ones and wrong ones are needed"
        )


def learn_scorer(
    seen: LearnedRows, unseen: LearnedRows, settings: MentionSettings, *, blind: bool, seed: int, say: Say
) -> Scorer:
    """Trees and network from `seen`; what makes a probability of them from homes that these did not see."""
    from robustnav_nodes.instruction.mention_network_training import learn_network

    _require_both(unseen.label, "instructions, in the homes that are left out to calibrate,")
    word = "blind " if blind else ""
    trees = {}
    for kind in KINDS:
        trees[kind] = learn_trees(seen, kind, settings.trees, blind=blind, seed=seed)
        say(f"{word}trees for {kind} words are learned")
    network = learn_network(seen, settings.network, blind=blind, seed=seed)
    say(f"the {word}network is learned")
    scorer = Scorer(trees=trees, network=network, scale=UNSCALED, blind=blind)
    kinds = [KINDS[k] for k in unseen.kind]
    parts = [slice(*ends) for ends in pairwise(unseen.starts.tolist())]
    odds = [scorer.mention_odds(unseen.values[part], kinds[part], unseen.blind) for part in parts]
    scale = learn_scale(
        JudgedInstructions(
            odds=np.concatenate(odds),
            kind=unseen.kind,
            instruction=unseen.episode,
            error_type=unseen.error_type,
            label=unseen.label,
        )
    )
    shifts = ", ".join(f"{kind} {shift:+.2f}" for kind, shift in zip(KINDS, scale.shifts, strict=True))
    say(f"{word}doubts are shifted by kind: {shifts}")
    return replace(scorer, scale=scale)


def train_mentions(
    instructions: Sequence[Instruction],
    common_sense: CommonSense,
    settings: MentionSettings,
    *,
    seed: int,
    errors: Errors | None = None,
    protocols: Sequence[Protocol] = PROTOCOLS,
    say: Say,
) -> LearnedModel:
    """Learn our model from clean instructions of several homes; the same seed, the same model.

    Errors are put in anew; `errors`, in instructions of the same homes, come on top. Raises
    BadParameterError for a single home, and for errors in another one.
    """
    errors = errors or {}
    fold_of = fold_of_groups([one.group for one in instructions], settings.folds, seed)
    given = [one for episodes in errors.values() for one in episodes]
    for one in given:
        if one.group not in fold_of:
            raise BadParameterError(f"errors are given in {one.group!r}, of which there is no instruction")
    scenes = scenes_of((*instructions, *given))
    by_fold = {
        fold: learn_knowledge(
            [one for one in instructions if fold_of[one.group] != fold], scenes, common_sense, seed
        )
        for fold in sorted(set(fold_of.values()))
    }
    say(f"learned what is mentioned where, without each of {len(by_fold)} parts of the homes")

    def knowledge_of(home: str) -> Knowledge:
        return by_fold[fold_of[home]]

    scorers: dict[tuple[Protocol, bool], Scorer] = {}
    names: tuple[str, ...] = ()
    for protocol in protocols:
        injector = partial(_injector, protocol, common_sense, knowledge_of)
        episodes = list(training_episodes(instructions, injector, settings.draws[protocol], seed))
        episodes += errors.get(protocol, ())
        wrong = sum(one.label for one in episodes)
        say(f"{protocol}: {len(episodes)} episodes, {wrong} of them with errors")
        rows = rows_of(episodes, scenes, knowledge_of, say)
        names = rows.names
        calibrating = np.array([fold_of[one.group] == 0 for one in episodes])
        seen, unseen = part_of(rows, ~calibrating), part_of(rows, calibrating)
        for blind in (False, True):
            scorers[protocol, blind] = learn_scorer(seen, unseen, settings, blind=blind, seed=seed, say=say)
    return LearnedModel(
        knowledge=learn_knowledge(instructions, scenes, common_sense, seed),
        features=names,
        scorers=scorers,
        surprise=learn_surprise(one.tokens for one in instructions),
        card={
            "homes": len(fold_of),
            "instructions": len(instructions),
            "seed": seed,
            "protocols": list(protocols),
            "errors_given": {protocol: len(errors.get(protocol, ())) for protocol in protocols},
            "settings": asdict(settings),
        },
    )


def _injector(
    protocol: Protocol, common_sense: CommonSense, knowledge_of: Callable[[str], Knowledge], home: str
) -> Injector:
    """Matched by the wording of other homes: by its own, what stands there always fits best."""
    wording = knowledge_of(home).wording if protocol == "matched" else None
    return Injector(common_sense=common_sense, wording=wording)
