"""The CLIP encoder, on a tiny untrained CLIP that is made and saved here as a real one is."""

from pathlib import Path

import numpy as np
import pytest

from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.instruction.trajectory import Trajectory, Viewpoint

torch = pytest.importorskip("torch")
transformers = pytest.importorskip("transformers")

SIDE, WIDTH = 32, 12


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("clip")
    torch.manual_seed(0)
    shape = {"hidden_size": 16, "intermediate_size": 16, "num_hidden_layers": 1, "num_attention_heads": 2}
    config = transformers.CLIPVisionConfig(**shape, image_size=SIDE, patch_size=16, projection_dim=WIDTH)
    transformers.CLIPVisionModelWithProjection(config).save_pretrained(folder)
    processor = transformers.CLIPImageProcessor(
        size={"shortest_edge": SIDE}, crop_size={"height": SIDE, "width": SIDE}
    )
    processor.save_pretrained(folder)
    return folder


def views(viewpoint: Viewpoint) -> list[np.ndarray]:
    """Two pictures whose brightness is told by where the viewpoint is; none at x = 2."""
    if viewpoint.x_m == 2.0:
        return []
    rng = np.random.default_rng(int(viewpoint.x_m))
    return [rng.integers(0, 256, (40, 60, 3), dtype=np.uint8) for _ in range(2)]


def place(x_m: float) -> Viewpoint:
    return Viewpoint(x_m=x_m, y_m=0.0, z_m=1.5, yaw_in_rad=0.0, yaw_out_rad=0.0)


def test_each_viewpoint_becomes_one_unit_vector_that_its_pictures_decide(folder: Path) -> None:
    from robustnav_nodes.instruction.clip_encoder import ClipEncoder

    encoder = ClipEncoder(folder, views)
    rows = encoder.encode(Trajectory(viewpoints=(place(0.0), place(1.0), place(0.0), place(2.0))))
    assert encoder.width == WIDTH
    assert rows.shape == (4, WIDTH)
    assert np.linalg.norm(rows[:3], axis=1) == pytest.approx(1.0, abs=1e-5)
    assert rows[0] == pytest.approx(rows[2], abs=1e-6)
    assert np.abs(rows[0] - rows[1]).max() > 1e-3
    assert not rows[3].any()


def test_a_walk_without_viewpoints_is_one_row_of_zeros(folder: Path) -> None:
    from robustnav_nodes.instruction.clip_encoder import ClipEncoder

    assert not ClipEncoder(folder, views).encode(Trajectory()).any()


def test_iedl_learns_from_its_vectors(folder: Path) -> None:
    """The network takes any encoder's vectors, and gives a score and as many places as words."""
    from robustnav_nodes.instruction.clip_encoder import ClipEncoder
    from robustnav_nodes.instruction.iedl import Iedl, IedlShape
    from robustnav_nodes.instruction.iedl_model import IedlModel

    encoder = ClipEncoder(folder, views)
    network = Iedl(IedlShape(words=4, places=encoder.width, width=16, layers=1))
    model = IedlModel(network=network, words={"turn": 2, "left": 3}, encoder=encoder)
    verdict = model.judge(Trajectory(viewpoints=(place(0.0), place(1.0))), ("turn", "left", "now"))
    assert 0.0 < verdict.error_score < 1.0
    assert sorted(token for token, _ in verdict.doubts) == [0, 1, 2]


def test_a_folder_without_a_model_is_refused_with_a_sentence(tmp_path: Path) -> None:
    from robustnav_nodes.instruction.clip_encoder import ClipEncoder

    with pytest.raises(BadFileError, match="cannot read a CLIP model"):
        ClipEncoder(tmp_path, views)
