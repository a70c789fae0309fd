"""The player in a real graph: what was recorded arrives, byte for byte and in order."""

import array
import signal
import subprocess
import sys
from collections import defaultdict
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from lifecycle_msgs.msg import State
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image
from std_msgs.msg import String, UInt64
from std_srvs.srv import SetBool, Trigger

from bags import topic_speaker
from bags.definitions import MessageDefinition, message_definition
from bags.manifest import Manifest
from bags.offered_qos import OfferedQos
from bags.player import Player
from bags.reader import open_bag
from bags.recorder import Recorder
from bags.writer import BagWriter
from robustnav_msgs_py.conversions import status_from_message
from robustnav_msgs_py.errors import BadFileError, BadParameterError
from robustnav_nodes.graph.message_class import message_class
from tests.bench import DEADLINE_S, Bench

PREFIXES = (Path(sys.prefix),)
S = 1_000_000_000
BEGIN_NS = 1_790_000_000 * S
LATCHED = OfferedQos(durability="transient_local", history="unknown", depth=0)
BEST_EFFORT = OfferedQos(reliability="best_effort", history="unknown", depth=0)
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
ASK_LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
ALL = QoSProfile(depth=5000)

Spoken = tuple[str, float, Any]


def write(folder: Path, *spoken: Spoken, offers: dict[str, OfferedQos] | None = None) -> Path:
    """A bag of messages: topic, second of the bag, and message."""
    with BagWriter(folder, manifest=Manifest(version="0", wall_start_ns=1)) as writer:
        channels: dict[str, int] = {}
        for topic, second, message in spoken:
            if topic not in channels:
                package = type(message).__module__.split(".")[0]
                definition = message_definition(f"{package}/msg/{type(message).__name__}", PREFIXES)
                told = (offers or {}).get(topic)
                channels[topic] = writer.add_topic(topic, definition, [told] if told else [])
            at_ns = BEGIN_NS + round(second * S)
            data = serialize_message(message)
            writer.write(channels[topic], log_time_ns=at_ns, publish_time_ns=at_ns, data=data)
    return folder


def recorded(folder: Path) -> dict[str, list[bytes]]:
    """The bytes of each topic, in order."""
    found = defaultdict(list)
    with open_bag(folder) as bag:
        for raw in bag.raw_messages():
            found[raw.topic].append(raw.data)
    return found


def text(number: int) -> String:
    return String(data=f"text {number}")


class Stage:
    """A player on a bench, and what is heard of it."""

    def __init__(self, bench: Bench) -> None:
        self.bench = bench

    def player(self, bag: Path, **parameters: Any) -> Player:
        """A player that is active, and waits for its listeners as long as it takes."""
        given = {"bag": str(bag), "wait_for_s": 60.0, **parameters}
        overrides = [Parameter(name, value=value) for name, value in given.items()]
        player: Player = self.bench.add(Player(parameter_overrides=overrides))
        player.trigger_configure()
        player.trigger_activate()
        assert player.state_id == State.PRIMARY_STATE_ACTIVE
        return player

    def hear(self, kind: type, topic: str, qos: QoSProfile = ALL) -> list[bytes]:
        """The bytes that come on a topic."""
        heard: list[bytes] = []
        self.bench.outside.create_subscription(kind, topic, heard.append, qos, raw=True)
        return heard

    def until(self, holds: Callable[[], Any]) -> None:
        self.bench.wait(holds, "what the player should do")

    def until_end(self, player: Player) -> None:
        self.until(lambda: player.exit_code is not None)

    def call(self, kind: Any, service: str, **fields: Any) -> Any:
        return self.bench.call(kind, f"/player/{service}", kind.Request(**fields))


@pytest.fixture
def stage(bench: Bench) -> Stage:
    return Stage(bench)


@pytest.fixture
def texts(tmp_path: Path) -> Path:
    """Twenty texts, ten milliseconds apart."""
    return write(tmp_path / "texts", *(("/words", 0.01 * number, text(number)) for number in range(20)))


def test_every_message_arrives_with_its_bytes_and_in_order(stage: Stage, tmp_path: Path) -> None:
    image = Image(height=48, width=64, step=192, encoding="rgb8")
    image.data = array.array("B", bytes(range(256)) * 36)
    spoken: list[Spoken] = [("/image", 0.001 * number, image) for number in range(30)]
    spoken += [("/words", 0.0001 * number, text(number)) for number in range(300)]
    spoken += [("/robot1/number", 0.0002 * number, UInt64(data=number)) for number in range(150)]
    bag = write(tmp_path / "bag", *spoken, offers={"/image": BEST_EFFORT})
    heard = {
        "/image": stage.hear(
            Image, "/image", QoSProfile(depth=50, reliability=ReliabilityPolicy.BEST_EFFORT)
        ),
        "/words": stage.hear(String, "/words"),
        "/robot1/number": stage.hear(UInt64, "/robot1/number"),
    }
    player = stage.player(bag)
    stage.until_end(player)
    stage.until(lambda: sum(map(len, heard.values())) == len(spoken))
    assert heard == recorded(bag)
    assert player.exit_code == 0


def test_a_late_listener_gets_what_was_latched(stage: Stage, tmp_path: Path) -> None:
    bag = write(tmp_path / "bag", *(("/map", 0.1 * n, text(n)) for n in range(3)), offers={"/map": LATCHED})
    player = stage.player(bag, wait_for_s=0.0, autostart=False)
    stage.until(lambda: player.health.status("", []).values.get("state") == "at the end")
    heard = stage.hear(String, "/map", ASK_LATCHED)
    stage.until(lambda: heard)
    assert heard == recorded(bag)["/map"][-1:]


def test_a_late_start_says_first_what_was_latched_before(stage: Stage, tmp_path: Path) -> None:
    spoken = [
        ("/map", 0.0, text(0)),
        ("/words", 1.0, text(1)),
        ("/map", 2.0, text(2)),
        ("/words", 7.0, text(3)),
    ]
    bag = write(tmp_path / "bag", *spoken, offers={"/map": LATCHED})
    order: list[str] = []
    for topic in ("/map", "/words"):
        stage.bench.outside.create_subscription(String, topic, lambda message: order.append(message.data), 10)
    stage.until_end(stage.player(bag, start_s=6.99))
    stage.until(lambda: len(order) == 2)
    assert order == ["text 2", "text 3"]


def test_pause_step_and_reset(stage: Stage, texts: Path) -> None:
    heard = stage.hear(String, "/words")
    expected = recorded(texts)["/words"]
    player = stage.player(texts, start_paused=True, wait_for_s=0.0)
    stage.until(lambda: player._speaking.listeners() == 1)
    for count in (1, 2):
        answer = stage.call(Trigger, "step")
        assert (answer.success, answer.message) == (True, f"/words at {0.01 * (count - 1):.6f} s")
        stage.until(lambda expected_count=count: len(heard) == expected_count)
    assert stage.call(Trigger, "reset").success
    assert stage.call(Trigger, "step").message == "/words at 0.000000 s"
    stage.until(lambda: len(heard) == 3)
    assert stage.call(SetBool, "pause", data=False).message == "time goes on"
    stage.until_end(player)
    stage.until(lambda: len(heard) == 22)
    assert heard == [*expected[:2], *expected]
    refused = stage.call(Trigger, "step")
    assert not refused.success
    assert "time is not paused" in refused.message


def test_a_player_that_is_paused_says_nothing(stage: Stage, tmp_path: Path) -> None:
    bag = write(tmp_path / "bag", *(("/words", 0.5 * number, text(number)) for number in range(100)))
    heard = stage.hear(String, "/words")
    player = stage.player(bag, rate=100.0)
    stage.until(lambda: len(heard) >= 3)
    assert stage.call(SetBool, "pause", data=True).message == "time stands"
    sent, at_ns = player._sent, player._playback.time_ns(player.steady_s())
    for _ in range(3):
        player._run()
    assert (player._sent, player._playback.time_ns(player.steady_s())) == (sent, at_ns)
    assert player.exit_code is None
    assert stage.call(SetBool, "pause", data=False).success
    stage.until_end(player)
    stage.until(lambda: heard == recorded(bag)["/words"])


def test_a_loop_begins_again_and_its_clock_goes_back(stage: Stage, texts: Path) -> None:
    heard, clock = stage.hear(String, "/words"), stage.hear(Clock, "/clock")
    player = stage.player(texts, loop=True, clock_hz=200.0)
    stage.until(lambda: len(heard) >= 45)
    expected = recorded(texts)["/words"]
    assert heard[:45] == (3 * expected)[:45]
    assert player.exit_code is None
    player.set_parameters([Parameter("loop", value=False)])
    stage.until_end(player)
    stage.until(lambda: len(heard) % 20 == 0)
    stamps = [deserialize_message(data, Clock).clock for data in clock]
    times_ns = [stamp.sec * S + stamp.nanosec for stamp in stamps]
    assert all(BEGIN_NS <= time_ns <= BEGIN_NS + 0.19 * S for time_ns in times_ns)
    assert any(later < earlier for earlier, later in pairwise(times_ns))


def test_a_recorded_clock_is_played_and_no_other_is_said(stage: Stage, tmp_path: Path) -> None:
    bag = write(tmp_path / "bag", *(("/clock", 0.01 * number, Clock()) for number in range(5)))
    heard = stage.hear(Clock, "/clock")
    player = stage.player(bag, clock_hz=1000.0)
    stage.until_end(player)
    stage.until(lambda: len(heard) == 5)
    assert [info.node_name for info in player.get_publishers_info_by_topic("/clock")] == ["player"]


def test_a_type_that_is_not_installed_is_left_out_and_said(
    stage: Stage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> Any:
        if name == "std_msgs/msg/UInt64":
            raise ModuleNotFoundError("No module named 'std_msgs'")
        return message_class(name)

    monkeypatch.setattr(topic_speaker, "message_class", missing)
    bag = write(tmp_path / "bag", ("/words", 0.0, text(0)), ("/number", 0.0, UInt64(data=1)))
    heard = stage.hear(String, "/words")
    player = stage.player(bag)
    stage.until_end(player)
    stage.until(lambda: len(heard) == 1)
    told = player.health.status("", []).values["problem /number"]
    assert told.startswith("is left out, its type std_msgs/msg/UInt64 is not installed here")


def test_names_and_types_that_are_none_are_left_out(stage: Stage, tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    with BagWriter(bag, manifest=Manifest(version="0", wall_start_ns=1)) as writer:
        for topic, kind in (
            ("/a b", "std_msgs/msg/String"),
            ("/c", "os/path"),
            ("/d", "std_msgs/msg/String"),
        ):
            channel = writer.add_topic(topic, MessageDefinition(type=kind, text="", type_hash=""))
            writer.write(channel, log_time_ns=1, publish_time_ns=1, data=serialize_message(text(0)))
    heard = stage.hear(String, "/d")
    player = stage.player(bag)
    stage.until_end(player)
    stage.until(lambda: len(heard) == 1)
    told = player.health.status("", []).values
    assert "cannot be played" in told["problem /a b"]
    assert "its type 'os/path' is no type of ROS 2 messages" in told["problem /c"]


def test_bytes_that_are_no_message_do_not_keep_back_the_others(stage: Stage, tmp_path: Path) -> None:
    bag = tmp_path / "bag"
    with BagWriter(bag, manifest=Manifest(version="0", wall_start_ns=1)) as writer:
        channel = writer.add_topic("/words", message_definition("std_msgs/msg/String", PREFIXES))
        for data in (b"", b"\0\1\0", serialize_message(text(0))):
            writer.write(channel, log_time_ns=1, publish_time_ns=1, data=data)
    heard = stage.hear(String, "/words")
    player = stage.player(bag)
    stage.until_end(player)
    stage.until(lambda: heard == [serialize_message(text(0))])
    told = player.health.status("", []).values
    assert told["problem /words"] == "a message of 3 bytes, which is none, is left out (2 times)"
    assert told["messages sent"] == "1"


def test_topics_of_unlike_types_are_not_mapped_onto_one(
    tmp_path: Path, run: Callable[..., "subprocess.Popen[str]"]
) -> None:
    bag = write(tmp_path / "bag", ("/number", 0.0, UInt64(data=1)), ("/words", 0.0, text(0)))
    process = run(str(bag), "--ros-args", "-r", "/words:=/number", "-p", "wait_for_s:=0.0")
    output, _ = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 0, output
    assert "/words: cannot be played" in output
    assert "1 messages played" in output


def test_a_bag_of_which_ros_takes_nothing_ends_with_a_sentence(
    tmp_path: Path, run: Callable[..., "subprocess.Popen[str]"]
) -> None:
    bag = write(tmp_path / "bag", ("/a b", 0.0, text(0)))
    process = run(str(bag))
    output, _ = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 1
    assert "ROS takes none of the topics of" in output
    assert "Traceback" not in output


def test_what_cannot_be_played_is_refused_at_once(stage: Stage, texts: Path, tmp_path: Path) -> None:
    unknown = tmp_path / "unknown"
    with BagWriter(unknown, manifest=Manifest(version="0", wall_start_ns=1)) as writer:
        channel = writer.add_topic("/a", MessageDefinition(type="no_msgs/msg/None", text="", type_hash=""))
        writer.write(channel, log_time_ns=1, publish_time_ns=1, data=b"\0\1\0\0")
    refused = [
        ({"bag": ""}, BadParameterError, "which bag is to be played"),
        ({"bag": str(tmp_path / "none")}, BadFileError, "there is no bag"),
        (
            {"bag": str(unknown)},
            BadFileError,
            "can be played; '/a' is left out, its type no_msgs/msg/None is",
        ),
        ({"bag": str(texts), "include": "["}, BadParameterError, "'include' is '\\['; it is no regular"),
        ({"bag": str(texts), "start_s": 1.0}, BadParameterError, "only 0.19 s long"),
        ({"bag": str(texts), "rate": 0.0}, BadParameterError, "'rate' is 0.0; it must lie in 0.01 .. 100"),
        ({"bag": str(texts), "rate": float("nan")}, BadParameterError, "'rate' is nan; it must be a finite"),
    ]
    for parameters, error, words in refused:
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        with pytest.raises(error, match=words):
            Player(parameter_overrides=overrides)


def test_a_cut_bag_is_played_as_far_as_it_is_whole_and_says_so(stage: Stage, tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    with BagWriter(whole, manifest=Manifest(version="0", wall_start_ns=1), chunk_bytes=1024) as writer:
        channel = writer.add_topic("/words", message_definition("std_msgs/msg/String", PREFIXES))
        for number in range(400):
            data = serialize_message(text(number))
            writer.write(channel, log_time_ns=number + 1, publish_time_ns=number + 1, data=data)
    content = (whole / "whole_0.mcap").read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(content[: len(content) // 2])
    expected = recorded(cut)["/words"]
    heard = stage.hear(String, "/words")
    player = stage.player(cut)
    stage.until_end(player)
    stage.until(lambda: len(heard) == len(expected))
    assert heard == expected == recorded(whole)["/words"][: len(expected)]
    assert "was not closed properly" in player.health.status("", []).values["problem bag"]
    assert player.exit_code == 0


def test_a_bag_that_is_damaged_inside_ends_with_a_sentence(stage: Stage, tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    with BagWriter(whole, manifest=Manifest(version="0", wall_start_ns=1), chunk_bytes=1024) as writer:
        channel = writer.add_topic("/words", message_definition("std_msgs/msg/String", PREFIXES))
        for number in range(400):
            data = serialize_message(text(number))
            writer.write(channel, log_time_ns=number + 1, publish_time_ns=number + 1, data=data)
    content = bytearray((whole / "whole_0.mcap").read_bytes())
    chunk = content.index(ZSTD_MAGIC, len(content) // 2)
    content[chunk : chunk + 8] = bytes(8)
    (whole / "whole_0.mcap").write_bytes(content)
    heard = stage.hear(String, "/words")
    player = stage.player(whole)
    stage.until_end(player)
    stage.until(lambda: heard)
    assert player.exit_code == 1
    assert "is damaged inside" in player.health.status("", []).values["problem bag"]


def test_progress_stands_in_the_diagnostics(stage: Stage, texts: Path) -> None:
    told: list[dict[str, str]] = []

    def hear(message: DiagnosticArray) -> None:
        statuses = [status_from_message(status) for status in message.status]
        told.extend(dict(status.values) for status in statuses if status.name == "/player")

    stage.bench.outside.create_subscription(DiagnosticArray, "/diagnostics", hear, 10)
    stage.hear(String, "/words")
    stage.player(texts)
    stage.until(lambda: told and told[-1].get("state") == "at the end")
    assert told[-1]["messages sent"] == "20"
    assert told[-1]["time in the bag, s"] == told[-1]["length, s"] == "0.19"
    assert "late at most, ms" in told[-1]


def test_a_bag_played_into_a_recorder_gives_an_equal_bag(stage: Stage, tmp_path: Path) -> None:
    spoken: list[Spoken] = [("/map", 0.0, text(0))]
    spoken += [("/words", 0.001 * number, text(number)) for number in range(1, 400)]
    spoken += [("/robot1/number", 0.0005 * number, UInt64(data=number)) for number in range(800)]
    bag = write(tmp_path / "bag", *spoken, offers={"/map": LATCHED, "/words": OfferedQos()})
    given = {"folder": str(tmp_path), "name": "again", "discovery_period_s": 0.02}
    overrides = [Parameter(name, value=value) for name, value in given.items()]
    recorder = stage.bench.add(Recorder(parameter_overrides=overrides))
    recorder.trigger_configure()
    recorder.trigger_activate()
    player = stage.player(bag)
    stage.until_end(player)
    first = recorded(bag)

    def counts() -> dict[str, int]:
        return {count.topic: count.messages for count in recorder.counts() if count.topic in first}

    stage.until(lambda: counts() == {topic: len(data) for topic, data in first.items()})
    stage.bench.nodes.remove(recorder)
    recorder.destroy_node()
    again = recorded(tmp_path / "again")
    assert {topic: again[topic] for topic in first} == first
    with open_bag(tmp_path / "again") as opened:
        latched = {row.name: row.offers[0].durability for row in opened.topics if row.name in first}
    assert latched == {"/map": "transient_local", "/words": "volatile", "/robot1/number": "volatile"}


def test_a_player_that_was_taken_down_plays_again_from_the_start(stage: Stage, texts: Path) -> None:
    heard = stage.hear(String, "/words")
    player = stage.player(texts)
    stage.until_end(player)
    player.trigger_deactivate()
    player.trigger_cleanup()
    player.exit_code = None
    player.trigger_configure()
    player.trigger_activate()
    stage.until_end(player)
    stage.until(lambda: len(heard) == 40)
    assert heard == 2 * recorded(texts)["/words"]


# As a process.


@pytest.fixture
def run(tmp_path: Path) -> Iterator[Callable[..., "subprocess.Popen[str]"]]:
    """Starts `python -m bags.player`, killed if a test leaves it running."""
    started: list[subprocess.Popen[str]] = []

    def start(*arguments: str) -> "subprocess.Popen[str]":
        command = [sys.executable, "-m", "bags.player", *arguments]
        pipe = subprocess.PIPE
        started.append(subprocess.Popen(command, stdout=pipe, stderr=subprocess.STDOUT, text=True))
        return started[-1]

    yield start
    for process in started:
        process.kill()
        process.communicate()


def test_the_command_plays_to_the_end_under_remapped_names(
    stage: Stage, texts: Path, run: Callable[..., "subprocess.Popen[str]"]
) -> None:
    heard = stage.hear(String, "/robot1/words")
    process = run(str(texts), "--ros-args", "-r", "/words:=/robot1/words", "-p", "wait_for_s:=20.0")
    stage.until(lambda: len(heard) == 20)
    output, _ = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 0, output
    # Between processes, DDS fills messages up to a multiple of four bytes.
    assert heard == [data + bytes(-len(data) % 4) for data in recorded(texts)["/words"]]
    assert "the bag is at its end: 20 messages played" in output


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["/no/such/bag"], 1, "there is no bag at /no/such/bag"),
        ([], 2, "which bag is to be played? ros2 run bags player BAG"),
        (["a", "b"], 2, "unrecognized arguments: b"),
        (["a", "--ros-args", "-p", "rate:=.nan"], 2, "'rate' is nan; it must be a finite number"),
        (["a", "--ros-args", "-p", "include:=["], 2, "Couldn't parse parameter override rule"),
    ],
)
def test_what_cannot_be_played_is_a_sentence_and_an_exit_code(
    arguments: list[str], code: int, words: str, run: Callable[..., "subprocess.Popen[str]"]
) -> None:
    process = run(*arguments)
    output, _ = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == code
    assert words in output
    assert "Traceback" not in output


def test_a_player_that_is_told_to_stop_leaves(
    texts: Path, run: Callable[..., "subprocess.Popen[str]"]
) -> None:
    process = run(str(texts), "--ros-args", "-p", "loop:=true", "-p", "wait_for_s:=0.0")
    assert process.stdout is not None
    assert any("player is active" in line for line in process.stdout)
    process.send_signal(signal.SIGINT)
    output, _ = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 0, output
    assert "Traceback" not in output
