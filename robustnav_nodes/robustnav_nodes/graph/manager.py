"""The lifecycle manager: brings the nodes of the graph up, also those started again, and takes them down."""

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from rclpy.client import Client

from robustnav_msgs_py import contract
from robustnav_msgs_py.parameters import parameter
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes

MANAGED = [row.executable for row in contract.NODES if row.in_graph and row.executable != "manager"]

REFUSED_WAIT_S = 2.0

_UP = {
    State.PRIMARY_STATE_UNCONFIGURED: Transition.TRANSITION_CONFIGURE,
    State.PRIMARY_STATE_INACTIVE: Transition.TRANSITION_ACTIVATE,
}
_DOWN = {
    State.PRIMARY_STATE_ACTIVE: Transition.TRANSITION_DEACTIVATE,
    State.PRIMARY_STATE_INACTIVE: Transition.TRANSITION_CLEANUP,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class ManagerParameters:
    """Parameters of the lifecycle manager."""

    nodes: list[str] = parameter(MANAGED, "nodes to manage, in the order in which they come up")
    period_s: float = parameter(0.25, "how often the nodes are looked at", unit="s", low=0.05, high=10.0)
    answer_timeout_s: float = parameter(
        6.0, "after which an unanswered question is asked again", unit="s", low=0.5, high=120.0
    )
    missing_s: float = parameter(
        10.0, "nodes that are not active for longer are a problem", unit="s", low=0.5, high=600.0
    )


class ManagedNode:
    """One node under management: its last known state, and at most one question under way.

    Owned by the manager, used in its executor thread only.
    """

    def __init__(self, name: str, get_state: Client, change_state: Client) -> None:
        self.name = name
        self.state = State.PRIMARY_STATE_UNKNOWN
        self.state_name = "not there"
        self._get_state = get_state
        self._change_state = change_state
        self._asked_at_s: float | None = None
        self._not_before_s = 0.0

    def advance(
        self, transitions: dict[int, int], timeout_s: float, problem: Callable[[str, str], None]
    ) -> None:
        """Ask for the state; when it is one that `transitions` leaves, ask for that transition."""
        now = time.monotonic()
        if now < self._not_before_s:
            return
        if self._asked_at_s is not None:
            if now - self._asked_at_s < timeout_s:
                return
            problem(self.name, f"no answer from {self.name!r} in {timeout_s:g} s; asking again")
            self._asked_at_s = None
        if not self._get_state.service_is_ready():
            self.state, self.state_name = State.PRIMARY_STATE_UNKNOWN, "not there"
            return
        self._asked_at_s = now

        def told(answer: Any) -> None:
            self.state, self.state_name = answer.current_state.id, answer.current_state.label
            if self.state in transitions:
                self._change(transitions[self.state], problem)
            else:
                self._asked_at_s = None

        _ask(self._get_state, GetState.Request(), told)

    def _change(self, transition: int, problem: Callable[[str, str], None]) -> None:
        def changed(answer: Any) -> None:
            self._asked_at_s = None
            if not answer.success:
                self._not_before_s = time.monotonic() + REFUSED_WAIT_S
                problem(
                    self.name, f"{self.name!r} refused a transition from {self.state_name!r}; see its log"
                )

        _ask(self._change_state, ChangeState.Request(transition=Transition(id=transition)), changed)


def _ask(client: Client, request: Any, use: Callable[[Any], None]) -> None:
    client.call_async(request).add_done_callback(lambda future: use(future.result()))


class Manager(GraphNode[ManagerParameters]):
    """Keeps every managed node active, or takes all down in reverse order when asked.

    Serves `~/startup` and `~/shutdown`; shows each node's state in /diagnostics.
    """

    executable = "manager"
    declaration = ManagerParameters

    def configure(self) -> None:
        """Make the clients of every managed node."""
        self._up = True
        self._whole_s = time.monotonic()
        self._nodes = [
            ManagedNode(
                name,
                self.create_client(GetState, f"{name}/get_state"),
                self.create_client(ChangeState, f"{name}/change_state"),
            )
            for name in self.parameters.nodes
        ]
        self.serve("~/startup", self._startup)
        self.serve("~/shutdown", self._shutdown)
        self.every(self.parameters.period_s, self._look, steady=True)

    def _look(self) -> None:
        if self._up:
            # all at once: a node waits for its inputs by itself, so no order is needed on the way up
            for node in self._nodes:
                self._advance(node, _UP)
        else:
            standing = [node for node in reversed(self._nodes) if node.state in _DOWN]
            if standing:  # all stop what they do before the first is taken down, which may take long
                working = [node for node in standing if node.state == State.PRIMARY_STATE_ACTIVE]
                self._advance((working or standing)[0], _DOWN)
        for node in self._nodes:
            self.health.figure(node.name, node.state_name)
        missing = [node.name for node in self._nodes if node.state != State.PRIMARY_STATE_ACTIVE]
        if not missing or not self._up:
            self._whole_s = time.monotonic()
        elif time.monotonic() - self._whole_s > self.parameters.missing_s:
            self.health.problem("graph", f"not active: {', '.join(missing)}")

    def _advance(self, node: ManagedNode, transitions: dict[int, int]) -> None:
        node.advance(transitions, self.parameters.answer_timeout_s, self.health.problem)

    def _startup(self, _request: Any, response: Any) -> Any:
        self._up = True
        response.success, response.message = True, "bringing every node up"
        return response

    def _shutdown(self, _request: Any, response: Any) -> Any:
        self._up = False
        response.success, response.message = True, "taking every node down, the last one first"
        return response


def main() -> int:
    """Run the manager until it is told to stop."""
    return run_nodes([Manager])


if __name__ == "__main__":
    sys.exit(main())
