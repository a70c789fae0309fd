"""Asks every node of the graph for its parameters, as nodes appear, without ever waiting for an answer."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from rcl_interfaces.msg import ParameterEvent
from rcl_interfaces.srv import GetParameters, ListParameters
from rclpy.client import Client
from rclpy.node import Node
from rclpy.parameter import parameter_value_to_python
from rclpy.task import Future

from bags.manifest import NamedParameter, NodeParameters, ParameterValue

ANSWER_LIMIT_S = 5.0
ATTEMPTS = 3
HIDDEN = "_"  # names of nodes that a command-line tool makes for a moment begin with it


@dataclass(slots=True)
class _Question:
    """What is under way with one node: two clients, asked one after the other."""

    node: str
    clients: list[Client] = field(default_factory=list)
    asked_s: float = 0.0
    attempts: int = 0
    answered: bool = False


class ParameterSurvey:
    """Knows the parameters of every node that was seen in the graph and answered.

    Owned by one node; everything happens in its executor's thread. `step()` is to be called now and then:
    it looks for new nodes and asks those whose services are there. A node that is busy may answer late; one
    that leaves and comes back is asked again.
    """

    def __init__(self, node: Node, clock: Callable[[], float] = time.monotonic) -> None:
        self._node = node
        self._clock = clock
        self._seen: set[str] = set()
        self._questions: dict[str, _Question] = {}
        self._answers: dict[str, dict[str, ParameterValue]] = {}

    @property
    def answers(self) -> tuple[NodeParameters, ...]:
        """What the nodes told, by name, with the changes that `take_event` was told of since."""
        return tuple(
            NodeParameters(
                node=name,
                parameters=tuple(NamedParameter(name=key, value=value) for key, value in told.items()),
            )
            for name, told in sorted(self._answers.items())
        )

    @property
    def silent(self) -> tuple[str, ...]:
        """Nodes that were seen and have not told their parameters."""
        return tuple(sorted(self._seen - self._answers.keys()))

    def step(self) -> None:
        """Look for new nodes and move every question on."""
        present = set()
        for name, namespace in self._node.get_node_names_and_namespaces():
            if not name.startswith(HIDDEN):
                present.add(f"{namespace.rstrip('/')}/{name}")
        self._seen |= present
        for node in self._questions.keys() - present:
            self._forget_clients(self._questions.pop(node))
        for node in sorted(present):
            self._move_on(self._questions.setdefault(node, _Question(node=node)))

    def take_event(self, event: ParameterEvent) -> None:
        """Follow a change that a node told on /parameter_events."""
        told = self._answers.get(event.node)
        if told is None:  # its answer, still to come, holds the change
            return
        for parameter in (*event.new_parameters, *event.changed_parameters):
            told[parameter.name] = _plain(parameter_value_to_python(parameter.value))
        for parameter in event.deleted_parameters:
            told.pop(parameter.name, None)

    def close(self) -> None:
        """Take the clients down."""
        for question in self._questions.values():
            self._forget_clients(question)

    def _move_on(self, question: _Question) -> None:
        if question.answered:
            self._forget_clients(question)
            return
        if not question.clients:
            question.clients = [
                self._node.create_client(ListParameters, f"{question.node}/list_parameters"),
                self._node.create_client(GetParameters, f"{question.node}/get_parameters"),
            ]
        is_due = question.attempts == 0 or self._clock() - question.asked_s > ANSWER_LIMIT_S
        is_there = all(client.service_is_ready() for client in question.clients)
        if is_due and is_there and question.attempts < ATTEMPTS:
            question.attempts += 1
            question.asked_s = self._clock()
            asked = question.clients[0].call_async(ListParameters.Request())
            asked.add_done_callback(lambda future: self._take_names(question, future))

    def _take_names(self, question: _Question, future: Future) -> None:
        listed = _result(future)
        if listed is None or not question.clients:
            return
        names = list(listed.result.names)
        asked = question.clients[1].call_async(GetParameters.Request(names=names))
        asked.add_done_callback(lambda answer: self._take_values(question, names, answer))

    def _take_values(self, question: _Question, names: list[str], future: Future) -> None:
        told = _result(future)
        if told is None or len(told.values) != len(names):
            return
        self._answers[question.node] = {
            name: _plain(parameter_value_to_python(value))
            for name, value in zip(names, told.values, strict=True)
        }
        question.answered = True

    def _forget_clients(self, question: _Question) -> None:
        for client in question.clients:
            self._node.destroy_client(client)
        question.clients = []


def _result(future: Future) -> Any:
    """The response, None where the call was cancelled or failed."""
    return None if future.cancelled() or future.exception() is not None else future.result()


def _plain(value: Any) -> ParameterValue:
    """A parameter's value as JSON can hold it: bytes become whole numbers, arrays tuples."""
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    return tuple(item[0] if isinstance(item, bytes) else item for item in value)
