"""The simulated user node: a person on the chat topics."""

import sys

from robustnav_msgs_py import conversions as wire
from robustnav_msgs_py.values import ObjectInstance
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes
from robustnav_nodes.simulated_user.parameters import SimulatedUserParameters
from robustnav_nodes.simulated_user.person import Person, choose_target


class SimulatedUser(GraphNode[SimulatedUserParameters]):
    """Asks for an object once somebody listens, waits, thanks, or says that it is not it.

    Hears `chat/to_user` and `truth/objects` (what there is to ask for). Says `chat/from_user`.
    """

    executable = "simulated_user"
    declaration = SimulatedUserParameters

    def configure(self) -> None:
        """Open the topics."""
        self._person: Person | None = None
        self._lines = self.publisher("chat/from_user")
        self.subscribe("truth/objects", wire.objects_from_message, self._on_objects)
        self.subscribe("chat/to_user", wire.text_from_message, self._on_line)
        self.every(self.parameters.check_period_s, self._wait, steady=True)

    def activate(self) -> None:
        """Begin to think about what to ask for."""
        self._since_s = self.steady_s()

    def _on_objects(self, objects: tuple[ObjectInstance, ...]) -> None:
        target = self.parameters.target or choose_target(objects, self.parameters.seed)
        if target is not None and self._person is None:
            self._person = Person(target, self.parameters.ask_again_s, objects)

    def _wait(self) -> None:
        if self._person is not None:
            self.health.figure("mood", self._person.mood)
            thought_s = self.steady_s() - self._since_s
            if thought_s >= self.parameters.ask_after_s and self._lines.get_subscription_count():
                self._say(self._person.wait(self.steady_s()))

    def _on_line(self, line: str) -> None:
        if self._person is not None:
            self._say(self._person.hear(line))

    def _say(self, line: str | None) -> None:
        if line is not None:
            self._lines.publish(wire.text_to_message(line))


def main() -> int:
    """Run the node until it is told to stop."""
    return run_nodes([SimulatedUser])


if __name__ == "__main__":
    sys.exit(main())
