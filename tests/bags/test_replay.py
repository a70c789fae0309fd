"""A recorded run is had again by its nodes, message by message, or the first difference is told."""

from pathlib import Path

import pytest

from bags.manifest import Manifest
from bags.reader import open_bag
from bags.replay import replay
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError, BadParameterError

SEARCH = Path(__file__).parents[2] / "bags" / "samples" / "search"


def test_one_node_alone_can_be_replayed() -> None:
    with open_bag(SEARCH) as bag:
        again = replay(bag, nodes=["planner"])
    assert again.is_same, again.first
    assert again.nodes == ("planner",)
    assert "/planner/decision" in {topic.topic for topic in again.topics}
    assert "/belief/cloud" not in {topic.topic for topic in again.topics}


def test_another_planner_decides_differently_and_the_first_decision_is_named(
    tmp_path: Path,
) -> None:
    changed = tmp_path / "greedy.yaml"
    changed.write_text("/**/planner:\n  ros__parameters:\n    variant: random\n")
    with open_bag(SEARCH) as bag:
        again = replay(bag, nodes=["planner"], parameter_file=changed)
    assert not again.is_same
    assert again.first is not None
    decisions = next(topic for topic in again.topics if topic.topic == "/planner/decision")
    assert decisions.first is not None
    assert decisions.first.number == 0
    assert decisions.first.what == "differs"
    assert decisions.first.time_ns >= again.first.time_ns
    assert any(field.first != field.second for field in decisions.first.fields)


def test_what_cannot_be_replayed_is_refused_with_a_sentence() -> None:
    with open_bag(SEARCH) as bag:
        with pytest.raises(
            BadParameterError, match="no node 'sim_bridge' can be replayed; there are detection"
        ):
            replay(bag, nodes=["sim_bridge"])
        with pytest.raises(BadParameterError, match="no node 'brain' can be replayed"):
            replay(bag, nodes=["brain"])


def test_a_misspelt_parameter_is_refused(tmp_path: Path) -> None:
    changed = tmp_path / "changed.yaml"
    changed.write_text("/**/planner:\n  ros__parameters:\n    varaint: random\n")
    with (
        open_bag(SEARCH) as bag,
        pytest.raises(BadParameterError, match="planner has no parameter 'varaint'; is it misspelt in"),
    ):
        replay(bag, nodes=["planner"], parameter_file=changed)


def test_a_bag_that_tells_no_parameters_is_refused(tmp_path: Path) -> None:
    BagWriter(tmp_path / "bag", manifest=Manifest(version="0.1.0", wall_start_ns=0)).close()
    with (
        open_bag(tmp_path / "bag") as bag,
        pytest.raises(BadFileError, match="does not tell the parameters of 'planner'"),
    ):
        replay(bag, nodes=["planner"])
