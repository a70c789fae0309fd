"""A whole search in lock-step: it ends, and each time, in whatever process, it is the same one."""

import subprocess
import sys
from itertools import pairwise, zip_longest
from pathlib import Path

import pytest
from rclpy.serialization import deserialize_message

from bags.comparison import differences
from bags.metrics import search_metrics
from bags.reader import open_bag
from bags.replay import REPLAYED, replay
from bags.search_run import read_search
from robustnav_msgs_py.errors import GraphError
from robustnav_msgs_py.records import SearchPhase
from robustnav_nodes.graph.lockstep import NS_PER_S, Said
from robustnav_nodes.graph.lockstep_run import LockstepRun
from robustnav_nodes.graph.message_class import message_class
from robustnav_nodes.graph.search_graph import RunPlan
from tests import lockstep_search
from tests.lockstep_search import SEED, plan_of

STEP_NS = 20_000_000
PATIENCE_S = 300.0  # where other tests have the cores


@pytest.fixture(scope="module")
def lockstep_bags(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The bags of one search in lock-step, recorded twice, each in a fresh process."""
    folders = [tmp_path_factory.mktemp("lockstep") for _ in range(2)]
    script = Path(lockstep_search.__file__)
    processes = [
        subprocess.Popen(
            [sys.executable, str(script), str(folder)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        for folder in folders
    ]
    for process in processes:
        output, _ = process.communicate(timeout=PATIENCE_S)
        assert process.returncode == 0, output.decode(errors="replace")[-2000:]
    return [folder / "bag" for folder in folders]


def test_the_search_ends_and_its_bag_tells_of_it(lockstep_bags: list[Path]) -> None:
    with open_bag(lockstep_bags[0]) as bag:
        assert not bag.cut
        assert bag.manifest is not None
        assert bag.manifest.lockstep
        assert bag.manifest.seed == SEED
        told = {node.node for node in bag.manifest.nodes}
        assert told == {"/sim_bridge", "/detection", "/belief", "/planner", "/dialogue", "/simulated_user"}
        search = read_search(bag)
        assert search.final is not None
        assert search.final.phase is SearchPhase.FOUND
        assert search.targets
        assert search_metrics(bag).success
        clocks = [raw.log_time_ns for raw in bag.raw_messages(["/clock"])]
        assert {later - earlier for earlier, later in pairwise(clocks[1:])} == {STEP_NS}


def test_two_processes_say_the_same(lockstep_bags: list[Path]) -> None:
    with open_bag(lockstep_bags[0]) as first, open_bag(lockstep_bags[1]) as second:
        topics = {row.name: row.type for row in first.topics}
        assert topics == {row.name: row.type for row in second.topics}
        assert {"/odom", "/scan", "/camera/image_raw", "/planner/decision", "/belief/cloud"} <= set(topics)
        count = 0
        for one, other in zip_longest(first.raw_messages(list(topics)), second.raw_messages(list(topics))):
            assert one is not None
            assert other is not None
            assert (one.topic, one.log_time_ns) == (other.topic, other.log_time_ns)
            count += 1
            # Diagnostics tell how long things took.
            if one.data == other.data or one.topic == "/diagnostics":
                continue
            kind = message_class(topics[one.topic])
            found = list(differences(*(deserialize_message(raw.data, kind) for raw in (one, other))))
            assert not found, (one.topic, count, found)
        assert count > 1000


def test_the_nodes_say_again_what_was_recorded(lockstep_bags: list[Path]) -> None:
    with open_bag(lockstep_bags[0]) as bag:
        again = replay(bag)
    assert again.is_same, again.first
    assert again.first is None
    assert again.nodes == REPLAYED
    assert again.inputs > 1000
    for topic in again.topics:
        assert topic.same == topic.replayed == topic.recorded > 0, topic
    compared = {topic.topic for topic in again.topics}
    assert {"/planner/decision", "/detections", "/belief/cloud", "/goal_pose", "/chat/to_user"} <= compared


def test_a_run_ends_at_its_limit_and_tells_its_parameters(tmp_path: Path) -> None:
    said: list[Said] = []
    plan = plan_of(None)
    with LockstepRun(plan, plan.write_parameters(tmp_path / "parameters.yaml"), said.append) as run:
        begin_ns = run.lockstep.time_ns
        assert not run.run(lambda: False, 0.5)
        assert run.lockstep.time_ns == begin_ns + NS_PER_S // 2
        assert run.run(lambda: True, 10.0)
        assert run.lockstep.time_ns == begin_ns + NS_PER_S // 2
        told = run.parameters()
        assert told["/sim_bridge"]["camera_width"] == 80
        assert told["/planner"]["seed"] == SEED
        nodes = run.nodes
    assert nodes == []
    times = [item.time_ns for item in said]
    assert times == sorted(times)
    assert {"/clock", "/odom", "/map"} <= {item.topic for item in said}


def test_a_node_that_does_not_come_up_ends_the_run_with_a_sentence(tmp_path: Path) -> None:
    plan = RunPlan(parameters={"sim_bridge": {"scene": "/nowhere/home.yaml"}})
    with pytest.raises(GraphError, match="sim_bridge could not configure; its log says why"):
        LockstepRun(plan, plan.write_parameters(tmp_path / "parameters.yaml"), lambda _: None)
