"""Training lowers the loss, goes on where it stopped, and its processes add up to one larger batch."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from robustnav_msgs_py.errors import BadFileError, BadParameterError  # noqa: E402
from robustnav_nodes.detection.learned.gradient_workers import GradientWorkers, LossOfBatch  # noqa: E402
from robustnav_nodes.detection.learned.lessons import DetectionLoss, LookLoss  # noqa: E402
from robustnav_nodes.detection.learned.network import DetectorNetwork, LookNetwork, Widths  # noqa: E402
from robustnav_nodes.detection.learned.phase import Phase  # noqa: E402
from robustnav_nodes.detection.learned.training import TrainingPlan, train_detector  # noqa: E402
from robustnav_nodes.detection.learned.training_pictures import PictureSet  # noqa: E402
from robustnav_nodes.detection.learned.weights import Weights, load_weights  # noqa: E402

SMALL = Widths(channels=(8, 16, 16, 16), blocks=(0, 1, 1), neck=16, head=16)


@pytest.fixture(autouse=True)
def threads() -> Iterator[None]:
    before = torch.get_num_threads()
    yield
    torch.set_num_threads(before)


class Ticks:
    """A clock that goes on by one second each time it is looked at."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        self.now_s += 1.0
        return self.now_s


@dataclass(frozen=True)
class LineLoss:
    """How far a linear layer is from doubling its input."""

    def __call__(self, network: "torch.nn.Module") -> LossOfBatch:
        def loss(_batch: int, rng: np.random.Generator) -> "torch.Tensor":
            x = torch.from_numpy(rng.normal(size=(8, 1))).float()
            return (network(x) - 2.0 * x).square().mean()

        return loss


def phase(folder: Path, budget_s: float, purpose: str = "a line") -> Phase:
    torch.manual_seed(0)
    return Phase(
        torch.nn.Linear(1, 1),
        LineLoss(),
        workers=1,
        seed=3,
        budget_s=budget_s,
        checkpoint=folder / "line.checkpoint",
        purpose=purpose,
        clock=Ticks(),
    )


def test_the_loss_falls_and_the_curve_tells(tmp_path: Path) -> None:
    trained = phase(tmp_path, 600.0)
    trained.run()
    assert trained.steps >= 500
    assert trained.share == 1.0
    assert trained.curve[-1].loss < 0.7 * trained.curve[0].loss  # the rate moves a weight by 0.6 at most
    assert float(trained.network.weight) != float(trained.average.weight)


def test_a_stopped_training_goes_on_where_it_was(tmp_path: Path) -> None:
    class StoppedError(Exception):
        pass

    def stop(now: Phase) -> None:
        if now.steps == 300:
            raise StoppedError

    with pytest.raises(StoppedError):
        phase(tmp_path, 600.0).run(stop)
    again = phase(tmp_path, 600.0)
    assert 200 < again.steps < 300
    assert again.curve[-1].step <= again.steps
    again.run()
    assert again.share == 1.0
    assert again.steps >= 500


def test_a_finished_training_is_not_trained_further(tmp_path: Path) -> None:
    first = phase(tmp_path, 100.0)
    first.run()
    again = phase(tmp_path, 100.0)
    again.run()
    assert again.steps == first.steps


def test_a_damaged_checkpoint_is_refused(tmp_path: Path) -> None:
    (tmp_path / "line.checkpoint").write_bytes(b"no checkpoint")
    with pytest.raises(BadFileError, match="remove it to begin anew"):
        phase(tmp_path, 100.0)


def test_a_checkpoint_of_another_training_is_refused(tmp_path: Path) -> None:
    phase(tmp_path, 3.0).run()
    with pytest.raises(BadFileError, match="of another training .a line; asked for is a curve"):
        phase(tmp_path, 3.0, "a curve")


def test_a_training_may_be_given_more_minutes_but_not_another_seed(untrained: Weights) -> None:
    plan = TrainingPlan(minutes=1.0, seed=1, begin_with=untrained)
    assert str(plan) == str(replace(plan, minutes=2.0))
    assert str(plan) != str(replace(plan, seed=2))
    assert str(plan) != str(replace(plan, begin_with=None))
    assert str(plan) != str(replace(plan, networks=("look",), anew=True))


def test_an_earlier_training_is_not_overwritten_unasked(tmp_path: Path) -> None:
    (tmp_path / "training").mkdir()
    (tmp_path / "training" / "look.checkpoint").write_bytes(b"")
    with pytest.raises(BadParameterError, match="--resume"):
        train_detector(
            tmp_path / "weights.npz",
            TrainingPlan(minutes=1.0, seed=1),
            resume=False,
            report=lambda *_: None,
        )


def test_one_network_cannot_be_trained_without_the_other(tmp_path: Path) -> None:
    with pytest.raises(BadParameterError, match="detector network is not to be trained"):
        train_detector(
            tmp_path / "weights.npz",
            TrainingPlan(minutes=1.0, seed=1, networks=("look",)),
            resume=False,
            report=lambda *_: None,
        )


def test_weights_for_other_classes_are_no_beginning(tmp_path: Path, untrained: Weights) -> None:
    with pytest.raises(BadParameterError, match="other classes"):
        train_detector(
            tmp_path / "weights.npz",
            TrainingPlan(minutes=1.0, seed=1, begin_with=untrained),
            resume=False,
            report=lambda *_: None,
        )


@pytest.mark.slow
def test_only_the_network_that_is_asked_for_changes(tmp_path: Path) -> None:
    before, out = load_weights(), tmp_path / "weights.npz"
    train_detector(
        out,
        TrainingPlan(minutes=1.0, seed=1, homes=1, per_home=8, networks=("look",), begin_with=load_weights()),
        resume=False,
        report=lambda *_: None,
        clock=Ticks(),
    )
    after = load_weights(out)
    ours, theirs = before.detector.state_dict(), after.detector.state_dict()
    assert all(torch.equal(ours[name], theirs[name]) for name in ours)
    assert not torch.equal(before.look.out.weight, after.look.out.weight)


def test_two_processes_have_the_mean_gradient_of_their_batches(
    picture_folder: Path, pictures: PictureSet
) -> None:
    torch.manual_seed(0)
    network = DetectorNetwork(len(pictures.labels), SMALL)
    make_loss = DetectionLoss(pictures=picture_folder, seed=1)
    alone = make_loss(network)
    wanted = torch.zeros(())
    for batch in (0, 1):
        network.zero_grad()
        alone(batch, np.random.default_rng([5, batch])).backward()
        wanted = wanted + network.out.weight.grad / 2.0
    with GradientWorkers(network, make_loss, workers=2, seed=5) as workers:
        workers.step(0, half=False)
    assert torch.allclose(network.out.weight.grad, wanted, rtol=1e-3, atol=1e-4)


def test_both_networks_learn_from_a_few_pictures(picture_folder: Path, pictures: PictureSet) -> None:
    torch.manual_seed(0)
    detector = DetectorNetwork(len(pictures.labels), SMALL)
    for network, make_loss in (
        (detector, DetectionLoss(pictures=picture_folder, seed=1)),
        (LookNetwork(), LookLoss(pictures=picture_folder)),
    ):
        optimizer = torch.optim.AdamW(network.parameters(), lr=3e-3)
        loss = make_loss(network)
        losses = []
        for batch in range(8):
            optimizer.zero_grad()
            value = loss(batch, np.random.default_rng(batch))
            value.backward()
            optimizer.step()
            losses.append(float(value.detach()))
        assert np.isfinite(losses).all()
        assert np.mean(losses[-2:]) < np.mean(losses[:2])
