"""Our model: it finds what is wrong in homes that it has not seen, and takes whatever it is given."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.instruction.common_sense import anything_goes
from robustnav_nodes.instruction.episodes import ErrorEpisode
from robustnav_nodes.instruction.injection import PROTOCOLS, Injector, Protocol, error_episodes
from robustnav_nodes.instruction.metrics import auc
from robustnav_nodes.instruction.model_file import SHIPPED, LearnedModel, load_model, save_model
from robustnav_nodes.instruction.score_scale import ScoreScale
from robustnav_nodes.instruction.side_model import SIDES
from robustnav_nodes.instruction.tokens import tokenized
from robustnav_nodes.instruction.trajectory import SeenObject, Trajectory, Viewpoint
from robustnav_nodes.instruction.verdict import ErrorModel
from tests.instruction.small_world import said_walks

pytest.importorskip("torch")
pytest.importorskip("sklearn")


def trained(*, homes: int, walks: int, protocols: tuple[Protocol, ...], iterations: int = 25) -> LearnedModel:
    from robustnav_nodes.instruction.mention_network import NetworkSettings
    from robustnav_nodes.instruction.mention_training import MentionSettings, TreeSettings, train_mentions

    settings = MentionSettings(
        trees=TreeSettings(iterations=iterations, least_in_leaf=5, ensembles=1, learning_rate=0.2),
        network=NetworkSettings(width=32, epochs=iterations // 2, batch=32),
        folds=2,
    )
    said = said_walks(homes=homes, walks=walks, seed=0)
    return train_mentions(said, anything_goes(), settings, seed=1, protocols=protocols, say=lambda _: None)


@pytest.fixture(scope="module")
def learned() -> LearnedModel:
    return trained(homes=4, walks=4, protocols=("uniform",))


def episodes(error_type: str) -> list[ErrorEpisode]:
    injector = Injector(common_sense=anything_goes())
    return list(error_episodes(said_walks(homes=4, walks=10, seed=9), error_type, injector, 3))


def auc_on(model: ErrorModel, judged: list[ErrorEpisode]) -> float:
    scores = [model.judge(episode.trajectory, episode.tokens).error_score for episode in judged]
    value = auc(np.array(scores), np.array([float(episode.label) for episode in judged]))
    assert value is not None
    return value


@pytest.mark.parametrize("error_type", ["direction", "object", "room"])
def test_errors_in_unseen_homes_are_found_by_looking(learned: LearnedModel, error_type: str) -> None:
    judged = episodes(error_type)
    assert auc_on(learned.model("uniform"), judged) > 0.9


def test_a_wrong_side_cannot_be_told_without_looking(learned: LearnedModel) -> None:
    """Of "into" it can: nobody here says "out of"."""
    found = episodes("direction")
    pairs = zip(found[::2], found[1::2], strict=True)
    sides = [one for pair in pairs if pair[1].wrong[0].wrong in SIDES for one in pair]
    assert abs(auc_on(learned.model("uniform", blind=True), sides) - 0.5) < 0.15


def test_the_wrong_word_is_found(learned: LearnedModel) -> None:
    model = learned.model("uniform")
    wrong = [episode for episode in episodes("object") if episode.wrong]
    hits = [
        model.judge(one.trajectory, one.tokens).places(1, len(one.tokens)) == (one.wrong[0].start,)
        for one in wrong
    ]
    assert np.mean(hits) > 0.8


def test_the_same_seed_learns_the_same_model() -> None:
    once, again = (trained(homes=3, walks=2, protocols=("matched",), iterations=4) for _ in range(2))
    for one in episodes("all")[:6]:
        first = once.model("matched").judge(one.trajectory, one.tokens)
        assert again.model("matched").judge(one.trajectory, one.tokens) == first


def test_a_saved_model_judges_the_same(learned: LearnedModel, tmp_path: Path) -> None:
    save_model(tmp_path / "model.npz", learned)
    read = load_model(tmp_path / "model.npz")
    assert read.card == learned.card
    assert read.iedl() is None
    for one in episodes("all")[:6]:
        for blind in (False, True):
            ours = learned.model("uniform", blind=blind).judge(one.trajectory, one.tokens)
            theirs = read.model("uniform", blind=blind).judge(one.trajectory, one.tokens)
            assert theirs.error_score == pytest.approx(ours.error_score, abs=1e-3)
        assert read.surprise.bits(one.tokens) == pytest.approx(learned.surprise.bits(one.tokens))


def test_the_scale_of_scores_comes_back_as_it_went(learned: LearnedModel, tmp_path: Path) -> None:
    scale = ScoreScale(shifts=np.array([0.25, -0.5, 0.0]), offset=-1.5, factor=0.75)
    scorers = {key: dataclasses.replace(one, scale=scale) for key, one in learned.scorers.items()}
    save_model(tmp_path / "model.npz", dataclasses.replace(learned, scorers=scorers))
    for one in load_model(tmp_path / "model.npz").scorers.values():
        np.testing.assert_array_equal(one.scale.shifts, scale.shifts)
        assert (one.scale.offset, one.scale.factor) == (scale.offset, scale.factor)


def test_a_scale_that_is_none_is_refused(learned: LearnedModel, tmp_path: Path) -> None:
    save_model(tmp_path / "model.npz", learned)
    with np.load(tmp_path / "model.npz") as file:
        arrays = {name: file[name] for name in file.files}
    for numbers in ([0.0, 1.0, 0.25, np.nan, 0.0], [0.0, -1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]):
        arrays["uniform/seeing/scale"] = np.array(numbers)
        np.savez(tmp_path / "model.npz", **arrays)
        with pytest.raises(BadFileError, match="3 shifts, finite numbers and a factor above 0"):
            load_model(tmp_path / "model.npz")


def test_an_unfinished_walk_is_judged_as_far_as_it_goes(learned: LearnedModel) -> None:
    model = learned.model("uniform")
    one = episodes("direction")[1]
    assert one.wrong
    scores = [
        model.judge(Trajectory(viewpoints=one.trajectory.viewpoints[:count]), one.tokens).error_score
        for count in range(5)
    ]
    assert all(0.0 <= score <= 1.0 for score in scores)
    assert scores[-1] == model.judge(one.trajectory, one.tokens).error_score


TEXTS = {
    "nothing": "",
    "no word": "!?! 🙂 —",
    "numbers": "go 3 m , turn 90 left , door no. 12",
    "other scripts": "поверните налево у дивана и 左に曲がって台所へ",
    "300 words": "turn left at the couch then go into the kitchen " * 30,
    "one mention": "couch",
}


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS.keys())
@pytest.mark.parametrize("places", [0, 1, 200])
@pytest.mark.parametrize("blind", [False, True])
def test_any_words_and_any_walk_give_a_probability(
    learned: LearnedModel, text: str, places: int, *, blind: bool
) -> None:
    walk = Trajectory(viewpoints=tuple(place(k) for k in range(places)))
    tokens = tokenized(text)
    verdict = learned.model("uniform", blind=blind).judge(walk, tokens)
    assert 0.0 <= verdict.error_score <= 1.0
    assert all(0 <= token < len(tokens) for token, _ in verdict.doubts)


def place(number: int) -> Viewpoint:
    """A place with a thing that no instruction names, and one without a bearing."""
    return Viewpoint(
        x_m=0.1 * number,
        y_m=0.0,
        z_m=1.5,
        yaw_in_rad=0.0,
        yaw_out_rad=0.3,
        objects=(SeenObject(name="unobtainium idol", bearing_rad=0.1), SeenObject(name="couch")),
    )


def test_one_home_is_too_few() -> None:
    from robustnav_nodes.instruction.mention_training import MentionSettings, train_mentions

    with pytest.raises(BadParameterError, match="at least two are needed"):
        train_mentions(
            said_walks(homes=1, walks=2, seed=0),
            anything_goes(),
            MentionSettings(),
            seed=1,
            say=lambda _: None,
        )


def test_files_that_are_no_model_are_refused_with_a_sentence(learned: LearnedModel, tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match="cannot read the model"):
        load_model(tmp_path / "none.npz")
    (tmp_path / "text.npz").write_text("no model")
    with pytest.raises(BadFileError, match="is no model of instruction errors"):
        load_model(tmp_path / "text.npz")
    save_model(tmp_path / "model.npz", learned)
    whole = (tmp_path / "model.npz").read_bytes()
    (tmp_path / "cut.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(BadFileError, match="is no model of instruction errors"):
        load_model(tmp_path / "cut.npz")


def test_a_model_of_other_features_says_so(learned: LearnedModel) -> None:
    other = dataclasses.replace(learned, features=("a", "b"))
    one = episodes("room")[0]
    with pytest.raises(BadFileError, match="other features than this version computes"):
        other.model("uniform").judge(one.trajectory, one.tokens)


def test_a_protocol_that_was_not_trained_is_named(learned: LearnedModel) -> None:
    with pytest.raises(BadFileError, match="'matched', only for uniform"):
        learned.model("matched")


def test_a_long_walk_keeps_its_turns() -> None:
    """Of 200 places 60 are looked at; what was turned at the others is not lost."""
    from robustnav_nodes.instruction.mention_model import MAX_PLACES, thinned

    long = Trajectory(
        viewpoints=tuple(
            Viewpoint(x_m=k, y_m=0.0, z_m=0.0, yaw_in_rad=1.5 * (k > 77), yaw_out_rad=1.5 * (k >= 77))
            for k in range(200)
        )
    )
    short = thinned(long)
    assert len(short) == MAX_PLACES
    assert sum(at.turn_rad for at in short.viewpoints) == pytest.approx(1.5)


def test_what_comes_along_is_whole_and_small() -> None:
    read = load_model(SHIPPED)
    assert SHIPPED.stat().st_size < 20e6
    one = said_walks(homes=1, walks=1, seed=3)[0]
    for protocol in PROTOCOLS:
        for blind in (False, True):
            verdict = read.model(protocol, blind=blind).judge(one.trajectory, one.tokens)
            assert 0.0 < verdict.error_score < 1.0
    iedl = read.iedl()
    assert iedl is not None
    assert 0.0 < iedl.judge(one.trajectory, one.tokens).error_score < 1.0
