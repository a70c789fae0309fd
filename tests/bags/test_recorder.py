"""The recorder in a real graph: nothing that was said on a topic it hears is missing from the bag."""

import itertools
import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lifecycle_msgs.msg import State
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosbags.rosbag2 import Reader
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String, UInt64
from std_srvs.srv import Trigger

from bags import topic_listener
from bags.manifest import Manifest, NamedParameter
from bags.reader import Bag, open_bag
from bags.recorder import Recorder
from robustnav_msgs_py.conversions import clock_to_message, record_to_message
from robustnav_msgs_py.records import Episode
from robustnav_nodes.graph.message_class import message_class

LIMIT_S = 20.0
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)

TALKER = textwrap.dedent(
    """
    import rclpy
    from rclpy.duration import Duration
    from std_msgs.msg import String, UInt64

    rclpy.init()
    node = rclpy.create_node("talker")
    numbers = node.create_publisher(UInt64, "numbers", 1000)
    words = node.create_publisher(String, "words", 1000)
    clock = node.get_clock()
    while numbers.get_subscription_count() < 1 or words.get_subscription_count() < 1:
        clock.sleep_for(Duration(seconds=0.01))
    for value in range(1000):
        numbers.publish(UInt64(data=value))
        words.publish(String(data=f"word {value}"))
    numbers.wait_for_all_acked()
    words.wait_for_all_acked()
    print("done", flush=True)
    input()
    node.destroy_node()
    rclpy.shutdown()
    """
)


class Graph:
    """Nodes in one executor, which is turned until something holds."""

    def __init__(self, bags: Path) -> None:
        self.bags = bags
        self.executor = EventsExecutor()
        self.nodes: list[Node] = []
        self.processes: list[subprocess.Popen[str]] = []

    def node(self, name: str) -> Node:
        return self.add(rclpy.create_node(name))

    def recorder(self, **parameters: Any) -> Recorder:
        """A recorder that is active; a parameter of None keeps its default."""
        given = {"folder": str(self.bags), "name": "run", "discovery_period_s": 0.02, **parameters}
        overrides = [Parameter(name, value=value) for name, value in given.items() if value is not None]
        recorder = self.add(Recorder(parameter_overrides=overrides))
        recorder.trigger_configure()
        if recorder.state_id == State.PRIMARY_STATE_INACTIVE:
            recorder.trigger_activate()
        return recorder

    def add(self, node: Any) -> Any:
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def process(self, *arguments: str) -> subprocess.Popen[str]:
        pipe = subprocess.PIPE
        self.processes.append(
            subprocess.Popen([sys.executable, *arguments], stdin=pipe, stdout=pipe, text=True)
        )
        return self.processes[-1]

    def until(self, holds: Callable[[], Any]) -> None:
        deadline = time.monotonic() + LIMIT_S
        while not holds():
            assert time.monotonic() < deadline, "what the test waits for did not come"
            self.executor.spin_once(timeout_sec=0.05)

    def counted(self, recorder: Recorder, topic: str) -> int:
        """Messages of `topic` that the recorder has taken."""
        return sum(count.messages for count in recorder.counts() if count.topic == topic)

    def close(self) -> None:
        self.executor.shutdown()  # it holds the nodes, which would stay in the graph
        for node in reversed(self.nodes):
            node.destroy_node()
        for process in self.processes:
            process.terminate()
            with process:  # waits, and closes its pipes
                pass


@pytest.fixture
def graph(tmp_path: Path) -> Iterator[Graph]:
    rclpy.init()
    made = Graph(tmp_path / "bags")
    try:
        yield made
    finally:
        made.close()
        rclpy.try_shutdown()


def data_of(bag: Bag, topic: str) -> list[Any]:
    return [recorded.message.data for recorded in bag.messages([topic])]


def test_every_message_of_reliable_topics_is_recorded(graph: Graph) -> None:
    recorder = graph.recorder()
    talker = graph.process("-c", TALKER)
    assert talker.stdout is not None
    os.set_blocking(talker.stdout.fileno(), False)
    graph.until(lambda: talker.stdout.readline())
    graph.until(lambda: graph.counted(recorder, "/numbers") == graph.counted(recorder, "/words") == 1000)
    talker.communicate("\n", timeout=LIMIT_S)
    assert talker.returncode == 0
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        assert bag.cut == ""
        assert data_of(bag, "/numbers") == list(range(1000))
        assert data_of(bag, "/words") == [f"word {value}" for value in range(1000)]
        topics = {row.name for row in bag.topics}
    assert {"/rosout", "/parameter_events", "/diagnostics", "/recorder/transition_event"} <= topics


def test_a_recorder_that_comes_late_has_what_was_latched(graph: Graph) -> None:
    node = graph.node("early")
    node.create_publisher(String, "map_name", LATCHED).publish(String(data="flat"))
    recorder = graph.recorder()
    graph.until(lambda: graph.counted(recorder, "/map_name") == 1)
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        assert data_of(bag, "/map_name") == ["flat"]
        (row,) = [row for row in bag.topics if row.name == "/map_name"]
        assert [offer.durability for offer in row.offers] == ["transient_local"]


def test_a_topic_that_appears_during_the_recording_is_in_it(graph: Graph) -> None:
    recorder = graph.recorder()
    node = graph.node("late")
    publisher = node.create_publisher(UInt64, "ns/new", BEST_EFFORT)
    graph.until(lambda: publisher.get_subscription_count() == 1)
    for value in range(5):
        publisher.publish(UInt64(data=value))
        graph.until(lambda expected=value + 1: graph.counted(recorder, "/ns/new") == expected)
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        assert data_of(bag, "/ns/new") == list(range(5))


def test_a_publisher_that_offers_less_is_heard_beside_the_others(graph: Graph) -> None:
    recorder = graph.recorder()
    node = graph.node("talker")
    reliable = node.create_publisher(UInt64, "numbers", LATCHED)
    graph.until(lambda: reliable.get_subscription_count() == 1)
    lesser = node.create_publisher(UInt64, "numbers", BEST_EFFORT)
    graph.until(lambda: lesser.get_subscription_count() == 1 and reliable.get_subscription_count() == 1)
    lesser.publish(UInt64(data=1))
    graph.until(lambda: graph.counted(recorder, "/numbers") == 1)
    reliable.publish(UInt64(data=2))
    graph.until(lambda: graph.counted(recorder, "/numbers") == 2)
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        assert data_of(bag, "/numbers") == [1, 2]


def test_the_manifest_tells_seed_scene_and_the_parameters_as_they_were_at_the_end(graph: Graph) -> None:
    node = graph.node("detection")
    node.declare_parameter("backend", "truth")
    node.declare_parameter("thresholds", [0.5, 0.25])
    episode = Episode(
        seed=42, home="flat", rooms=("hall", "bath"), start_x_m=0.0, start_y_m=0.0, start_yaw_rad=0.0
    )
    node.create_publisher(DiagnosticStatus, "truth/episode", LATCHED).publish(record_to_message(episode))
    clock = node.create_publisher(Clock, "/clock", 1)
    recorder = graph.recorder()
    graph.until(lambda: clock.get_subscription_count() >= 1)
    for seconds in (7, 8):
        clock.publish(clock_to_message(seconds * 10**9))
        graph.until(lambda expected=seconds - 6: graph.counted(recorder, "/clock") == expected)
    survey = recorder._survey
    assert survey is not None
    graph.until(lambda: len(survey.answers) == 2 and graph.counted(recorder, "/truth/episode") == 1)
    node.set_parameters([Parameter("backend", value="noisy")])
    graph.until(lambda: any("noisy" in str(answer) for answer in survey.answers))
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        manifest = bag.manifest
    assert manifest is not None
    assert (manifest.seed, manifest.scene, manifest.sim_start_ns) == (42, "flat (hall, bath)", 7 * 10**9)
    told = {told.node: told.parameters for told in manifest.nodes}
    assert NamedParameter(name="backend", value="noisy") in told["/detection"]
    assert NamedParameter(name="thresholds", value=(0.5, 0.25)) in told["/detection"]
    assert NamedParameter(name="name", value="run") in told["/recorder"]
    assert "/detection" not in manifest.silent_nodes


def test_a_node_that_does_not_answer_is_named(graph: Graph) -> None:
    silent = rclpy.create_node("silent")  # its services are there, and nobody turns its executor
    graph.nodes.append(silent)
    recorder = graph.recorder()
    survey = recorder._survey
    assert survey is not None
    graph.until(lambda: survey.silent == ("/silent",) and len(survey.answers) == 1)
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        manifest: Manifest | None = bag.manifest
    assert manifest is not None
    assert manifest.silent_nodes == ("/silent",)


def test_each_activation_makes_a_bag_of_its_own(graph: Graph) -> None:
    recorder = graph.recorder(name=None)
    first = recorder.folder_of_bag
    recorder.trigger_deactivate()
    recorder.trigger_activate()
    second = recorder.folder_of_bag
    recorder.destroy_node()
    assert first is not None
    assert second is not None
    assert first != second
    assert first.name.startswith("run_")
    for folder in (first, second):
        with open_bag(folder) as bag:
            assert bag.cut == ""


def test_a_bag_that_exists_is_left_alone(graph: Graph) -> None:
    (graph.bags / "run").mkdir(parents=True)
    recorder = graph.recorder()
    assert recorder.state_id == State.PRIMARY_STATE_INACTIVE
    assert "is not overwritten" in recorder.health.status("", []).message


def test_a_bag_that_was_closed_is_left_alone_even_with_resume(graph: Graph) -> None:
    graph.recorder().destroy_node()
    before = {path: path.read_bytes() for path in (graph.bags / "run").iterdir()}
    recorder = graph.recorder(resume=True)
    assert recorder.state_id == State.PRIMARY_STATE_INACTIVE
    assert "was closed properly" in recorder.health.status("", []).message
    assert {path: path.read_bytes() for path in (graph.bags / "run").iterdir()} == before


def test_a_bag_is_split_when_the_recorder_is_told_to(graph: Graph) -> None:
    recorder = graph.recorder()
    node = graph.node("talker")
    publisher = node.create_publisher(UInt64, "numbers", 100)
    split = node.create_client(Trigger, "recorder/split")
    graph.until(lambda: publisher.get_subscription_count() == 1 and split.service_is_ready())
    for value in range(20):
        publisher.publish(UInt64(data=value))
        graph.until(lambda expected=value + 1: graph.counted(recorder, "/numbers") == expected)
        if value == 9:
            asked = split.call_async(Trigger.Request())
            graph.until(asked.done)
            assert asked.result().success
            assert "goes on in its next file" in asked.result().message
    recorder.destroy_node()
    for index in (0, 1):
        with open_bag(graph.bags / "run" / f"run_{index}.mcap") as bag:
            assert data_of(bag, "/numbers") == list(range(10 * index, 10 * index + 10))
    with open_bag(graph.bags / "run") as bag:
        assert data_of(bag, "/numbers") == list(range(20))


def test_a_recorder_whose_files_have_a_limit_goes_on_in_the_next(graph: Graph) -> None:
    recorder = graph.recorder(split_duration_s=0.5)
    publisher = graph.node("talker").create_publisher(UInt64, "numbers", 100)
    said = itertools.count()

    def third_file_is_begun() -> bool:
        publisher.publish(UInt64(data=next(said)))
        return (graph.bags / "run" / "run_2.mcap").exists()

    graph.until(lambda: publisher.get_subscription_count() == 1)
    graph.until(third_file_is_begun)
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        assert bag.cut == ""
        numbers = data_of(bag, "/numbers")
    assert numbers == list(range(len(numbers)))


def test_what_is_dropped_is_told_for_its_topic(graph: Graph) -> None:
    recorder = graph.recorder(queue_size_bytes=1_048_576)
    node = graph.node("talker")
    large = node.create_publisher(String, "large", 10)
    small = node.create_publisher(String, "small", 10)
    told: dict[str, str] = {}

    def hear(message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == "/recorder":
                told.update({pair.key: pair.value for pair in status.values})
                told["message"] = status.message

    node.create_subscription(DiagnosticArray, "/diagnostics", hear, 10)
    graph.until(lambda: large.get_subscription_count() == 1 and small.get_subscription_count() == 1)
    for _ in range(3):
        large.publish(String(data="x" * 2_000_000))  # larger than all that may wait
        small.publish(String(data="x"))
    graph.until(lambda: "3 dropped" in told.get("/large", "") and "3 messages" in told.get("/small", ""))
    assert told["/large"] == "0 messages, 0 bytes, 3 dropped"
    assert told["/small"].endswith(" bytes, 0 dropped")
    assert told["dropped"] == "3"
    assert told["message"].startswith("3 messages came while the disk was behind, and are not in the bag")
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        assert data_of(bag, "/small") == ["x"] * 3
        assert data_of(bag, "/large") == []


def test_a_folder_that_cannot_be_written_is_refused(graph: Graph) -> None:
    graph.bags.write_text("a file, not a folder")
    recorder = graph.recorder()
    assert recorder.state_id == State.PRIMARY_STATE_INACTIVE
    told = recorder.health.status("", []).message
    assert told == f"a bag cannot be written to {graph.bags / 'run'}: Not a directory"


def test_topics_can_be_chosen(graph: Graph) -> None:
    recorder = graph.recorder(include="/a.*|/b", exclude="/a/secret")
    node = graph.node("talker")
    topics = ("a/open", "a/secret", "b", "b/more")
    publishers = {topic: node.create_publisher(UInt64, topic, 10) for topic in topics}
    graph.until(
        lambda: publishers["a/open"].get_subscription_count() + publishers["b"].get_subscription_count() == 2
    )
    assert (
        publishers["a/secret"].get_subscription_count() == publishers["b/more"].get_subscription_count() == 0
    )
    recorder.destroy_node()
    with open_bag(graph.bags / "run") as bag:
        assert [row.name for row in bag.topics] == ["/a/open", "/b"]


def test_a_bad_expression_keeps_the_recorder_from_being_configured(graph: Graph) -> None:
    recorder = graph.recorder(include="[")
    assert recorder.state_id == State.PRIMARY_STATE_UNCONFIGURED
    assert "it is no regular expression" in recorder.health.status("", []).message


def test_a_type_that_is_not_installed_is_said_once(graph: Graph, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> Any:
        if name == "std_msgs/msg/String":
            raise ModuleNotFoundError("No module named 'std_msgs'")
        return message_class(name)

    monkeypatch.setattr(topic_listener, "message_class", missing)
    recorder = graph.recorder()
    node = graph.node("talker")
    node.create_publisher(String, "words", 10)
    numbers = node.create_publisher(UInt64, "numbers", 10)
    graph.until(lambda: numbers.get_subscription_count() == 1)
    told = recorder.health.status("", []).values["problem /words"]
    assert told.startswith("cannot be recorded, its type std_msgs/msg/String is not installed here")
    assert told.endswith("(1 times)")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_recorder_that_is_told_to_stop_closes_its_bag(graph: Graph, number: signal.Signals) -> None:
    parameters = ["--ros-args", "-p", f"folder:={graph.bags}", "-p", "name:=run"]
    process = graph.process("-m", "bags.recorder", *parameters)
    node = graph.node("talker")
    publisher = node.create_publisher(UInt64, "numbers", 100)
    taken: list[str] = []

    def hear(message: DiagnosticArray) -> None:
        for status in message.status:
            taken.extend(pair.value for pair in status.values if pair.key == "/numbers")

    node.create_subscription(DiagnosticArray, "/diagnostics", hear, 10)
    graph.until(lambda: publisher.get_subscription_count() == 1)
    for value in range(50):
        publisher.publish(UInt64(data=value))
    graph.until(lambda: taken and taken[-1].startswith("50 messages"))
    process.send_signal(number)
    assert process.wait(LIMIT_S) == 0
    with open_bag(graph.bags / "run") as bag:
        assert bag.cut == ""
        assert data_of(bag, "/numbers") == list(range(50))
        assert bag.metadata is not None
        assert bag.metadata.message_count == sum(row.message_count for row in bag.topics)


def test_a_recorder_that_was_killed_goes_on_in_its_bag(graph: Graph) -> None:
    parameters = {"folder": graph.bags, "name": "run", "resume": True, "flush_period_s": 0.1}
    arguments = [part for name, value in parameters.items() for part in ("-p", f"{name}:={value}")]
    publisher = graph.node("talker").create_publisher(UInt64, "numbers", 1000)
    said = itertools.count()
    flushed = []
    for run, end in enumerate((signal.SIGKILL, signal.SIGINT)):
        process = graph.process("-m", "bags.recorder", "--ros-args", *arguments)

        def hears_enough(path: Path = graph.bags / "run" / f"run_{run}.mcap") -> bool:
            for value in itertools.islice(said, 10):
                publisher.publish(UInt64(data=value))
            return len(numbers_in(path)) >= 50

        graph.until(hears_enough)
        flushed.append(numbers_in(graph.bags / "run" / f"run_{run}.mcap"))
        process.send_signal(end)
        assert process.wait(LIMIT_S) == (0 if end == signal.SIGINT else -end)
    with open_bag(graph.bags / "run") as bag:
        assert bag.cut == ""
        numbers = data_of(bag, "/numbers")
        counts = {row.name: row.message_count for row in bag.topics}
        assert bag.metadata is not None
        assert [row.name for row in bag.metadata.files] == ["run_0.mcap", "run_1.mcap"]
        assert bag.metadata.message_count == sum(counts.values()) == sum(1 for _ in bag.raw_messages())
        assert bag.manifest is not None
    for before in flushed:
        begin = numbers.index(before[0])
        assert numbers[begin : begin + len(before)] == before == list(range(before[0], before[-1] + 1))
    assert numbers == sorted(set(numbers))
    with Reader(graph.bags / "run") as reader:
        assert {topic: told.msgcount for topic, told in reader.topics.items()} == counts
        assert reader.message_count == sum(1 for _ in reader.messages())


def numbers_in(path: Path) -> list[int]:
    """What is on the disk so far of a file that may be being written."""
    if not path.exists() or not path.stat().st_size:  # it was begun just now
        return []
    with open_bag(path) as bag:
        return data_of(bag, "/numbers")
