"""Follows a run from outside, over its topics: the search, the decisions, the chat."""

from collections.abc import Callable
from functools import partial
from typing import Any

from rclpy.node import Node

from robustnav_msgs_py import contract
from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.errors import RobustnavError
from robustnav_msgs_py.records import Decision, DialogueState, SearchState
from robustnav_nodes.graph import qos
from robustnav_nodes.graph.message_class import message_class


class RunWatcher(Node):
    """A plain node that hands each search state, decision and chat line to a function.

    What the person says is taken from `dialogue/state`, as the robot heard it. A listener of its own on
    `chat/from_user` could be found before the dialogue by `ros2 topic pub --once`, which speaks as soon as
    it has found one.
    """

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
        self._hear("dialogue/state", partial(wire.record_from_message, kind=DialogueState), self._on_dialogue)
        self._hear("chat/to_user", wire.text_from_message, partial(on_chat, "robot"))
        self._on_chat = on_chat
        self._lines_heard = 0

    def _on_dialogue(self, dialogue: DialogueState) -> None:
        if dialogue.lines_heard != self._lines_heard:
            self._lines_heard = dialogue.lines_heard
            self._on_chat("person", dialogue.last_heard)

    def _hear(self, name: str, read: Callable[[Any], Any], use: Callable[[Any], None]) -> None:
        row = contract.topic(name)

        def hear(message: Any) -> None:
            try:
                value = read(message)
            except RobustnavError as error:  # somebody else's word must not end the run
                self.get_logger().warning(f"{name}: {error}")
            else:
                use(value)

        self.create_subscription(message_class(row.type), name, hear, qos.heard(row.qos))
