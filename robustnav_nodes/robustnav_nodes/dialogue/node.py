"""The dialogue node: what the person says in, the target of the search and answers out."""

import sys
from functools import partial

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.pose_history import PoseHistory
from robustnav_msgs_py.records import Decision, SearchState
from robustnav_nodes.dialogue.front_door import FrontDoor, Reaction
from robustnav_nodes.dialogue.parameters import DialogueParameters
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes


class Dialogue(GraphNode[DialogueParameters]):
    """The front door: "find the mug", "stop", "where are you?", "why?".

    Hears `chat/from_user`, `detections/labels`, `search/state`, `planner/decision`, `odom`. Says
    `chat/to_user`, `search/target`, `search/facts` (what the person says about a find) and `dialogue/state`.
    """

    executable = "dialogue"
    declaration = DialogueParameters

    def configure(self) -> None:
        """Open the topics."""
        self._door = FrontDoor(self.parameters)
        self._poses = PoseHistory()
        self._answers = self.publisher("chat/to_user")
        self._target = self.publisher("search/target")
        self._facts = self.publisher("search/facts")
        self._state = self.publisher("dialogue/state")
        self.subscribe("chat/from_user", wire.text_from_message, self._on_line)
        self.subscribe("detections/labels", wire.labels_from_message, self._door.hear_names)
        self.subscribe("search/state", partial(wire.record_from_message, kind=SearchState), self._on_search)
        self.subscribe(
            "planner/decision", partial(wire.record_from_message, kind=Decision), self._door.hear_decision
        )
        self.subscribe("odom", wire.odometry_from_message, self._poses.add)

    def _on_line(self, line: str) -> None:
        here = self._poses.latest
        reaction = self._door.hear(line, here.pose if here is not None else None)
        self.health.count("lines heard")
        self._do(reaction)

    def _on_search(self, search: SearchState) -> None:
        news = self._door.hear_search(search)
        if news is not None:
            self._do(news)

    def _do(self, reaction: Reaction) -> None:
        self._state.publish(wire.record_to_message(self._door.state, summary=reaction.answer))
        if reaction.answer:
            self._answers.publish(wire.text_to_message(reaction.answer))
        if reaction.is_right is not None:
            word = "confirmed" if reaction.is_right else "refuted"
            self._facts.publish(wire.text_to_message(f"{word} {reaction.found}"))
        if reaction.target is not None:
            self._target.publish(wire.text_to_message(reaction.target))


def main() -> int:
    """Run the node until it is told to stop."""
    return run_nodes([Dialogue])


if __name__ == "__main__":
    sys.exit(main())
