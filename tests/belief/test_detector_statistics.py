import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.belief.detector_statistics import ClassStatistics, read_detector_statistics

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
