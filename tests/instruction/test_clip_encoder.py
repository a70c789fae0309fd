"""IEDL through CLIP: a tiny untrained CLIP, saved as a real one is, looks at the pictures of a small pack."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.cli import app
from robustnav_nodes.instruction.common_sense import anything_goes
from robustnav_nodes.instruction.pack_images import HEADINGS_DEG, PackImages
from robustnav_nodes.instruction.panorama import SemanticEncoder
from robustnav_nodes.instruction.r2r_pack import R2rPack
from robustnav_nodes.instruction.trajectory import Trajectory, Viewpoint
from tests.instruction.pack_files import write_pack
from tests.instruction.small_world import said_walks

pytest.importorskip("torch")
pytest.importorskip("transformers")
pytest.importorskip("sklearn")

import torch
import transformers

from robustnav_nodes.instruction.clip_encoder import ClipEncoder, Picture
from robustnav_nodes.instruction.iedl_training import IedlSettings
from robustnav_nodes.instruction.mention_network import NetworkSettings
from robustnav_nodes.instruction.mention_training import MentionSettings, TreeSettings
from robustnav_nodes.instruction.model_file import load_model, save_model
from robustnav_nodes.instruction.training import TrainingPlan, train_models

SIDE, WIDTH = 32, 12
SHAPE = {"hidden_size": 16, "intermediate_size": 16, "num_hidden_layers": 1, "num_attention_heads": 2}
VISION = {**SHAPE, "image_size": SIDE, "patch_size": 16, "projection_dim": WIDTH}


def save_clip(folder: Path, seed: int) -> Path:
    """Whole, with the half that reads words, as CLIPs are passed around."""
    torch.manual_seed(seed)
    words = {**SHAPE, "vocab_size": 50}
    config = transformers.CLIPConfig(vision_config=VISION, text_config=words, projection_dim=WIDTH)
    transformers.CLIPModel(config).save_pretrained(folder)
    processor = transformers.CLIPImageProcessor(
        size={"shortest_edge": SIDE}, crop_size={"height": SIDE, "width": SIDE}
    )
    processor.save_pretrained(folder)
    return folder


def draw_images(pack: Path) -> None:
    rng = np.random.default_rng(0)
    for place in ("home/a", "home/b", "home/c"):
        (pack / "images" / place).mkdir(parents=True)
        for heading in HEADINGS_DEG:
            picture = Image.fromarray(rng.integers(0, 256, (24, 40, 3), dtype=np.uint8))
            picture.save(pack / "images" / place / f"{heading:03d}.jpg")


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return save_clip(tmp_path_factory.mktemp("clip"), seed=0)


@pytest.fixture(scope="module")
def pack(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = write_pack(tmp_path_factory.mktemp("packs") / "pack")
    draw_images(folder)
    return folder


@pytest.fixture(scope="module")
def trained(clip: Path, pack: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model file: a few steps of IEDL, on walks that pass the places of the pack."""
    out = tmp_path_factory.mktemp("model") / "model.npz"
    said = [
        replace(one, trajectory=at_places(one.trajectory, "home/a", "home/b", "home/c", "home/a"))
        for one in said_walks(homes=3, walks=2, seed=0)
    ]
    plan = TrainingPlan(
        data="small world",
        ours=MentionSettings(
            trees=TreeSettings(iterations=2, least_in_leaf=5, ensembles=1),
            network=NetworkSettings(width=8, epochs=1, batch=32),
            folds=2,
        ),
        iedl=IedlSettings(width=16, layers=1, batch=16, epochs=2),
    )
    encoder = ClipEncoder(clip, PackImages(pack).at)
    train_models(said, anything_goes(), plan, out, resume=False, say=lambda _: None, encoder=encoder)
    return out


def views(place: str) -> list[Picture]:
    """Two pictures that the place decides; none at "dark"."""
    rng = np.random.default_rng([ord(letter) for letter in place])
    return [rng.integers(0, 256, (40, 60, 3), dtype=np.uint8) for _ in range(0 if place == "dark" else 2)]


def walk(*places: str) -> Trajectory:
    anywhere = Viewpoint(x_m=0.0, y_m=0.0, z_m=1.5, yaw_in_rad=0.0, yaw_out_rad=0.0)
    return at_places(Trajectory(viewpoints=(anywhere,) * len(places)), *places)


def at_places(walk: Trajectory, *places: str) -> Trajectory:
    viewpoints = zip(walk.viewpoints, places, strict=True)
    return Trajectory(viewpoints=tuple(replace(one, place=place) for one, place in viewpoints))


def test_each_place_becomes_one_unit_vector_that_its_pictures_decide(clip: Path) -> None:
    encoder = ClipEncoder(clip, views)
    rows = encoder.encode(walk("a", "b", "a", "dark", ""))
    assert encoder.width == WIDTH
    assert rows.shape == (5, WIDTH)
    assert np.linalg.norm(rows[:3], axis=1) == pytest.approx(1.0, abs=1e-5)
    assert rows[0] == pytest.approx(rows[2], abs=1e-6)
    assert np.abs(rows[0] - rows[1]).max() > 1e-3
    assert not rows[3:].any()
    assert not encoder.encode(Trajectory()).any()


def test_pictures_are_looked_at_once(clip: Path) -> None:
    asked: list[str] = []

    def counted(place: str) -> Sequence[Picture]:
        asked.append(place)
        return views(place)

    encoder = ClipEncoder(clip, counted)
    encoder.encode(walk("a", "b", "a"))
    encoder.encode(walk("b", "c"))
    assert asked == ["a", "b", "c"]


def test_what_was_trained_is_saved_loaded_and_judges_by_pictures(
    clip: Path, pack: Path, trained: Path, tmp_path: Path
) -> None:
    images = PackImages(pack)
    said = R2rPack(pack).instructions("val_seen")[0]
    learned = load_model(trained)
    encoder = ClipEncoder(clip, images.at)
    assert learned.iedl_encoder == encoder.name
    iedl = learned.iedl(encoder)
    assert iedl is not None
    score = iedl.judge(said.trajectory, said.tokens).error_score
    save_model(tmp_path / "again.npz", learned)
    again = load_model(tmp_path / "again.npz").iedl(ClipEncoder(clip, images.at))
    assert again is not None
    assert again.judge(said.trajectory, said.tokens).error_score == score
    elsewhere = learned.iedl(ClipEncoder(clip, views))
    assert elsewhere is not None
    assert elsewhere.judge(said.trajectory, said.tokens).error_score != score


def test_the_bench_judges_it(clip: Path, pack: Path, trained: Path) -> None:
    arguments = ["--data", str(pack), "--suite", "val_seen", "--model", str(trained), "--models", "iedl"]
    done = CliRunner().invoke(app, ["bench", "instruction", *arguments, "--clip-folder", str(clip)])
    assert done.exit_code == 0, done.output
    assert "iedl, matched: calibration error" in done.output
    blind = CliRunner().invoke(app, ["bench", "instruction", *arguments])
    assert isinstance(blind.exception, BadFileError)
    assert "name the folder of its CLIP with --clip-folder" in str(blind.exception)


def test_another_encoder_than_that_of_the_training_is_refused(
    clip: Path, pack: Path, trained: Path, tmp_path: Path
) -> None:
    other = ClipEncoder(save_clip(tmp_path, seed=1), views)
    learned = load_model(trained)
    with pytest.raises(BadFileError, match=rf"trained with {learned.iedl_encoder}, and .* {other.name}"):
        learned.iedl(other)
    with pytest.raises(BadFileError, match="leave out --clip-folder"):
        replace(learned, iedl_encoder=SemanticEncoder().name).iedl(other)


def test_a_folder_that_holds_no_clip_is_refused(tmp_path: Path) -> None:
    """Not even one that transformers would fill up with random weights."""
    with pytest.raises(BadFileError, match="cannot read a CLIP model"):
        ClipEncoder(tmp_path, views)
    save_clip(tmp_path, seed=0)
    shape = {key: value for key, value in VISION.items() if key != "projection_dim"}
    transformers.ViTModel(transformers.ViTConfig(**shape)).save_pretrained(tmp_path)
    with pytest.raises(BadFileError, match=r"is no CLIP .*it is 'vit'"):
        ClipEncoder(tmp_path, views)


def test_pictures_that_are_missing_or_broken_are_named(tmp_path: Path) -> None:
    pack = write_pack(tmp_path / "pack")
    with pytest.raises(BadFileError, match="holds no pictures"):
        PackImages(pack)
    draw_images(pack)
    walks = [one.trajectory for one in R2rPack(pack).instructions("train")]
    images = PackImages(pack)
    images.check(walks)
    (pack / "images" / "home" / "b" / "090.jpg").write_bytes(b"no picture")
    with pytest.raises(BadFileError, match=r"cannot read the picture .*home/b/090\.jpg"):
        images.at("home/b")
    (pack / "images" / "home" / "b" / "090.jpg").unlink()
    for reads in (lambda: images.check(walks), lambda: images.at("home/b")):
        with pytest.raises(BadFileError, match=r"home/b/090\.jpg' is missing"):
            reads()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--encoder", "clip"), "--encoder clip and --clip-folder need each other"),
        (("--clip-folder", "nowhere"), "--encoder clip and --clip-folder need each other"),
        (("--encoder", "clip", "--clip-folder", "nowhere"), "homes made for this have none"),
        (("--encoder", "clip", "--clip-folder", "nowhere", "--data", "PACK"), "cannot read a CLIP model"),
        (("--encoder", "clip", "--clip-folder", "CLIP", "--data", "CLIP"), "holds no pictures"),
    ],
)
def test_bad_arguments_of_a_training_are_answered_with_a_sentence(
    clip: Path, pack: Path, tmp_path: Path, arguments: tuple[str, ...], said: str
) -> None:
    named = [{"PACK": str(pack), "CLIP": str(clip)}.get(word, word) for word in arguments]
    done = CliRunner().invoke(app, ["train", "iedl", "--out", str(tmp_path / "new" / "m.npz"), *named])
    assert isinstance(done.exception, (BadFileError, BadParameterError))
    assert said in str(done.exception)
    assert not list(tmp_path.iterdir())
