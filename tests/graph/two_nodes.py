"""Two nodes in one process that end as soon as they are active, and print what they do meanwhile."""

import sys
from dataclasses import dataclass
from typing import ClassVar

from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes


@dataclass(frozen=True, slots=True, kw_only=True)
class NoParameters:
    """Of either node."""


class Planner(GraphNode[NoParameters]):
    """In the place of the planner."""

    executable: ClassVar[str] = "planner"
    declaration: ClassVar[type] = NoParameters

    def activate(self) -> None:
        self.exit_code = 0

    def deactivate(self) -> None:
        print(f"{self.executable} stops", flush=True)

    def cleanup(self) -> None:
        print(f"{self.executable} cleans up", flush=True)


class Dialogue(Planner):
    """In the place of the dialogue."""

    executable: ClassVar[str] = "dialogue"


sys.exit(run_nodes([Planner, Dialogue]))
