"""The thesis' IEDL: its loss, its training with checkpoints and early stopping, its file."""

import math
from pathlib import Path

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.common_sense import anything_goes
from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.panorama import SemanticEncoder
from robustnav_nodes.instruction.trajectory import Trajectory
from tests.instruction.small_world import said_walks

torch = pytest.importorskip("torch")

from robustnav_nodes.instruction.iedl import MAX_WORDS, Iedl, IedlShape, iedl_loss  # noqa: E402
from robustnav_nodes.instruction.iedl_model import (  # noqa: E402
    IedlModel,
    arrays_of_iedl,
    iedl_from_arrays,
    learn_words,
    word_numbers,
)
from robustnav_nodes.instruction.iedl_training import IedlSettings, IedlTraining  # noqa: E402

LESSONS = said_walks(homes=4, walks=6, seed=0)
EXAM = said_walks(homes=2, walks=4, seed=5)


def training(
    checkpoint: Path, *, seed: int = 1, epochs: int = 3, patience: int = 9, data: str = "small"
) -> IedlTraining:
    settings = IedlSettings(width=16, layers=1, batch=16, epochs=epochs, patience=patience)
    return IedlTraining(
        LESSONS,
        EXAM,
        anything_goes(),
        SemanticEncoder(),
        settings,
        seed=seed,
        data=data,
        checkpoint=checkpoint,
    )


def judged(model: IedlModel, said: Instruction) -> float:
    return model.judge(said.trajectory, said.tokens).error_score


def test_the_loss_of_one_episode_worked_by_hand() -> None:
    """-log sigmoid(2) for the score, and -log(e / (e + 2)) for the one wrong token of three."""
    loss = iedl_loss(
        torch.tensor([2.0]),
        torch.tensor([[1.0, 0.0, 0.0]]),
        torch.tensor([1.0]),
        torch.tensor([[1.0, 0.0, 0.0]]),
    )
    assert float(loss) == pytest.approx(math.log1p(math.exp(-2.0)) + math.log(1.0 + 2.0 / math.e))


def test_a_clean_instruction_has_no_loss_of_places() -> None:
    nothing = torch.zeros(1, 3)
    loss = iedl_loss(torch.tensor([-2.0]), nothing, torch.tensor([0.0]), nothing)
    assert float(loss) == pytest.approx(math.log1p(math.exp(-2.0)))


def test_padding_changes_nothing() -> None:
    """Neither words nor viewpoints that are only there for the batch's sake."""
    torch.manual_seed(0)
    network = Iedl(IedlShape(words=5, places=3, width=16, layers=2)).eval()
    words, places = torch.tensor([[2, 3, 4]]), torch.randn(1, 2, 3)
    walked = torch.ones(1, 2, dtype=torch.bool)
    longer = torch.cat([words, torch.zeros(1, 4, dtype=torch.long)], dim=1)
    farther = torch.cat([places, torch.randn(1, 3, 3)], dim=1)
    real = torch.tensor([[True, True, False, False, False]])
    score, located = network(words, places, walked)
    padded_score, padded_located = network(longer, farther, real)
    assert torch.allclose(score, padded_score, atol=1e-5)
    assert torch.allclose(located, padded_located[:, :3], atol=1e-5)
    assert float(torch.softmax(padded_located, dim=1)[:, 3:].detach().max()) < 1e-6


def test_words_are_numbered_cut_and_padded() -> None:
    words = learn_words([("go", "left")] * 3 + [("rare",)])
    assert words == {"go": 2, "left": 3}
    numbers = word_numbers(words, ("left", "rare", *["go"] * 100))
    assert len(numbers) == MAX_WORDS
    assert numbers[:3].tolist() == [3, 1, 2]
    assert word_numbers(words, ()).tolist() == [0] * MAX_WORDS


def test_it_learns(tmp_path: Path) -> None:
    run = training(tmp_path / "c", epochs=12)
    run.run(lambda _: None)
    assert run.curve[-1].loss < 0.95 * run.curve[0].loss


def test_a_training_that_was_stopped_ends_as_one_that_was_not(tmp_path: Path) -> None:
    whole = training(tmp_path / "whole", epochs=3).run(lambda _: None)
    training(tmp_path / "parts", epochs=1).run(lambda _: None)
    taken_up = training(tmp_path / "parts", epochs=3)
    assert len(taken_up.curve) == 1
    torch.rand(7)  # whatever was drawn in between
    again = taken_up.run(lambda _: None)
    assert len(taken_up.curve) == 3
    for name, weights in whole.network.state_dict().items():
        assert torch.equal(again.network.state_dict()[name], weights), name


def test_it_stops_when_it_gets_no_better(tmp_path: Path) -> None:
    run = training(tmp_path / "c", epochs=60, patience=1)
    run.run(lambda _: None)
    curve = [point.auc for point in run.curve]
    assert len(curve) < 60
    assert curve[-1] <= max(curve[:-1])


def test_another_trainings_checkpoint_is_refused(tmp_path: Path) -> None:
    training(tmp_path / "c", epochs=1).run(lambda _: None)
    with pytest.raises(BadFileError, match="of another training"):
        training(tmp_path / "c", seed=2)
    with pytest.raises(BadFileError, match="of another training"):
        training(tmp_path / "c", data="other walks, told alike")
    (tmp_path / "d").write_bytes(b"no checkpoint")
    with pytest.raises(BadFileError, match="cannot be taken up"):
        training(tmp_path / "d")


def test_saved_weights_judge_the_same(tmp_path: Path) -> None:
    model = training(tmp_path / "c", epochs=1).run(lambda _: None)
    arrays, shape = arrays_of_iedl(model)
    read = iedl_from_arrays(arrays, shape, SemanticEncoder())
    assert judged(read, EXAM[0]) == pytest.approx(judged(model, EXAM[0]), abs=0.01)
    del arrays["iedl/cls"]
    with pytest.raises(BadFileError, match="do not fit together"):
        iedl_from_arrays(arrays, shape, SemanticEncoder())
    with pytest.raises(BadFileError, match="train it anew"):
        iedl_from_arrays(arrays, {**shape, "places": 7}, SemanticEncoder())


@pytest.mark.parametrize("words", [0, 1, 80, 300])
@pytest.mark.parametrize("places", [0, 1, 200])
def test_any_length_is_judged(words: int, places: int) -> None:
    encoder = SemanticEncoder()
    network = Iedl(IedlShape(words=3, places=encoder.width, width=16, layers=1))
    walk = Trajectory(viewpoints=(EXAM[0].trajectory.viewpoints[0],) * places)
    verdict = IedlModel(network=network, words={"go": 2}, encoder=encoder).judge(walk, ("go",) * words)
    assert 0.0 < verdict.error_score < 1.0
    assert len(verdict.doubts) == min(words, MAX_WORDS)
    assert np.isfinite([score for _, score in verdict.doubts]).all()


def test_no_epoch_begins_when_the_time_is_over(tmp_path: Path) -> None:
    settings = IedlSettings(width=16, layers=1, batch=16, epochs=9, minutes=1e-6)
    run = IedlTraining(
        LESSONS,
        EXAM,
        anything_goes(),
        SemanticEncoder(),
        settings,
        seed=1,
        data="small",
        checkpoint=tmp_path / "c",
    )
    run.run(lambda _: None)
    assert len(run.curve) == 1
