"""The whole training: taken up it ends as if it had not been stopped, and what is too little is said."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.cli import app
from robustnav_nodes.instruction.common_sense import anything_goes
from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.injection import Injector, error_episodes
from robustnav_nodes.instruction.tokens import tokenized
from tests.instruction.small_world import said_walks

pytest.importorskip("torch")
pytest.importorskip("sklearn")

from robustnav_nodes.instruction.iedl_training import IedlSettings
from robustnav_nodes.instruction.mention_data import training_episodes
from robustnav_nodes.instruction.mention_network import NetworkSettings
from robustnav_nodes.instruction.mention_training import MentionSettings, TreeSettings
from robustnav_nodes.instruction.model_file import load_model
from robustnav_nodes.instruction.training import TrainingPlan, digest_of, train_models

SAID = said_walks(homes=3, walks=2, seed=0)
PLAN = TrainingPlan(
    data="small world",
    ours=MentionSettings(
        trees=TreeSettings(iterations=5, least_in_leaf=5, ensembles=1),
        network=NetworkSettings(width=8, epochs=1, batch=32),
        folds=2,
    ),
    iedl=IedlSettings(width=16, layers=1, batch=16, epochs=3),
)


def train(out: Path, said: list[Instruction] = SAID, *, stop_at: str = "never", resume: bool = False) -> None:
    def say(told: str) -> None:
        if stop_at in told:
            raise KeyboardInterrupt

    train_models(said, anything_goes(), PLAN, out, resume=resume, say=say)


def arrays(path: Path) -> dict[str, Any]:
    with np.load(path) as file:
        return {name: file[name] for name in file.files}


def test_a_training_that_was_interrupted_is_taken_up(tmp_path: Path) -> None:
    """While IEDL learns: ours is kept whole, IEDL goes on after its last epoch; other data are refused."""
    train(tmp_path / "whole.npz")
    parts = tmp_path / "parts.npz"
    with pytest.raises(KeyboardInterrupt):
        train(parts, stop_at="IEDL, epoch 1")
    assert not parts.exists()
    turned = replace(SAID[0], trajectory=replace(SAID[0].trajectory, viewpoints=()))
    with pytest.raises(BadFileError, match="was trained with digest"):
        train(parts, [turned, *SAID[1:]], resume=True)
    train(parts, resume=True)
    whole, again = arrays(tmp_path / "whole.npz"), arrays(parts)
    assert set(whole) == set(again)
    for name, array in whole.items():
        np.testing.assert_array_equal(again[name], array, err_msg=name)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["parts.npz", "whole.npz"]


def test_the_digest_is_of_all_that_is_learned_from() -> None:
    likely = anything_goes()
    own = digest_of(SAID, likely, {})
    assert own == digest_of(said_walks(homes=3, walks=2, seed=0), likely, {})
    assert own != digest_of([replace(SAID[0], tokens=SAID[0].tokens[1:]), *SAID[1:]], likely, {})
    assert own != digest_of(SAID, replace(likely, rooms={}), {})
    injector = Injector(common_sense=likely)
    errors = list(error_episodes(SAID, "direction", injector, 1))
    assert own != digest_of(SAID, likely, {"uniform": errors})
    assert digest_of(SAID, likely, {"matched": errors}) != digest_of(SAID, likely, {"uniform": errors})


def test_errors_that_the_data_hold_are_learned_from_too(tmp_path: Path) -> None:
    injector = Injector(common_sense=anything_goes())
    errors = list(error_episodes(SAID, "room", injector, 5))
    own = list(training_episodes(SAID, lambda _: injector, 1, PLAN.seed))
    said: list[str] = []
    plan = replace(PLAN, iedl=None)
    model, _ = train_models(
        SAID,
        anything_goes(),
        plan,
        tmp_path / "m.npz",
        resume=False,
        say=said.append,
        errors={"uniform": errors},
    )
    count = len(own) + len(errors)
    assert f"uniform: {count} episodes, {count // 2} of them with errors" in said
    assert model.card["errors_given"] == {"uniform": len(errors), "matched": 0}
    strange = [replace(errors[0], group="elsewhere")]
    with pytest.raises(BadParameterError, match="in 'elsewhere', of which there is no instruction"):
        train_models(
            SAID,
            anything_goes(),
            plan,
            tmp_path / "m.npz",
            resume=False,
            say=said.append,
            errors={"matched": strange},
        )


def test_a_pack_of_the_same_seed_holds_other_errors() -> None:
    injector = Injector(common_sense=anything_goes())
    told = said_walks(homes=3, walks=6, seed=0)
    drawn = {one.tokens for one in training_episodes(told, lambda _: injector, 2, 1) if one.wrong}
    packed = [one.tokens for one in error_episodes(told, "all", injector, 1) if one.wrong]
    assert sum(tokens in drawn for tokens in packed) < len(packed) / 2


def test_words_of_which_none_can_be_wrong_are_too_few(tmp_path: Path) -> None:
    dull = [replace(one, tokens=tokenized("go on and on " * 5)) for one in SAID]
    with pytest.raises(BadParameterError, match="too few to learn from"):
        train(tmp_path / "m.npz", dull)


@pytest.mark.slow
def test_the_command_makes_homes_and_learns_in_them(tmp_path: Path) -> None:
    out = tmp_path / "model.npz"
    arguments = ["--homes", "2", "--width", "16", "--epochs", "1", "--out", str(out)]
    done = CliRunner().invoke(app, ["train", "iedl", *arguments])
    assert done.exit_code == 0, done.output
    assert "made 2 of 2 homes" in done.output
    assert (tmp_path / "model.curve.json").exists()
    card = load_model(out).card
    assert (card["homes"], card["iedl"]["epochs_trained"]) == (2, 1)
