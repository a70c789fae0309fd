"""The losses are least where the networks are right, and their gradients are the true ones."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from robustnav_nodes.detection.learned.losses import (  # noqa: E402
    _ColdLoss,
    detection_loss,
    generalised_iou,
    look_loss,
    targets,
)

SHAPE = (1, 2, 16, 16)
BOX = np.array([[20.0, 12.0, 44.0, 36.0]], dtype=np.float32)
LABEL = np.array([1], dtype=np.int32)
YES, NO = np.array([True]), np.array([False])


def perfect_output() -> tuple["torch.Tensor", "torch.Tensor"]:
    logits = torch.full(SHAPE, -12.0)
    logits[0, 1, 6, 8] = 12.0
    middle = (torch.arange(16) + 0.5) * 4.0
    reach = torch.stack(
        [
            (middle - 20.0).expand(16, 16),
            (middle - 12.0)[:, None].expand(16, 16),
            (44.0 - middle).expand(16, 16),
            (36.0 - middle)[:, None].expand(16, 16),
        ]
    )[None]
    return logits, reach


def test_a_perfect_answer_costs_nothing() -> None:
    heat, box = detection_loss(*perfect_output(), targets([BOX], [LABEL], [YES], SHAPE))
    assert float(heat) < 1e-3
    assert float(box) < 1e-5


def test_a_missed_object_and_one_imagined_cost() -> None:
    logits, reach = perfect_output()
    wanted = targets([BOX], [LABEL], [YES], SHAPE)
    missed = logits.clone()
    missed[0, 1, 6, 8] = -12.0
    assert float(detection_loss(missed, reach, wanted)[0]) > 5.0
    imagined = logits.clone()
    imagined[0, 0, 1, 1] = 12.0
    assert float(detection_loss(imagined, reach, wanted)[0]) > 5.0


def test_what_is_not_taught_may_be_found_or_not() -> None:
    logits, reach = perfect_output()
    wanted = targets([BOX], [LABEL], [NO], SHAPE)
    assert float(detection_loss(logits, reach, wanted)[0]) < 1e-3
    assert len(wanted.hot) == 0
    assert len(wanted.cells) == 0


def test_images_without_objects_have_a_loss() -> None:
    none = np.zeros((0, 4), dtype=np.float32)
    wanted = targets([none], [LABEL[:0]], [YES[:0]], SHAPE)
    heat, box = detection_loss(torch.zeros(SHAPE), torch.ones(1, 4, 16, 16), wanted)
    assert float(heat) > 0.0
    assert float(box) == 0.0


def test_an_object_at_the_edge_has_its_middle_inside() -> None:
    box = np.array([[62.0, 62.0, 64.0, 64.0]], dtype=np.float32)
    assert targets([box], [LABEL], [YES], SHAPE).hot.tolist() == [2 * 16 * 16 - 1]


def test_the_cold_loss_has_the_gradient_of_its_formula() -> None:
    torch.manual_seed(0)
    logits = torch.randn(2, 4, dtype=torch.float64, requires_grad=True)
    weight = torch.rand(2, 4, dtype=torch.float64)
    assert torch.autograd.gradcheck(lambda x: _ColdLoss.apply(x, weight), logits)
    p = torch.sigmoid(logits)
    wanted = -(weight * p**2 * torch.log(1.0 - p)).sum()
    assert torch.allclose(_ColdLoss.apply(logits, weight), wanted)


def test_generalised_iou_by_hand() -> None:
    first = torch.tensor([[0.0, 0.0, 2.0, 2.0], [0.0, 0.0, 1.0, 1.0]])
    second = torch.tensor([[0.0, 0.0, 2.0, 2.0], [1.0, 1.0, 2.0, 2.0]])
    # equal ones; and two unit squares that touch in a corner, in a box of 4
    assert generalised_iou(first, second).tolist() == pytest.approx([1.0, 0.0 - 2.0 / 4.0])


def test_looks_that_lie_together_cost_less_than_looks_that_are_mixed() -> None:
    apart = torch.tensor([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]])
    right, mixed = torch.tensor([0, 0, 1, 1]), torch.tensor([0, 1, 0, 1])
    one_class = torch.zeros(4, dtype=torch.int64)
    assert float(look_loss(apart, right, one_class)) < 1e-3
    assert float(look_loss(apart, mixed, one_class)) > 5.0


def test_the_own_class_counts_more_than_the_others() -> None:
    embeddings = torch.tensor([[1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 0.0]])
    look = torch.tensor([0, 0, 1, 1])
    same_class = float(look_loss(embeddings, look, torch.zeros(4, dtype=torch.int64)))
    other_class = float(look_loss(embeddings, look, look))
    assert other_class == pytest.approx(np.log(3.0))  # told from three, and from nothing in its class
    assert same_class == pytest.approx(2.0 * np.log(3.0))
