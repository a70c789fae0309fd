import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.detector_statistics import (
    ClassStatistics,
    RecallByRange,
    read_detector_statistics,
)
from robustnav_msgs_py.errors import BadFileError, BadParameterError

NO_BINS = json.dumps(
    {"unknown_class": {"precision": 1, "recall": 1, "recall_by_range": {"edges_m": [0, 1], "recall": []}}}
)
UNIT = st.floats(0.0, 1.0)


@given(precision=UNIT, recall=UNIT)
def test_f1_lies_between_precision_and_recall(precision, recall):
    f1 = ClassStatistics(precision=precision, recall=recall).f1
    assert min(precision, recall) - 1e-12 <= f1 <= max(precision, recall) + 1e-12


def test_f1_by_hand():
    assert ClassStatistics(precision=0.8, recall=0.6).f1 == pytest.approx(0.96 / 1.4)
    assert ClassStatistics(precision=0.0, recall=0.0).f1 == 0.0


@pytest.mark.parametrize("value", [-0.1, 1.1, float("nan")])
def test_statistics_out_of_range_are_refused(value):
    with pytest.raises(BadParameterError, match="precision is"):
        ClassStatistics(precision=value, recall=0.5)


def test_a_file_gives_classes_and_a_default(tmp_path):
    path = tmp_path / "statistics.json"
    path.write_text(
        json.dumps(
            {
                "unknown_class": {"precision": 0.5, "recall": 0.5},
                "classes": {"mug": {"precision": 0.9, "recall": 1}},
            }
        )
    )
    statistics = read_detector_statistics(path)
    assert statistics.of("mug") == ClassStatistics(precision=0.9, recall=1.0)
    assert statistics.of("unicorn").f1 == pytest.approx(0.5)


def test_an_empty_object_gives_the_defaults(tmp_path):
    path = tmp_path / "statistics.json"
    path.write_text("{}")
    assert read_detector_statistics(path).of("mug") == ClassStatistics()


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("{", "are not JSON"),
        ("[1, 2]", r"must be an object.*not \[1, 2\]"),
        ('{"class": {}}', "'classes' and 'unknown_class'"),
        ('{"classes": [1]}', r"'classes' in .* must be an object"),
        ('{"classes": {"mug": 0.5}}', "class 'mug' in .* not 0.5"),
        ('{"classes": {"mug": {"precision": "high", "recall": 0.5}}}', "class 'mug'"),
        ('{"classes": {"mug": {"precision": 0.5}}}', "class 'mug'"),
        (
            '{"classes": {"mug": {"precision": 1, "recall": 1, "recall_by_range": [1]}}}',
            r"class 'mug' .*recall_by_range must be .*not \[1\]",
        ),
        (
            NO_BINS,
            r"'unknown_class' .*edges \(0.0, 1.0\) for 0 bins",
        ),
        ('{"classes": {"mug": {"precision": 1.5, "recall": 0.5}}}', "class 'mug' .*1.5; it must lie in 0..1"),
    ],
)
def test_a_bad_file_is_refused_with_what_is_wrong(tmp_path, content, sentence):
    path = tmp_path / "statistics.json"
    path.write_text(content)
    with pytest.raises(BadFileError, match=sentence):
        read_detector_statistics(path)


def test_a_missing_file_is_refused_with_its_name(tmp_path):
    with pytest.raises(BadFileError, match=r"nowhere\.json.*No such file"):
        read_detector_statistics(tmp_path / "nowhere.json")


def test_recall_by_range_is_read_and_drawn_straight_between_the_middles_of_the_bins(tmp_path):
    path = tmp_path / "statistics.json"
    row = {"edges_m": [0, 1, 3], "recall": [0.9, 0.3]}
    path.write_text(json.dumps({"classes": {"mug": {"precision": 1, "recall": 0.5, "recall_by_range": row}}}))
    found = read_detector_statistics(path).of("mug").recall_by_range
    np.testing.assert_allclose(found.at(np.array([0.0, 0.5, 1.25, 2.0, 9.0])), [0.9, 0.9, 0.6, 0.3, 0.3])
    assert found.scaled(2.0).recall == (1.0, 0.6)


@pytest.mark.parametrize(
    ("edges", "recall"),
    [((0.0,), ()), ((1.0, 0.0), (0.5,)), ((-1.0, 1.0), (0.5,)), ((0.0, float("inf")), (0.5,))],
)
def test_recall_by_range_needs_rising_edges(edges, recall):
    with pytest.raises(BadParameterError, match="edges"):
        RecallByRange(edges_m=edges, recall=recall)


def test_recall_by_range_lies_in_0_to_1():
    with pytest.raises(BadParameterError, match=r"1.2.*must lie in 0..1"):
        RecallByRange(edges_m=(0.0, 1.0), recall=(1.2,))
