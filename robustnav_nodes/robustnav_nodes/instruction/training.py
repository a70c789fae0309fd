"""The whole training of the models of instruction errors: ours, its blind twins, and the thesis' IEDL.

What is done is kept beside the file to write, so that a training that was stopped can be taken up again:
ours in NAME.mentions.npz, IEDL epoch by epoch in NAME.iedl.
"""

import hashlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.instruction.common_sense import CommonSense
from robustnav_nodes.instruction.episodes import ErrorEpisode, Instruction
from robustnav_nodes.instruction.mention_data import Errors, Say
from robustnav_nodes.instruction.mention_training import MentionSettings, fold_of_groups, train_mentions
from robustnav_nodes.instruction.model_file import LearnedModel, load_model, save_model
from robustnav_nodes.instruction.panorama import PanoramicEncoder, SemanticEncoder

if TYPE_CHECKING:
    from robustnav_nodes.instruction.iedl_training import EpochFigures, IedlSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class TrainingPlan:
    """What to train; `data` names where the instructions come from, for the model's card."""

    data: str
    seed: int = 1
    ours: MentionSettings = field(default_factory=MentionSettings)
    iedl: "IedlSettings | None" = None  # None: not IEDL


def train_models(
    instructions: Sequence[Instruction],
    common_sense: CommonSense,
    plan: TrainingPlan,
    out: Path,
    *,
    resume: bool,
    say: Say,
    errors: Errors | None = None,
    encoder: PanoramicEncoder | None = None,
) -> "tuple[LearnedModel, list[EpochFigures]]":
    """Train, and write `out`; the model and IEDL's curve. IEDL sees by `encoder` (None: the semantic one).

    Ours learns from `errors` too, those that the data hold.

    Raises BadParameterError where there is nothing to learn from, BadFileError where a file cannot be written
    or what is to be taken up belongs to another training.
    """
    if not instructions:
        raise BadParameterError("there is no instruction to learn from")
    digest = digest_of(instructions, common_sense, errors or {})
    kept, checkpoint = out.with_name(f"{out.stem}.mentions.npz"), out.with_name(f"{out.stem}.iedl")
    if not resume:
        kept.unlink(missing_ok=True)
        checkpoint.unlink(missing_ok=True)
    if kept.exists():
        model = _taken_up(kept, plan, digest)
        say(f"took up {kept}")
    else:
        model = train_mentions(instructions, common_sense, plan.ours, seed=plan.seed, errors=errors, say=say)
        model = replace(model, card={**model.card, "data": plan.data, "digest": digest})
        save_model(kept, model)
    curve: list[EpochFigures] = []
    if plan.iedl is not None:
        model, curve = _with_iedl(
            model, instructions, common_sense, encoder or SemanticEncoder(), plan.iedl, checkpoint, say
        )
    save_model(out, model)
    kept.unlink(missing_ok=True)
    checkpoint.unlink(missing_ok=True)
    return model, curve


def digest_of(instructions: Sequence[Instruction], common_sense: CommonSense, errors: Errors) -> str:
    """SHA-256 of all that is learned from: words, walks, errors, and what may be confused."""
    found = hashlib.sha256()
    walks: dict[int, bytes] = {}

    def add(one: Instruction | ErrorEpisode, *more: object) -> None:
        key = id(one.trajectory)
        if key not in walks:
            walks[key] = hashlib.sha256(repr(one.trajectory).encode()).digest()
        found.update(repr((one.key, one.group, one.tokens, *more)).encode() + walks[key])

    for one in instructions:
        add(one)
    for protocol, episodes in sorted(errors.items()):
        for episode in episodes:
            add(episode, protocol, episode.wrong)
    for likely in (common_sense.rooms, common_sense.objects):
        found.update(repr(sorted((name, tuple(others)) for name, others in likely.items())).encode())
    return found.hexdigest()


def _taken_up(kept: Path, plan: TrainingPlan, digest: str) -> LearnedModel:
    model = load_model(kept)
    wanted = {
        "data": plan.data,
        "seed": plan.seed,
        "digest": digest,
        "settings": asdict(plan.ours),
    }
    for name, value in wanted.items():
        if model.card.get(name) != value:
            raise BadFileError(
                f"{str(kept)!r} was trained with {name} = {model.card.get(name)!r}, not {value!r}: remove "
                "it, or name another --out"
            )
    return model


def _with_iedl(
    model: LearnedModel,
    instructions: Sequence[Instruction],
    common_sense: CommonSense,
    encoder: PanoramicEncoder,
    settings: "IedlSettings",
    checkpoint: Path,
    say: Say,
) -> "tuple[LearnedModel, list[EpochFigures]]":
    from robustnav_nodes.instruction.iedl_model import arrays_of_iedl
    from robustnav_nodes.instruction.iedl_training import IedlTraining

    seed: int = model.card["seed"]
    fold_of = fold_of_groups([one.group for one in instructions], folds=1, seed=seed)
    training = IedlTraining(
        [one for one in instructions if fold_of[one.group] != 0],
        [one for one in instructions if fold_of[one.group] == 0],
        common_sense,
        encoder,
        settings,
        seed=seed,
        data=model.card["digest"],
        checkpoint=checkpoint,
    )
    arrays, shape = arrays_of_iedl(training.run(say))
    card = {**model.card, "iedl": {**asdict(settings), "epochs_trained": len(training.curve)}}
    learned = replace(model, iedl_arrays=arrays, iedl_shape=shape, iedl_encoder=encoder.name, card=card)
    return learned, training.curve
