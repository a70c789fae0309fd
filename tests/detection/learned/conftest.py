"""Two small homes' pictures, and a network that has learned nothing."""

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from robustnav_nodes.detection.learned.training_pictures import PictureSet
    from robustnav_nodes.detection.learned.weights import Weights


@pytest.fixture(scope="session")
def picture_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    from robustnav_nodes.detection.learned.rendering import Kind, RenderPlan, render_pictures

    folder = tmp_path_factory.mktemp("detector") / "pictures"
    render_pictures(RenderPlan(kind=Kind.TRAINING, first_seed=90_000, homes=2, per_home=12), folder, 1)
    return folder


@pytest.fixture(scope="session")
def pictures(picture_folder: Path) -> "PictureSet":
    from robustnav_nodes.detection.learned.training_pictures import load_pictures

    return load_pictures(picture_folder)


@pytest.fixture
def untrained() -> "Weights":
    import torch

    from robustnav_nodes.detection.learned.network import DetectorNetwork, LookNetwork, Widths
    from robustnav_nodes.detection.learned.weights import Weights

    torch.manual_seed(0)
    widths = Widths(channels=(8, 16, 16, 16), blocks=(0, 1, 1), neck=16, head=16)
    return Weights(
        labels=("mug", "book"),
        widths=widths,
        detector=DetectorNetwork(2, widths).eval(),
        look=LookNetwork().eval(),
    )
