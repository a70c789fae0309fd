"""One network's training: steps until its time is over, with checkpoints to take it up again."""

import copy
import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import nn

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.detection.learned.gradient_workers import GradientWorkers, MakeLoss

Clock = Callable[[], float]

PEAK_RATE, LAST_RATE, WEIGHT_DECAY = 2e-3, 1e-5, 0.03
WARM_UP_STEPS = 200
GRADIENT_MAX = 30.0
# The average of the weights forgets with this time, at the end; at first it is quicker.
AVERAGE_STEPS = 1000.0
CHECKPOINT_EVERY_S = 60.0
CURVE_EVERY = 20
TIMED_STEPS = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class CurvePoint:
    """Where the training stood: steps made, seconds trained, and the mean loss since the point before."""

    step: int
    seconds: float
    loss: float


class Phase:
    """Trains `network` for `budget_s` seconds of `clock` on what `make_loss` draws.

    The learning rate follows the share of the time that is over: a slower machine makes fewer steps, but
    comes to the end.
    """

    def __init__(
        self,
        network: nn.Module,
        make_loss: MakeLoss,
        *,
        workers: int,
        seed: int,
        budget_s: float,
        checkpoint: Path,
        purpose: str,
        peak_rate: float = PEAK_RATE,
        clock: Clock = time.monotonic,
    ) -> None:
        """Take up `checkpoint` where there is one.

        Raises BadFileError where it cannot be read, and where it was made for another `purpose`.
        """
        self.network = network
        self.average = copy.deepcopy(network)
        self.curve: list[CurvePoint] = []
        self.seconds = 0.0
        self.steps = 0
        self._make_loss = make_loss
        self._workers = workers
        self._seed = seed
        self._budget_s = budget_s
        self._checkpoint = checkpoint
        self._purpose = purpose
        self._peak_rate = peak_rate
        self._clock = clock
        self._optimizer = torch.optim.AdamW(network.parameters(), lr=peak_rate, weight_decay=WEIGHT_DECAY)
        if checkpoint.exists():
            self._take_up()

    @property
    def share(self) -> float:
        """How much of the time is over, 0..1."""
        return min(1.0, self.seconds / self._budget_s)

    def run(self, advanced: Callable[["Phase"], None] = lambda _: None) -> None:
        """Step until the time is over; `advanced` is called with this phase after each step."""
        self.network.train()
        if self.share < 1.0:
            with GradientWorkers(
                self.network, self._make_loss, workers=self._workers, seed=self._seed
            ) as workers:
                self._train(workers, advanced)
        self.average.eval()

    def _train(self, workers: GradientWorkers, advanced: Callable[["Phase"], None]) -> None:
        half = _is_half_precision_faster(workers, self._clock)
        began_s, saved_s = self._clock() - self.seconds, self.seconds
        losses = []
        while self.share < 1.0:
            losses.append(self._step(workers, half=half))
            self.seconds = self._clock() - began_s
            if self.steps % CURVE_EVERY == 0:
                mean = float(np.mean(losses))
                self.curve.append(CurvePoint(step=self.steps, seconds=self.seconds, loss=mean))
                losses.clear()
            if self.seconds - saved_s > CHECKPOINT_EVERY_S:
                self._save()
                saved_s = self.seconds
            advanced(self)
        self._save()

    def _step(self, workers: GradientWorkers, *, half: bool) -> float:
        last_rate = LAST_RATE / PEAK_RATE * self._peak_rate
        rate = last_rate + (self._peak_rate - last_rate) * (1.0 + math.cos(math.pi * self.share)) / 2.0
        for group in self._optimizer.param_groups:
            group["lr"] = rate * min(1.0, (self.steps + 1) / WARM_UP_STEPS)
        loss = workers.step(self.steps, half=half)
        nn.utils.clip_grad_norm_(self.network.parameters(), GRADIENT_MAX)
        self._optimizer.step()
        self.steps += 1
        kept = 1.0 - 1.0 / min(AVERAGE_STEPS, 1.0 + self.steps / 2.0)
        with torch.no_grad():
            own = self.network.state_dict()
            for name, value in self.average.state_dict().items():
                if value.is_floating_point():
                    value.lerp_(own[name], 1.0 - kept)
                else:
                    value.copy_(own[name])
        return loss

    def _save(self) -> None:
        state = {
            "purpose": self._purpose,
            "network": self.network.state_dict(),
            "average": self.average.state_dict(),
            "optimizer": self._optimizer.state_dict(),
            "seconds": self.seconds,
            "steps": self.steps,
            "curve": [(point.step, point.seconds, point.loss) for point in self.curve],
        }
        fresh = self._checkpoint.with_suffix(".new")
        torch.save(state, fresh)
        fresh.replace(self._checkpoint)

    def _take_up(self) -> None:
        try:
            state = torch.load(self._checkpoint, weights_only=True)
            purpose = str(state["purpose"])
            self.network.load_state_dict(state["network"])
            self.average.load_state_dict(state["average"])
            self._optimizer.load_state_dict(state["optimizer"])
            self.seconds, self.steps = float(state["seconds"]), int(state["steps"])
            self.curve = [
                CurvePoint(step=step, seconds=seconds, loss=loss) for step, seconds, loss in state["curve"]
            ]
        except Exception as error:  # torch raises whatever the damage leads to
            raise BadFileError(
                f"the checkpoint {str(self._checkpoint)!r} cannot be taken up ({error}); "
                "remove it to begin anew"
            ) from error
        if purpose != self._purpose:
            raise BadFileError(
                f"the checkpoint {str(self._checkpoint)!r} is of another training ({purpose}; asked for is "
                f"{self._purpose}); take it up with the same options, or remove it to begin anew"
            )


def _is_half_precision_faster(workers: GradientWorkers, clock: Clock) -> bool:
    taken_s = {}
    for half in (False, True):
        workers.step(0, half=half)
        began_s = clock()
        for step in range(TIMED_STEPS):
            workers.step(step, half=half)
        taken_s[half] = clock() - began_s
    return taken_s[True] < taken_s[False]
