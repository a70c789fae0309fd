"""Weights come back as they were written, and what is wrong with a file is said in a sentence."""

from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from robustnav_msgs_py.errors import BadFileError  # noqa: E402
from robustnav_nodes.detection.learned.weights import (  # noqa: E402
    SHIPPED,
    Weights,
    load_weights,
    save_weights,
)


@pytest.fixture
def file(untrained: Weights, tmp_path: Path) -> Path:
    save_weights(tmp_path / "weights.npz", untrained)
    return tmp_path / "weights.npz"


def test_a_round_trip_keeps_labels_and_half_precision(untrained: Weights, file: Path) -> None:
    read = load_weights(file, labels=("mug", "book"))
    assert read.labels == untrained.labels
    assert read.widths == untrained.widths
    images = torch.rand(1, 3, 32, 32)
    with torch.inference_mode():
        before, after = untrained.detector(images)[0], read.detector(images)[0]
    assert torch.allclose(before, after, atol=1e-2)


def test_no_file_says_how_to_get_one(tmp_path: Path) -> None:
    with pytest.raises(BadFileError, match=r"no weights file .*none\.npz.*robustnav train detector"):
        load_weights(tmp_path / "none.npz")


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_a_cut_file_is_refused(file: Path, part: float) -> None:
    whole = file.read_bytes()
    file.write_bytes(whole[: int(len(whole) * part)])
    with pytest.raises(BadFileError, match="cut short"):
        load_weights(file)


def test_changed_numbers_are_noticed(file: Path) -> None:
    with np.load(file) as read:
        arrays = {name: read[name] for name in read.files}
    name = next(name for name in arrays if name.endswith("out.bias"))
    arrays[name] = arrays[name] + np.float16(1.0)
    np.savez(file, **arrays)
    with pytest.raises(BadFileError, match="check sum"):
        load_weights(file)


def test_pickled_objects_are_not_read(tmp_path: Path) -> None:
    np.savez(tmp_path / "weights.npz", facts=np.array([{"format": 1}], dtype=object))
    with pytest.raises(BadFileError, match="cut short or is none"):
        load_weights(tmp_path / "weights.npz")


def test_other_classes_are_refused_by_name(file: Path) -> None:
    with pytest.raises(BadFileError, match=r"lacks \['cat'\] and has \['book'\]"):
        load_weights(file, labels=("mug", "cat"))


def test_the_same_classes_in_another_order_are_refused(file: Path) -> None:
    with pytest.raises(BadFileError, match="another order"):
        load_weights(file, labels=("book", "mug"))


def test_the_shipped_weights_are_small_and_know_the_classes_of_the_homes() -> None:
    catalogue = pytest.importorskip("sim_bridge.homes.objects.catalogue")
    assert SHIPPED.stat().st_size < 10e6
    assert load_weights(labels=catalogue.LABELS).labels == catalogue.LABELS


def test_the_shipped_weights_have_a_card() -> None:
    card = SHIPPED.with_name("model_card.md").read_text(encoding="utf-8")
    assert all(f"| {label} |" in card for label in load_weights().labels)
