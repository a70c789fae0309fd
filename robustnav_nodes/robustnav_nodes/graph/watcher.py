"""Follows a run from outside, over its topics: the search, the decisions, the chat."""

from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.node import Node

from robustnav_msgs_py import contract
from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.records import Decision, SearchState
from robustnav_nodes.graph import qos
from robustnav_nodes.graph.node import message_class


class RunWatcher(Node):
    """A plain node that hands each search state, decision and chat line to a function."""

    def __init__(
        self,
        *,
        on_state: Callable[[SearchState], None],
        on_decision: Callable[[Decision], None],
        on_chat: Callable[[str, str], None],
    ) -> None:
        super().__init__("run_watcher")
        self._hear("search/state", partial(wire.record_from_message, kind=SearchState), on_state)
        self._hear("planner/decision", partial(wire.record_from_message, kind=Decision), on_decision)
        self._hear("chat/from_user", wire.text_from_message, partial(on_chat, "person"))
        self._hear("chat/to_user", wire.text_from_message, partial(on_chat, "robot"))

    def _hear(self, name: str, read: Callable[[Any], Any], use: Callable[[Any], None]) -> None:
        row = contract.topic(name)
        self.create_subscription(
            message_class(row.type), name, lambda message: use(read(message)), qos.heard(row.qos)
        )
