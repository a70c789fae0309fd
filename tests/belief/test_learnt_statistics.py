"""What was learnt stands over what was assumed, is kept in a file, and says when it is worse."""

import json

import pytest

from robustnav_msgs_py.detector_statistics import ClassStatistics, DetectorStatistics, RecallByRange
from robustnav_msgs_py.errors import BadFileError, BadMessageError
from robustnav_nodes.belief.learnt_statistics import LearntStatistics, read_observed, write_observed
from robustnav_nodes.belief.online_statistics import Observed
from robustnav_nodes.belief.verdict import read_verdict

BY_RANGE = RecallByRange(edges_m=(0.0, 2.0, 4.0), recall=(0.8, 0.4))
MUG = ClassStatistics(precision=0.8, recall=0.6, recall_by_range=BY_RANGE)
ASSUMED = DetectorStatistics(by_class={"mug": MUG})


def test_what_was_never_seen_is_as_assumed_to_the_last_bit():
    learnt = LearntStatistics(ASSUMED, 5.0)
    assert learnt.of("mug") is MUG
    assert learnt.of("unicorn") == ClassStatistics()
    assert learnt.complaint("mug") == ""


def test_a_posterior_by_hand():
    """Five looks of 0.6 and ten of which five detected: 8 of 15; recall by range falls by as much."""
    learnt = LearntStatistics(ASSUMED, 5.0, {"mug": Observed(detected=5, missed=5)})
    assert learnt.of("mug").recall == pytest.approx(8 / 15)
    assert learnt.of("mug").precision == pytest.approx(0.8)
    assert learnt.of("mug").recall_by_range.recall == pytest.approx((0.8 * 8 / 9, 0.4 * 8 / 9))
    record = learnt.record("mug")
    assert (record.detected, record.missed, record.recall_assumed) == (5, 5, 0.6)
    assert "after 10 looks" in record.summary


def test_what_is_learnt_goes_on_from_what_was_known():
    learnt = LearntStatistics(ASSUMED, 5.0, {"mug": Observed(missed=2)})
    online = learnt.online("mug")
    learnt.learn("mug", online.with_observed(Observed(detected=1, true_firings=1)))
    assert learnt.observed["mug"] == Observed(detected=1, missed=2, true_firings=1)


def test_it_complains_only_where_it_is_surely_worse():
    few = LearntStatistics(ASSUMED, 5.0, {"mug": Observed(missed=2)})
    assert few.complaint("mug") == ""
    many = LearntStatistics(ASSUMED, 5.0, {"mug": Observed(detected=3, missed=27, true_firings=3)})
    assert "recall at most 0.2" in many.complaint("mug")
    assert "precision" not in many.complaint("mug").partition(")")[0]
    better = LearntStatistics(ASSUMED, 5.0, {"mug": Observed(detected=40, true_firings=40)})
    assert better.complaint("mug") == ""


def test_the_file_keeps_what_was_seen_from_run_to_run(tmp_path):
    path = tmp_path / "home" / "learnt.json"
    assert read_observed(path) == {}
    seen = {"mug": Observed(detected=3, missed=1, true_firings=3, false_firings=2)}
    write_observed(path, seen)
    assert read_observed(path) == seen
    assert [item.name for item in path.parent.iterdir()] == ["learnt.json"]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("{", "is not JSON"),
        ("[]", "'observed'"),
        (json.dumps({"observed": {"mug": {"detected": 1}}}), "class 'mug'"),
        (json.dumps({"observed": {"mug": dict.fromkeys(Observed.__dataclass_fields__, -1)}}), "0 or more"),
    ],
)
def test_a_bad_file_is_refused(tmp_path, content, words):
    path = tmp_path / "learnt.json"
    path.write_text(content)
    with pytest.raises(BadFileError, match=words):
        read_observed(path)


def test_a_file_that_cannot_be_written_is_a_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BadFileError, match="cannot write what was learnt"):
        write_observed(tmp_path / "file" / "learnt.json", {})


def test_verdicts():
    assert read_verdict("confirmed coffee cup") == ("coffee cup", True)
    assert read_verdict(" refuted mug ") == ("mug", False)
    for line in ("refuted", "it is in the kitchen", "x" * 1000):
        with pytest.raises(BadMessageError, match="search/facts says") as caught:
            read_verdict(line)
        assert len(str(caught.value)) < 250
