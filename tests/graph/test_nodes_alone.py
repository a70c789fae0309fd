"""Each node starts alone, waits for its inputs without complaint, describes its parameters, stops cleanly."""

import os
import select
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.srv import DescribeParameters, ListParameters
from rclpy.node import NodeNameNonExistentError

from robustnav_msgs_py import contract
from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.parameters import specs
from robustnav_msgs_py.values import OK
from robustnav_nodes.docs import PARAMETER_FILE
from robustnav_nodes.graph.manager import MANAGED
from robustnav_nodes.graph.one_process import node_class
from robustnav_nodes.graph.processes import ProcessPlan
from robustnav_nodes.graph.search_graph import RunPlan
from tests.bench import Bench

DEADLINE_S = 30.0
OF_EVERY_NODE = {"/parameter_events", "/rosout"}
ALL = [row for row in contract.NODES if row.executable != "manager"]
ROWS = [row for row in ALL if row.in_graph]


@contextmanager
def running(package: str, executable: str, *arguments: str) -> Iterator["subprocess.Popen[str]"]:
    """A node's process, as `robustnav run` starts it."""
    with started("-m", "robustnav_nodes", "run", package, executable, "--ros-args", *arguments) as process:
        yield process


@contextmanager
def started(*arguments: str) -> Iterator["subprocess.Popen[str]"]:
    """A Python of its own, killed if a test leaves it running."""
    command, pipe = [sys.executable, *arguments], subprocess.PIPE
    process = subprocess.Popen(command, stdout=pipe, stderr=subprocess.STDOUT, text=True)
    watchdog = threading.Timer(2 * DEADLINE_S, process.kill)
    watchdog.start()
    try:
        yield process
    finally:
        watchdog.cancel()
        process.kill()
        process.communicate()


def namespace(row: contract.NodeRow) -> str:
    """One that no other test has used: DDS may still tell of nodes that are gone."""
    return f"/{row.executable}_alone"


def full_name(topic: contract.Topic, row: contract.NodeRow) -> str:
    return topic.name if topic.name.startswith("/") else f"{namespace(row)}/{topic.name}"


def wait_for_line(process: "subprocess.Popen[str]", words: str) -> None:
    assert process.stdout is not None
    heard = []
    for line in process.stdout:
        heard.append(line)
        if words in line:
            return
    raise AssertionError(f"{words!r} never came; the process said: {''.join(heard)}")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.executable)
def test_a_node_alone(row: contract.NodeRow, number: signal.Signals, bench: Bench, tmp_path: Path) -> None:
    alone = ["-r", f"__ns:={namespace(row)}"]
    where = ["-p", f"folder:={tmp_path}"] if row.executable == "recorder" else []
    with running(row.package, row.executable, *alone, *where) as process:
        wait_for_line(process, f"{row.executable} is active")
        if number is signal.SIGINT:  # once for each node is enough
            check_contract(bench, row)
            check_parameters(bench, row)
            check_health(bench, row)
        process.send_signal(number)
        output, _ = process.communicate(timeout=DEADLINE_S)
        assert process.returncode == 0, output
        assert "Traceback" not in output


def check_contract(bench: Bench, row: contract.NodeRow) -> None:
    """Its topics are those that the contract lists, with their types: no more, no fewer."""

    def found(names_and_types: Callable[[str, str], list[tuple[str, list[str]]]]) -> dict[str, str]:
        try:
            every = dict(names_and_types(row.executable, namespace(row)))
        except NodeNameNonExistentError:  # not discovered yet
            return {}
        return {name: types[0] for name, types in every.items() if name not in OF_EVERY_NODE}

    def listed(topics: tuple[contract.Topic, ...]) -> dict[str, str]:
        return {full_name(topic, row): topic.type for topic in topics}

    says, hears = listed(contract.spoken_by(row.executable)), listed(contract.heard_by(row.executable))
    outside = bench.outside
    bench.wait(
        lambda: found(outside.get_publisher_names_and_types_by_node).keys() >= says.keys(), "its topics"
    )
    bench.wait(
        lambda: found(outside.get_subscriber_names_and_types_by_node).keys() >= hears.keys(), "its ears"
    )
    said = found(outside.get_publisher_names_and_types_by_node)
    assert {name: kind for name, kind in said.items() if not name.endswith("/transition_event")} == says
    if row.executable != "recorder":  # which hears whatever there is
        assert found(outside.get_subscriber_names_and_types_by_node) == hears


def check_parameters(bench: Bench, row: contract.NodeRow) -> None:
    """What the declaration says is what a caller is told."""
    told = bench.call(
        ListParameters, f"{namespace(row)}/{row.executable}/list_parameters", ListParameters.Request()
    )
    declared = {spec.name: spec for spec in specs(node_class(row.package, row.executable).declaration)}
    assert set(declared) <= set(told.result.names)
    request = DescribeParameters.Request(names=list(declared))
    for described in bench.call(
        DescribeParameters, f"{namespace(row)}/{row.executable}/describe_parameters", request
    ).descriptors:
        spec = declared[described.name]
        assert described.description == spec.full_description
        ranges = [*described.floating_point_range, *described.integer_range]
        assert [(item.from_value, item.to_value) for item in ranges] == (
            [(spec.low, spec.high)] if spec.low is not None else []
        )


def check_health(bench: Bench, row: contract.NodeRow) -> None:
    """It says what it waits for, and that this is no problem."""
    statuses: list[Any] = []

    def hear(message: Any) -> None:
        found = [wire.status_from_message(status) for status in message.status]
        statuses.extend(status for status in found if status.name == f"{namespace(row)}/{row.executable}")

    bench.outside.create_subscription(DiagnosticArray, "/diagnostics", hear, 10)
    bench.wait(lambda: statuses, "diagnostics")
    assert statuses[-1].level == OK, statuses[-1]


@pytest.mark.parametrize(
    ("package", "executable", "given", "words"),
    [
        ("robustnav_nodes", "planner", "discount:=1.5", "'discount' is 1.5; it must lie in 0.01 .. 0.999999"),
        ("bags", "recorder", "patience_s:=-1.0", "'patience_s' is -1.0; it must lie in 0 .. 60 s"),
    ],
)
def test_a_parameter_out_of_range_is_a_sentence_and_an_exit_code(
    package: str, executable: str, given: str, words: str
) -> None:
    with running(package, executable, "-p", given) as process:
        output, _ = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 2
    assert output.strip().endswith(f"parameter {words}")
    assert "Traceback" not in output


def test_a_folder_that_cannot_be_written_is_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    with running("bags", "recorder", "-p", f"folder:={tmp_path}/file/bags") as process:
        wait_for_line(process, f"{tmp_path}/file")
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 0


def test_nothing_of_the_middleware_runs_on_when_the_nodes_have_ended() -> None:
    """A process can die of threads that are left when Python goes. Fast DDS keeps one that watches memory."""
    code = (
        "from pathlib import Path; from robustnav_nodes.dialogue import node\n"
        "def threads():\n"
        "    comms = Path('/proc/self/task').glob('*/comm')\n"
        "    names = [comm.read_text().strip() for comm in comms]\n"
        "    return [name for name in names if name.startswith('dds.') and name != 'dds.shm.wdog']\n"
        "class Dialogue(node.Dialogue):\n"
        "    at_work = []\n"
        "    def activate(self):\n"
        "        super().activate()\n"
        "        self.at_work.extend(threads())\n"
        "node.Dialogue = Dialogue\n"
        "node.main()\n"
        "print(f'{len(Dialogue.at_work) > 0} left: {threads()}')"
    )
    with started("-c", code) as process:
        wait_for_line(process, "dialogue is active")
        process.send_signal(signal.SIGINT)
        output, _ = process.communicate(timeout=DEADLINE_S)
    assert output.splitlines()[-1] == "True left: []"
    assert process.returncode == 0


def test_an_executable_that_does_not_exist_is_a_sentence() -> None:
    with running("robustnav_nodes", "plannner") as process:
        output, _ = process.communicate(timeout=DEADLINE_S)
    assert process.returncode == 1
    assert "robustnav_nodes planner" in output
    assert "Traceback" not in output


@pytest.mark.parametrize("row", ALL, ids=lambda row: row.executable)
def test_the_shipped_parameter_file_fits_every_node_in_any_namespace(
    row: contract.NodeRow, bench: Bench
) -> None:
    arguments = [
        "--ros-args",
        "--params-file",
        str(PARAMETER_FILE),
        "-r",
        "__ns:=/robot1",
        "-p",
        "autostart:=false",
    ]
    rclpy.shutdown()
    rclpy.init(args=arguments)
    node = node_class(row.package, row.executable)()
    given = node._parameter_overrides
    assert {spec.name for spec in specs(node.declaration) if spec.default != []} <= set(given)
    assert node.parameters == node.declaration()
    node.destroy_node()


def test_a_run_of_the_graph_starts_no_node_that_is_started_by_hand() -> None:
    started = {row.executable for row in RunPlan(bag=Path("bag"), parameters={}).nodes}
    assert started == {row.executable for row in contract.NODES} - {"player"}
    assert set(MANAGED) == started - {"manager"}


def test_nodes_end_with_the_process_that_started_them(tmp_path: Path) -> None:
    """A graph that is killed leaves no node behind to drive a robot."""
    plan = ProcessPlan(package="robustnav_nodes", executable="dialogue")
    code = (
        "import sys; from robustnav_nodes.graph.processes import *\n"
        f"graph = ProcessGraph([{plan!r}], lambda name, line: print(line, flush=True), print)\n"
        "graph.start(); print(graph.pid('dialogue'), flush=True); sys.stdin.read()"
    )
    pipe = subprocess.PIPE
    parent = subprocess.Popen([sys.executable, "-c", code], stdin=pipe, stdout=pipe, text=True)
    assert parent.stdout is not None
    child = int(parent.stdout.readline())
    wait_for_line(parent, "dialogue is active")
    parent.kill()
    parent.communicate()
    end = os.pidfd_open(child)
    assert select.select([end], [], [], DEADLINE_S)[0], "the node lives on"
