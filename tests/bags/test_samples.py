"""The shipped samples are small, are read by the tools, and the nodes still say what is in them."""

import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
import yaml
from rosbags.highlevel import AnyReader
from typer.testing import CliRunner

from bags.bag_commands import bag_app
from bags.metrics import search_metrics
from bags.reader import open_bag

SAMPLES = Path(__file__).parents[2] / "bags" / "samples"
SEARCH = SAMPLES / "search"
MOST_BYTES = 4_000_000


def robustnav(*arguments: str) -> subprocess.CompletedProcess[str]:
    """The command, in a process of its own."""
    command = [sys.executable, "-m", "robustnav_nodes", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)


@pytest.mark.parametrize("sample", sorted(path.parent for path in SAMPLES.glob("*/metadata.yaml")), ids=str)
def test_a_sample_is_small_whole_and_of_a_clean_checkout(sample: Path) -> None:
    with open_bag(sample) as bag:
        assert not bag.cut
        assert bag.size_bytes < MOST_BYTES
        assert bag.manifest is not None
        assert bag.manifest.lockstep
        assert not bag.manifest.uncommitted_changes
        assert "/detection back_end=truth" in bag.manifest.back_ends_text


def test_rosbags_and_mcap_read_every_message_of_a_sample() -> None:
    mcap_ros2 = pytest.importorskip("mcap_ros2.reader")
    with open_bag(SEARCH) as bag:
        ours = Counter(raw.topic for raw in bag.raw_messages())
    with AnyReader([SEARCH]) as reader:
        decoded = ((row.topic, reader.deserialize(data, row.msgtype)) for row, _, data in reader.messages())
        assert Counter(topic for topic, message in decoded if message is not None) == ours
    told = mcap_ros2.read_ros2_messages(str(SEARCH / "search_0.mcap"))
    assert Counter(item.channel.topic for item in told if item.ros_msg is not None) == ours


def test_the_search_found_what_it_was_asked_for() -> None:
    with open_bag(SEARCH) as bag:
        metrics = search_metrics(bag)
    assert metrics.success
    assert metrics.spl is not None
    assert metrics.spl > 0.3


def test_the_nodes_of_today_say_the_same_in_a_process_of_their_own() -> None:
    verified = robustnav("bag", "verify", str(SEARCH))
    assert verified.returncode == 0, verified.stdout + verified.stderr
    assert "the same, message by message" in verified.stdout


def test_one_changed_parameter_is_told_by_the_first_other_decision(tmp_path: Path) -> None:
    changed = tmp_path / "changed.yaml"
    changed.write_text(yaml.safe_dump({"/**/planner": {"ros__parameters": {"worth": "discount"}}}))
    replayed = robustnav("bag", "replay", str(SEARCH), "--node", "planner", "--params", str(changed))
    assert replayed.returncode == 0, replayed.stderr
    assert "first difference: message 1 of /planner/decision" in replayed.stdout
    assert "was recorded" in replayed.stdout


def test_a_report_is_made_of_it(tmp_path: Path) -> None:
    page = tmp_path / "search.html"
    result = CliRunner().invoke(bag_app, ["report", str(SEARCH), "--out", str(page)])
    assert result.exit_code == 0, result.output
    assert "hat" in page.read_text(encoding="utf-8")
