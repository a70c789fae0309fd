"""The base of every node: life cycle, parameters, contract, and callbacks that cannot kill it."""

import threading
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import DescribeParameters, SetParameters
from rclpy.parameter import Parameter as NodeParameter
from std_msgs.msg import String
from std_srvs.srv import Trigger

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.errors import BadParameterError, ContractError, RobustnavError
from robustnav_msgs_py.parameters import parameter
from robustnav_msgs_py.values import ERROR, OK, WARN
from robustnav_nodes.graph.node import GraphNode
from tests.bench import Bench


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoParameters:
    """Parameters of the node under test."""

    volume: float = parameter(0.5, "how loud", unit="dB", low=0.0, high=2.0)


class Echo(GraphNode[EchoParameters]):
    """Says what it hears, as the dialogue would; stumbles over some words."""

    executable: ClassVar[str] = "dialogue"
    declaration: ClassVar[type] = EchoParameters

    def configure(self) -> None:
        if self.parameters.volume == 2.0:
            raise RobustnavError("too loud")
        self.said: list[str] = []
        self.names: list[tuple[str, ...]] = []
        self.answers = self.publisher("chat/to_user")
        self.subscribe("chat/from_user", wire.text_from_message, self.on_line)
        self.subscribe("detections/labels", wire.labels_from_message, self.names.append)

    def on_line(self, line: str) -> None:
        if line == "bad":
            raise RobustnavError("a bad line")
        if line == "bug":
            raise KeyError(line)
        self.said.append(line)
        self.answers.publish(wire.text_to_message(line))


class Served(GraphNode[EchoParameters]):
    """Serves as the planner would; its services fail."""

    executable: ClassVar[str] = "planner"
    declaration: ClassVar[type] = EchoParameters

    def configure(self) -> None:
        self.serve("~/start", self.on_start)
        self.serve("~/stop", self.on_stop)

    def on_start(self, _request: Any, _response: Any) -> Any:
        raise RobustnavError("nothing to start")

    def on_stop(self, _request: Any, _response: Any) -> Any:
        raise ZeroDivisionError


def up(node: GraphNode[Any]) -> None:
    node.trigger_configure()
    node.trigger_activate()


def test_the_life_cycle_goes_round_twice(bench: Bench) -> None:
    node = bench.add(Echo())
    for _ in range(2):
        assert node.state_id == State.PRIMARY_STATE_UNCONFIGURED
        up(node)
        assert node.state_id == State.PRIMARY_STATE_ACTIVE
        assert node.is_active
        node.trigger_deactivate()
        node.trigger_cleanup()
    up(node)
    node.trigger_shutdown()
    assert node.state_id == State.PRIMARY_STATE_FINALIZED
    assert not node.is_active


def test_an_impossible_transition_is_answered_and_the_node_lives_on(bench: Bench) -> None:
    node = bench.add(Echo())
    wanted = ChangeState.Request(transition=Transition(id=Transition.TRANSITION_ACTIVATE))
    assert not bench.call(ChangeState, "dialogue/change_state", wanted).success
    wanted.transition.id = Transition.TRANSITION_CONFIGURE
    assert bench.call(ChangeState, "dialogue/change_state", wanted).success
    assert node.state_id == State.PRIMARY_STATE_INACTIVE


def test_a_configure_that_raises_fails_the_transition_and_can_be_tried_again(bench: Bench) -> None:
    node = bench.add(Echo(parameter_overrides=[NodeParameter("volume", value=2.0)]))
    node.trigger_configure()
    assert node.state_id == State.PRIMARY_STATE_UNCONFIGURED
    status = node.health.status("x", [])
    assert (status.level, status.message) == (ERROR, "too loud")
    node.set_parameters([NodeParameter("volume", value=1.0)])
    up(node)
    assert node.is_active


def test_a_callback_that_raises_is_shown_and_the_next_message_is_heard(bench: Bench) -> None:
    node = bench.add(Echo())
    up(node)
    speaker = bench.speaker("chat/from_user")
    for line, level in (("bad", WARN), ("bug", ERROR)):
        speaker.publish(wire.text_to_message(line))
        bench.wait(lambda level=level: node.health.status("x", []).level == level, f"level {level}")
    speaker.publish(wire.text_to_message("good"))
    bench.wait(lambda: node.said == ["good"], "the good line")


def test_diagnostics_come_each_second_and_name_what_is_waited_for(bench: Bench) -> None:
    node = bench.add(Echo())
    diagnostics = bench.hear("/diagnostics")
    up(node)
    bench.wait(lambda: len(diagnostics) >= 2, "two diagnostics")
    status = wire.status_from_message(diagnostics[-1].status[0])
    assert (status.name, status.level) == ("/dialogue", OK)
    assert status.message == "waiting for chat/from_user, detections/labels"


def test_latched_words_that_come_before_activation_are_held(bench: Bench) -> None:
    node = bench.add(Echo())
    node.trigger_configure()
    bench.speaker("detections/labels").publish(wire.labels_to_message(("mug",)))
    bench.wait(lambda: node._held, "the held labels")
    assert node.names == []
    node.trigger_activate()
    assert node.names == [("mug",)]


def test_a_service_that_fails_says_so(bench: Bench) -> None:
    node = bench.add(Served())
    node.trigger_configure()
    assert bench.call(Trigger, "planner/start", Trigger.Request()).message == "planner is not active"
    node.trigger_activate()
    answer = bench.call(Trigger, "planner/start", Trigger.Request())
    assert (answer.success, answer.message) == (False, "nothing to start")
    answer = bench.call(Trigger, "planner/stop", Trigger.Request())
    assert not answer.success
    assert "its log" in answer.message


def test_parameters_are_described_checked_and_changed(bench: Bench) -> None:
    node = bench.add(Echo())
    told = bench.call(
        DescribeParameters, "dialogue/describe_parameters", DescribeParameters.Request(names=["volume"])
    )
    described = told.descriptors[0]
    assert described.description == "how loud [dB, 0 .. 2]"
    assert described.floating_point_range[0].to_value == 2.0

    def set_volume(value: ParameterValue) -> Any:
        request = SetParameters.Request(parameters=[Parameter(name="volume", value=value)])
        return bench.call(SetParameters, "dialogue/set_parameters", request).results[0]

    refused = set_volume(ParameterValue(type=3, double_value=7.0))
    assert not refused.successful
    assert set_volume(ParameterValue(type=4, string_value="loud")).reason.startswith(
        "parameter 'volume' is 'loud'"
    )
    assert node.parameters.volume == 0.5
    assert set_volume(ParameterValue(type=2, integer_value=1)).successful
    assert node.parameters.volume == 1.0


@pytest.mark.parametrize("value", [7.0, "loud", float("nan")])
def test_a_node_does_not_start_with_a_parameter_that_does_not_fit(bench: Bench, value: Any) -> None:
    with pytest.raises(BadParameterError, match="volume"):
        Echo(parameter_overrides=[NodeParameter("volume", value=value)])


def test_a_misspelt_parameter_is_reported(bench: Bench) -> None:
    node = bench.add(Echo(parameter_overrides=[NodeParameter("volum", value=1.0)]))
    assert "misspelt" in node.health.status("x", []).message


def test_only_what_the_contract_lists_can_be_used(bench: Bench) -> None:
    node = bench.add(Echo())
    with pytest.raises(ContractError, match="no speaker"):
        node.publisher("cmd_vel")
    with pytest.raises(ContractError, match="no listener"):
        node.subscribe("map", wire.map_from_message, print)
    with pytest.raises(ContractError, match="no service"):
        node.serve("~/dance", lambda request, response: response)


def test_work_in_a_thread_comes_back_and_its_errors_are_shown(bench: Bench) -> None:
    node = bench.add(Echo())
    up(node)
    done: list[int] = []
    failed: list[bool] = []
    worker = node.worker("sums", failed=lambda: failed.append(True))
    worker.submit(lambda: 6 * 7, done.append)
    bench.wait(lambda: done == [42], "the sum")
    worker.submit(lambda: 1 // 0, done.append)
    bench.wait(lambda: failed, "the failure")
    assert "ZeroDivisionError" in node.health.status("x", []).message
    assert not worker.busy


def test_a_worker_is_free_again_after_its_node_was_away(bench: Bench) -> None:
    node = bench.add(Echo())
    up(node)
    worker = node.worker("sums")
    done: list[int] = []
    release = threading.Event()
    worker.submit(lambda: int(release.wait(20.0)), done.append)
    node._active = False  # as while it is deactivated
    release.set()
    bench.wait(lambda: not worker.busy, "the worker to be free")
    assert done == []


def test_a_node_that_fails_on_its_way_down_goes_down(bench: Bench) -> None:
    node = bench.add(Echo())
    up(node)
    node.deactivate = lambda: 1 // 0
    node.cleanup = lambda: 1 // 0
    node.trigger_deactivate()
    assert node.state_id == State.PRIMARY_STATE_INACTIVE
    node.trigger_cleanup()
    assert node.state_id == State.PRIMARY_STATE_UNCONFIGURED
    assert "ZeroDivisionError" in node.health.status("x", []).message


def test_somebody_who_does_not_latch_is_named(bench: Bench) -> None:
    node = bench.add(Echo())
    up(node)
    bench.outside.create_publisher(String, "detections/labels", 10)
    words = "'outside' publishes detections/labels volatile"
    bench.wait(lambda: words in node.health.status("x", []).message, "the warning")
