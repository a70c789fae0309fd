"""A detector that tells the truth is judged perfect, one that says nothing is judged blind."""

import numpy as np
import pytest

torch = pytest.importorskip("torch")

from robustnav_nodes.detection.boxes import Boxes  # noqa: E402
from robustnav_nodes.detection.learned.detector import LearnedDetector  # noqa: E402
from robustnav_nodes.detection.learned.judging import judge, look_alike_trials, truth_of  # noqa: E402
from robustnav_nodes.detection.learned.training_pictures import PictureSet  # noqa: E402
from robustnav_nodes.detection.learned.weights import Weights  # noqa: E402


def what_is_there(pictures: PictureSet) -> list[Boxes]:
    real = [truth_of(pictures.objects, number) for number in range(len(pictures))]
    return [
        Boxes(box_px=one.box_px, score=np.ones(len(one), dtype=np.float32), label=one.label) for one in real
    ]


def test_the_truth_is_perfect(pictures: PictureSet) -> None:
    judgement = judge(what_is_there(pictures), pictures, 0.5)
    assert judgement.mean_ap == 1.0
    assert judgement.precision == 1.0
    assert judgement.recall_at_score == 1.0
    assert (judgement.recall[judgement.recall_objects > 0] == 1.0).all()
    assert judgement.objects.sum() > 0


def test_silence_is_blind_and_has_no_precision(pictures: PictureSet) -> None:
    none = Boxes(
        box_px=np.zeros((0, 4), dtype=np.float32),
        score=np.zeros(0, dtype=np.float32),
        label=np.zeros(0, dtype=np.uint32),
    )
    judgement = judge([none] * len(pictures), pictures, 0.5)
    assert judgement.mean_ap == 0.0
    assert judgement.recall_at_score == 0.0
    assert np.isnan(judgement.precision)


def test_too_few_look_alikes_are_no_trial(pictures: PictureSet, untrained: Weights) -> None:
    shares = look_alike_trials(
        LearnedDetector(untrained), what_is_there(pictures), pictures, np.random.default_rng(0)
    )
    assert shares[2] == 0
    assert np.isnan(shares[:2]).all()
