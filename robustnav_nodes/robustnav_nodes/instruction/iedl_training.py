"""How IEDL is trained: errors put in anew each epoch, early stopping on homes left out, checkpoints.

As in the thesis, the errors of training ignore which rooms adjoin and which objects share a room, and those
that the network is judged on do not.
"""

import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from pickle import UnpicklingError
from typing import TYPE_CHECKING, Any

import numpy as np
import torch
from numpy.typing import NDArray

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.instruction.common_sense import CommonSense, anything_goes
from robustnav_nodes.instruction.episodes import ERROR_TYPES, ErrorEpisode, Instruction
from robustnav_nodes.instruction.iedl import MAX_WORDS, Iedl, IedlShape, iedl_loss
from robustnav_nodes.instruction.iedl_model import (
    PADDING,
    IedlModel,
    batch_of_walks,
    learn_words,
    word_numbers,
)
from robustnav_nodes.instruction.injection import Injector, error_episodes
from robustnav_nodes.instruction.metrics import auc
from robustnav_nodes.instruction.panorama import PanoramicEncoder

if TYPE_CHECKING:
    from torch import Tensor

Say = Callable[[str], None]
_RATE, _WEIGHT_DECAY, _GRADIENT_MAX = 3e-4, 0.01, 1.0
_WARM_UP_STEPS = 50
_JUDGED_AT_MOST = 3000  # episodes after each epoch


@dataclass(frozen=True, slots=True, kw_only=True)
class IedlSettings:
    """Sizes and patience of a training; the thesis' width is 768.

    Epochs and patience end it, so that it ends alike on every machine, unless `minutes` are set and over.
    """

    width: int = 256
    layers: int = 4
    batch: int = 64
    epochs: int = 30
    patience: int = 4  # epochs without a better AUC, then it ends
    minutes: float | None = None  # of wall time; after so many no epoch begins


@dataclass(frozen=True, slots=True, kw_only=True)
class EpochFigures:
    """One point of the training's curves."""

    epoch: int
    loss: float
    auc: float
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class _Lesson:
    words: NDArray[np.int64]
    walk: int
    label: float
    wrong: tuple[int, ...]


class IedlTraining:
    """Learns from the homes of `lessons`, judged on those of `exam`; one thread.

    Takes up `checkpoint` where there is one, and then ends as if it had never been stopped. `data` is a
    digest of what is learned from. Raises BadFileError where the checkpoint is another training's,
    BadParameterError where no error can be put into the exam or the lessons.
    """

    def __init__(
        self,
        lessons: Sequence[Instruction],
        exam: Sequence[Instruction],
        common_sense: CommonSense,
        encoder: PanoramicEncoder,
        settings: IedlSettings,
        *,
        seed: int,
        data: str,
        checkpoint: Path,
    ) -> None:
        torch.manual_seed(seed)
        self._settings = settings
        self._seed = seed
        self._data = data
        self._checkpoint = checkpoint
        self._encoder = encoder
        self._words = learn_words(one.tokens for one in lessons)
        self._lessons = tuple(lessons)
        self._walks: dict[int, int] = {}
        self._encoded: list[NDArray[np.float32]] = []
        self._injector = Injector(common_sense=anything_goes())
        self._exam = self._lessons_of(_judged(exam, Injector(common_sense=common_sense), seed))
        if not self._exam or not self._put_in(0):
            raise BadParameterError(
                f"{len(lessons) + len(exam)} instructions are too few to learn IEDL from: no error can be "
                "put into those of some homes"
            )
        shape = IedlShape(
            words=2 + len(self._words), places=encoder.width, width=settings.width, layers=settings.layers
        )
        self._network = Iedl(shape)
        self._optimiser = torch.optim.AdamW(self._network.parameters(), lr=_RATE, weight_decay=_WEIGHT_DECAY)
        self._chance = torch.get_rng_state()  # what dropout draws from
        self._steps = 0
        self._best = {name: value.clone() for name, value in self._network.state_dict().items()}
        self.curve: list[EpochFigures] = []
        if checkpoint.exists():
            self._take_up()

    @property
    def is_over(self) -> bool:
        """No epoch left, no better for so long, or no time left."""
        best = max(range(len(self.curve)), key=lambda k: self.curve[k].auc, default=0)
        seconds = self.curve[-1].seconds if self.curve else 0.0
        return (
            len(self.curve) >= self._settings.epochs
            or len(self.curve) - 1 - best >= self._settings.patience
            or (self._settings.minutes is not None and seconds >= self._settings.minutes * 60.0)
        )

    def run(self, say: Say) -> IedlModel:
        """Train until it is over; the network of the best epoch."""
        with torch.random.fork_rng(devices=[]):
            torch.set_rng_state(self._chance)
            while not self.is_over:
                began_s = time.monotonic()
                before_s = self.curve[-1].seconds if self.curve else 0.0
                loss = self._epoch(len(self.curve))
                figures = EpochFigures(
                    epoch=len(self.curve) + 1,
                    loss=loss,
                    auc=self._judge(),
                    seconds=before_s + time.monotonic() - began_s,
                )
                if all(figures.auc > earlier.auc for earlier in self.curve):
                    self._best = {name: value.clone() for name, value in self._network.state_dict().items()}
                self.curve.append(figures)
                self._save()
                say(f"IEDL, epoch {figures.epoch}: loss {loss:.3f}, AUC on homes left out {figures.auc:.3f}")
        self._network.load_state_dict(self._best)
        return IedlModel(network=self._network.eval(), words=self._words, encoder=self._encoder)

    def _put_in(self, epoch: int) -> list[ErrorEpisode]:
        """The lessons of an epoch: each instruction with one type of error, another one each time."""
        episodes: list[ErrorEpisode] = []
        for k, error_type in enumerate(ERROR_TYPES):
            part = self._lessons[(k + epoch) % len(ERROR_TYPES) :: len(ERROR_TYPES)]
            episodes += error_episodes(part, error_type, self._injector, self._seed + 1 + epoch)
        return episodes

    def _epoch(self, number: int) -> float:
        lessons = self._lessons_of(self._put_in(number))
        order = np.random.default_rng([self._seed, number]).permutation(len(lessons))
        self._network.train()
        losses = []
        for start in range(0, len(order), self._settings.batch):
            batch = [lessons[k] for k in order[start : start + self._settings.batch]]
            losses.append(self._step(batch))
        return float(np.mean(losses)) if losses else 0.0

    def _step(self, batch: Sequence[_Lesson]) -> float:
        self._steps += 1
        for group in self._optimiser.param_groups:
            group["lr"] = _RATE * min(1.0, self._steps / _WARM_UP_STEPS)
        words, places, walked = self._inputs(batch)
        wrong = torch.zeros(words.shape)
        for row, lesson in enumerate(batch):
            wrong[row, [at for at in lesson.wrong if at < words.shape[1]]] = 1.0
        label = torch.tensor([lesson.label for lesson in batch])
        score, located = self._network(words, places, walked)
        loss = iedl_loss(score, located, label, wrong)
        self._optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self._network.parameters(), _GRADIENT_MAX)
        self._optimiser.step()
        return float(loss.detach())

    def _judge(self) -> float:
        """AUC over all types of errors together, on the homes left out."""
        self._network.eval()
        found: list[float] = []
        with torch.inference_mode():
            for start in range(0, len(self._exam), self._settings.batch):
                batch = self._exam[start : start + self._settings.batch]
                found += self._network(*self._inputs(batch))[0].tolist()
        value = auc(np.array(found), np.array([lesson.label for lesson in self._exam]))
        return 0.5 if value is None else value

    def _inputs(self, batch: Sequence[_Lesson]) -> "tuple[Tensor, Tensor, Tensor]":
        words = np.stack([lesson.words for lesson in batch])
        longest = max(1, int((words != PADDING).sum(axis=1).max()))
        places, walked = batch_of_walks([self._encoded[lesson.walk] for lesson in batch])
        return torch.from_numpy(words[:, :longest]), places, walked

    def _lessons_of(self, episodes: Sequence[ErrorEpisode]) -> list[_Lesson]:
        found = []
        for one in episodes:
            key = id(one.trajectory)
            if key not in self._walks:
                self._walks[key] = len(self._encoded)
                self._encoded.append(self._encoder.encode(one.trajectory))
            found.append(
                _Lesson(
                    words=word_numbers(self._words, one.tokens),
                    walk=self._walks[key],
                    label=float(one.label),
                    wrong=tuple(span.start for span in one.wrong if span.start < MAX_WORDS),
                )
            )
        return found

    def _facts(self) -> dict[str, Any]:
        return {
            "settings": asdict(self._settings) | {"minutes": None, "epochs": 0},  # may be prolonged
            "seed": self._seed,
            "data": self._data,
            "encoder": self._encoder.name,
            "words": self._words,
        }

    def _save(self) -> None:
        unfinished = self._checkpoint.with_name(self._checkpoint.name + ".part")
        state = {
            "facts": self._facts(),
            "network": self._network.state_dict(),
            "best": self._best,
            "optimiser": self._optimiser.state_dict(),
            "steps": self._steps,
            "chance": torch.get_rng_state(),
            "curve": [asdict(figures) for figures in self.curve],
        }
        torch.save(state, unfinished)
        unfinished.replace(self._checkpoint)

    def _take_up(self) -> None:
        try:
            state = torch.load(self._checkpoint, weights_only=True)
            if state["facts"] != self._facts():
                raise BadFileError(
                    f"{str(self._checkpoint)!r} is the checkpoint of another training (other data, encoder, "
                    "seed or sizes): remove it, or name another --out"
                )
            self._network.load_state_dict(state["network"])
            self._optimiser.load_state_dict(state["optimiser"])
            self._best, self._steps = state["best"], int(state["steps"])
            self.curve = [EpochFigures(**row) for row in state["curve"]]
            self._chance = state["chance"]
        except (OSError, EOFError, UnpicklingError, KeyError, RuntimeError, TypeError, ValueError) as error:
            raise BadFileError(
                f"the checkpoint {str(self._checkpoint)!r} cannot be taken up ({type(error).__name__}): "
                "remove it, and train from the start"
            ) from error


def _judged(exam: Sequence[Instruction], injector: Injector, seed: int) -> list[ErrorEpisode]:
    found = [
        episode for error_type in ERROR_TYPES for episode in error_episodes(exam, error_type, injector, seed)
    ]
    if len(found) <= _JUDGED_AT_MOST:
        return found
    pairs = np.random.default_rng(seed).permutation(len(found) // 2)[: _JUDGED_AT_MOST // 2]
    return [found[2 * pair + half] for pair in sorted(pairs) for half in (0, 1)]
