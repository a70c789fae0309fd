"""Whole searches through the real graph: asked from another process, recorded, and survived by every node."""

import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

from rosbags.rosbag2 import Reader

from bags.info import bag_info
from bags.metrics import search_metrics
from bags.picture import draw_search
from bags.reader import open_bag
from robustnav_msgs_py.records import SearchPhase
from tests.graph.running_graph import running_graph

ASK = Path(__file__).parent / "ask_from_outside.py"
OURS = ("FASTRTPS_DEFAULT_PROFILES_FILE", "ROS_PYTHON_CHECK_FIELDS", "ROS_AUTOMATIC_DISCOVERY_RANGE")
TICK_NS = {"/clock": 20_000_000, "/scan": 100_000_000, "/camera/image_raw": 200_000_000}


def ask(line: str) -> None:
    """Say `line` from a process of its own that has only what any ROS 2 program has."""
    environment = {name: value for name, value in os.environ.items() if name not in OURS}
    done = subprocess.run(
        [sys.executable, str(ASK), line],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stderr


def a_detector_that_never_errs() -> dict[str, dict[str, float]]:
    """These tests are about the graph."""
    return {"detection": {"recall": 1.0, "precision": 1.0}}


def test_a_search_asked_from_another_process_is_recorded_whole(tmp_path: Path) -> None:
    with running_graph(
        tmp_path, seed=3, with_simulated_user=False, parameters=a_detector_that_never_errs()
    ) as graph:
        graph.wait_until_active()
        ask("find the laptop")  # of which this home has two
        graph.wait(lambda: graph.search.target == "laptop", "the search to begin")
        graph.say("find the unicorn")
        graph.wait(lambda: "I do not know what 'unicorn' looks like" in graph.chat[-1][1], "an answer")
        graph.say("why?")
        graph.say("where are you?")
        graph.wait(graph.has_ended, "the end of the search", timeout_s=90.0)
        assert graph.search.phase is SearchPhase.FOUND, graph.search
        graph.wait(lambda: graph.chat[-1][1].startswith("I found the laptop"), "the robot to say so")
        decisions = len(graph.decisions)

    with open_bag(tmp_path / "bag") as bag:
        assert not bag.cut
        info = bag_info(bag)
        metrics = search_metrics(bag)
        draw_search(bag, tmp_path / "run.png")
        manifest = bag.manifest
    assert metrics.success
    assert metrics.target == "laptop"
    assert metrics.spl is not None
    assert manifest is not None
    assert manifest.seed == 3
    counts = {topic.name: topic.message_count for topic in info.topics}
    assert counts["/planner/decision"] == decisions
    stamps_have_no_gaps(tmp_path / "bag")


def stamps_have_no_gaps(bag: Path) -> None:
    """Every message of the steady topics is there: their stamps follow each other without a hole."""
    with Reader(bag) as reader:
        for topic, tick_ns in TICK_NS.items():
            stamps = []
            connections = [item for item in reader.connections if item.topic == topic]
            for _, _, data in reader.messages(connections):
                seconds, nanoseconds = (int.from_bytes(data[at : at + 4], "little") for at in (4, 8))
                stamps.append(seconds * 1_000_000_000 + nanoseconds)
            gaps = {after - before for before, after in pairwise(stamps)}
            assert gaps == {tick_ns}, (topic, gaps)


def test_every_node_can_be_killed_in_mid_search(tmp_path: Path) -> None:
    """Two at a time that do not speak with each other: it is found all the same, and the bag is whole."""
    victims = (
        ("simulated_user", "belief"),
        ("dialogue", "detection"),
        ("planner", "recorder"),
        ("manager", "sim_bridge"),
    )
    with running_graph(tmp_path, seed=2, parameters=a_detector_that_never_errs()) as graph:
        graph.wait(lambda: graph.search.phase is SearchPhase.SEARCHING, "a search")
        target = graph.search.target
        for pair in victims:
            if graph.has_ended():
                assert graph.search.phase is SearchPhase.FOUND, (pair, graph.search)
                graph.search_again(target)
            graph.kill(*pair)
        graph.wait(graph.has_ended, "the end of the search", timeout_s=120.0)
        assert graph.search.phase is SearchPhase.FOUND, graph.search
        assert len(graph.events) == sum(map(len, victims)), graph.events
    with open_bag(tmp_path / "bag") as bag:
        assert bag.manifest is not None
        assert not bag.cut
