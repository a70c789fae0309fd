"""Open-vocabulary models that are built here, tiny and untrained: their biases decide what they say."""

import json
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.values import ColorImage
from robustnav_nodes.detection.pixel_detector import PixelDetector

pytestmark = pytest.mark.skipif(
    find_spec("transformers") is None or find_spec("torch") is None, reason="transformers is not installed"
)

LABELS = ("mug", "coffee cup")
SIDE, PATCH = 32, 16


def detector(folder: Path, **changes: Any) -> PixelDetector:
    from robustnav_nodes.detection.open_vocabulary import OpenVocabularyDetector

    chosen: dict[str, Any] = {"labels": LABELS, "score_min": 0.3, "nms_iou": 1.0}
    return OpenVocabularyDetector(folder, **(chosen | changes))


def image(width: int = 40, height: int = 30) -> ColorImage:
    pixels = np.random.default_rng(0).integers(0, 256, (height, width, 3), dtype=np.uint8)
    return ColorImage(pixels=pixels, stamp_ns=1, frame_id="c")


@pytest.fixture(scope="module")
def owl_vit(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Four patches, each of which fires at both names with a score near 1."""
    import torch
    from transformers import CLIPTokenizer, OwlViTConfig, OwlViTForObjectDetection, OwlViTProcessor
    from transformers.models.owlvit.image_processing_pil_owlvit import OwlViTImageProcessorPil

    folder = tmp_path_factory.mktemp("owl")
    letters = "abcdefghijklmnopqrstuvwxyz"
    words = [*letters, *(f"{letter}</w>" for letter in letters), "<|startoftext|>", "<|endoftext|>"]
    tokenizer = CLIPTokenizer(vocab={word: number for number, word in enumerate(words)}, merges=[])
    tokenizer.model_max_length = 24
    shape = {"hidden_size": 16, "intermediate_size": 16, "num_hidden_layers": 1, "num_attention_heads": 2}
    config = OwlViTConfig(
        text_config={**shape, "vocab_size": len(words), "max_position_embeddings": 24, "pad_token_id": 53},
        vision_config={**shape, "image_size": SIDE, "patch_size": PATCH},
        projection_dim=16,
    )
    torch.manual_seed(0)
    model = OwlViTForObjectDetection(config)
    with torch.no_grad():
        model.class_head.logit_shift.bias.fill_(9.0)
        for layer in (model.class_head.logit_shift, model.class_head.logit_scale, model.box_head.dense2):
            layer.weight.zero_()
        model.class_head.logit_scale.bias.zero_()
        model.box_head.dense2.bias.zero_()
    model.save_pretrained(folder)
    size = {"height": SIDE, "width": SIDE}
    OwlViTProcessor(OwlViTImageProcessorPil(size=size, crop_size=size), tokenizer).save_pretrained(folder)
    return folder


def test_every_patch_says_what_it_was_made_to_say(owl_vit: Path) -> None:
    """An untrained OWL-ViT's boxes are as large as a patch, around the patch's lower right corner."""
    found = detector(owl_vit).detect(image())
    assert (found.score > 0.99).all()
    assert found.label.max() < len(LABELS)
    across, down = ((10.0, 30.0), (30.0, 40.0)), ((7.5, 22.5), (22.5, 30.0))
    expected = sorted((u_min, v_min, u_max, v_max) for u_min, u_max in across for v_min, v_max in down)
    np.testing.assert_allclose(sorted(map(tuple, found.box_px)), expected, atol=0.01)


def test_the_same_image_gives_the_same_boxes_and_odd_sizes_are_taken(owl_vit: Path) -> None:
    looker = detector(owl_vit)
    first, again = looker.detect(image()), looker.detect(image())
    assert np.array_equal(first.box_px, again.box_px)
    for width, height in ((31, 17), (1, 1)):
        assert (looker.detect(image(width, height)).box_px <= [width, height] * 2).all()


def test_scores_below_the_threshold_are_dropped(owl_vit: Path) -> None:
    assert len(detector(owl_vit, score_min=1.0).detect(image())) == 0


@pytest.fixture(scope="module")
def grounding_dino(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Nothing trained; its scores are what they are."""
    import torch
    from transformers import (
        BertTokenizer,
        GroundingDinoConfig,
        GroundingDinoForObjectDetection,
        GroundingDinoProcessor,
    )
    from transformers.models.grounding_dino.image_processing_pil_grounding_dino import (
        GroundingDinoImageProcessorPil,
    )

    folder = tmp_path_factory.mktemp("dino")
    words = ["[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]", ".", "?", "mug", "coffee", "cup"]
    tokenizer = BertTokenizer(vocab={word: number for number, word in enumerate(words)})
    layers = {"encoder_layers": 1, "decoder_layers": 2, "encoder_attention_heads": 2}
    config = GroundingDinoConfig(
        backbone_config={
            "model_type": "swin",
            "image_size": SIDE,
            "embed_dim": 8,
            "depths": [1, 1, 1, 1],
            "num_heads": [1, 1, 1, 1],
            "window_size": 2,
            "out_features": ["stage2", "stage3", "stage4"],
        },
        text_config={
            "model_type": "bert",
            "vocab_size": len(words),
            "hidden_size": 16,
            "num_hidden_layers": 1,
            "num_attention_heads": 2,
            "intermediate_size": 16,
        },
        d_model=64,
        num_queries=4,
        max_text_len=32,
        decoder_attention_heads=2,
        encoder_ffn_dim=16,
        decoder_ffn_dim=16,
        **layers,
    )
    torch.manual_seed(0)
    GroundingDinoForObjectDetection(config).save_pretrained(folder)
    images = GroundingDinoImageProcessorPil(size={"shortest_edge": 2 * SIDE, "longest_edge": 4 * SIDE})
    GroundingDinoProcessor(images, tokenizer).save_pretrained(folder)
    return folder


def test_an_untrained_grounding_dino_runs(grounding_dino: Path) -> None:
    found = detector(grounding_dino, score_min=0.0).detect(image())
    assert 0 < len(found) <= 4
    assert np.isfinite(found.score).all()
    assert (found.box_px <= [40, 30, 40, 30]).all()


def test_each_class_has_the_best_score_of_its_own_words(grounding_dino: Path) -> None:
    """Tokens: [CLS] mug . coffee cup . [SEP]; the model's word for each is put in its mouth."""
    import torch

    looker: Any = detector(grounding_dino)
    logits = torch.full((1, 3, 32), -9.0)
    logits[0, 0, 1], logits[0, 1, 4], logits[0, 2, 2] = 2.0, 1.0, 9.0  # mug; cup; the dot is no class
    boxes = torch.tensor([[[0.5, 0.5, 0.5, 0.4], [0.25, 0.5, 0.1, 0.2], [0.5, 0.5, 0.1, 0.1]]])
    looker._model = lambda **_: SimpleNamespace(logits=logits, pred_boxes=boxes)
    found = looker.detect(image())
    assert found.label.tolist() == [0, 1]
    np.testing.assert_allclose(found.score, 1.0 / (1.0 + np.exp([-2.0, -1.0])), rtol=1e-5)
    np.testing.assert_allclose(found.box_px, [[10, 9, 30, 21], [8, 12, 12, 18]], atol=1e-4)


def test_names_stand_in_the_prompt_where_they_are_said_to() -> None:
    pytest.importorskip("transformers")
    from robustnav_nodes.detection.open_vocabulary import _one_prompt

    prompt, spans = _one_prompt(("Mug", "coffee cup", "st. bernard"))
    assert prompt == "mug. coffee cup. st  bernard."
    assert [prompt[low:high] for low, high in spans] == ["mug", "coffee cup", "st  bernard"]


def test_a_folder_without_a_model_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match="is it whole"):
        detector(tmp_path)


def test_truncated_weights_and_other_models_are_refused(owl_vit: Path, tmp_path: Path) -> None:
    for path in owl_vit.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    weights = tmp_path / "model.safetensors"
    weights.write_bytes(weights.read_bytes()[:5000])
    with pytest.raises(BadFileError, match="is it whole"):
        detector(tmp_path)
    (tmp_path / "config.json").write_text(json.dumps({"model_type": "bert"}))
    with pytest.raises(BadFileError, match="cannot read a zero-shot detector"):
        detector(tmp_path)
