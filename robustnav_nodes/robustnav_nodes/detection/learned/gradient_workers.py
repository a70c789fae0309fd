"""Processes that share the work of a training step: each takes its own batch, on one core.

Threads that share each single convolution wait for the slowest at every one; processes wait once a step.
"""

import copy
from collections.abc import Callable
from multiprocessing.connection import Connection
from types import TracebackType

import numpy as np
import torch
from torch import multiprocessing, nn

# The loss of one batch; what is random in it comes from the generator.
LossOfBatch = Callable[[int, np.random.Generator], torch.Tensor]
# Makes the loss for a network; it travels to the processes, so it must be picklable.
MakeLoss = Callable[[nn.Module], LossOfBatch]


class GradientWorkers:
    """Computes mean gradients of several batches at once. Close it when done.

    The parameters of `network` move to shared memory: what an optimizer does to them all processes see. The
    statistics of normalisation are those of this process' own batches.
    """

    def __init__(self, network: nn.Module, make_loss: MakeLoss, *, workers: int, seed: int) -> None:
        """This process is one of the `workers`."""
        self._network = network.share_memory()
        self._seed = seed
        self._workers = workers
        self._loss = make_loss(network)
        size = sum(parameter.numel() for parameter in network.parameters())
        self._gradients = torch.zeros(workers - 1, size).share_memory_()
        self._others: list[tuple[Connection, multiprocessing.Process]] = []
        context = multiprocessing.get_context("spawn")
        torch.set_num_threads(1)
        for number in range(1, workers):
            ours, theirs = context.Pipe()
            process = context.Process(
                target=_work,
                args=(theirs, self._network, make_loss, self._gradients[number - 1], number, workers, seed),
                daemon=True,
            )
            process.start()
            theirs.close()
            self._others.append((ours, process))

    def step(self, step: int, *, half: bool) -> float:
        """Leave the mean gradients in the network's parameters; gives the mean loss.

        Raises EOFError where a process has died.
        """
        for ours, _ in self._others:
            ours.send((step, half))
        losses = [_backward(self._network, self._loss, step * self._workers, self._seed, half=half)]
        losses += [float(ours.recv()) for ours, _ in self._others]
        others = self._gradients.sum(dim=0)
        at = 0
        for parameter in self._network.parameters():
            count = parameter.numel()
            if parameter.grad is not None:
                parameter.grad.add_(others[at : at + count].view_as(parameter)).div_(self._workers)
            at += count
        return float(np.mean(losses))

    def close(self) -> None:
        """End the processes; a second call does nothing."""
        for ours, process in self._others:
            ours.close()
            process.join()
        self._others = []

    def __enter__(self) -> "GradientWorkers":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _work(
    theirs: Connection,
    shared: nn.Module,
    make_loss: MakeLoss,
    gradients: torch.Tensor,
    number: int,
    workers: int,
    seed: int,
) -> None:
    torch.set_num_threads(1)
    network = copy.deepcopy(shared)
    network.train()
    for own, theirs_too in zip(network.parameters(), shared.parameters(), strict=True):
        own.data = theirs_too.data
    loss = make_loss(network)
    while True:
        try:
            step, half = theirs.recv()
        except EOFError:  # the training is over
            return
        told = _backward(network, loss, step * workers + number, seed, half=half)
        at = 0
        for parameter in network.parameters():
            count = parameter.numel()
            if parameter.grad is not None:
                gradients[at : at + count].view_as(parameter).copy_(parameter.grad)
            at += count
        theirs.send(told)


def _backward(network: nn.Module, loss: LossOfBatch, batch: int, seed: int, *, half: bool) -> float:
    for parameter in network.parameters():
        parameter.grad = None
    # bfloat16 is twice as fast where the processor has it; elsewhere it is slower than float32.
    with torch.autocast("cpu", dtype=torch.bfloat16, enabled=half):
        value = loss(batch, np.random.default_rng([seed, batch]))
    value.backward()
    return float(value.detach())
