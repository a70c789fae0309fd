"""Which nodes a run has, and the parameters they start with."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from robustnav_msgs_py import contract
from robustnav_msgs_py.errors import BadFileError
from robustnav_nodes.graph.processes import ProcessPlan

ON_WALL_TIME = ("sim_bridge", "manager", "recorder")  # the first makes the simulated time


@dataclass(frozen=True, slots=True, kw_only=True)
class RunPlan:
    """One run of the graph.

    parameters: what this run sets, by executable, over the nodes' own defaults and over `user_parameters`
    (a ROS parameter file, None: none). The bag is `bag`, None: nothing is recorded.
    """

    seed: int = 1
    with_simulation: bool = True
    with_simulated_user: bool = True
    bag: Path | None = None
    user_parameters: Path | None = None
    parameters: Mapping[str, Mapping[str, Any]]

    @property
    def nodes(self) -> tuple[contract.NodeRow, ...]:
        """The nodes of the run; the recorder comes last, so that it hears all the others come up."""
        left_out = set()
        if not self.with_simulation:
            left_out |= {"sim_bridge", "simulated_user"}
        if not self.with_simulated_user:
            left_out.add("simulated_user")
        if self.bag is None:
            left_out.add("recorder")
        return tuple(row for row in contract.NODES if row.executable not in left_out)

    def node_parameters(self) -> dict[str, dict[str, Any]]:
        """What each node starts with, by executable."""
        names = [row.executable for row in self.nodes]
        chosen: dict[str, dict[str, Any]] = {}
        for name in names:
            simulated_time = self.with_simulation and name not in ON_WALL_TIME
            chosen[name] = {"use_sim_time": simulated_time, "autostart": name == "manager"}
            if name in ("sim_bridge", "planner", "detection", "simulated_user"):
                chosen[name]["seed"] = self.seed
        chosen["manager"]["nodes"] = [name for name in names if name != "manager"]
        if self.bag is not None:
            # a recorder that was killed goes on in the bag that it left
            chosen["recorder"] |= {"folder": str(self.bag.parent), "name": self.bag.name, "resume": True}
        for name, values in self.parameters.items():
            if name in chosen:
                chosen[name] |= values
        return chosen

    def write_parameters(self, path: Path) -> tuple[Path, ...]:
        """Write this run's ROS parameter file; returns the files that nodes read, later ones win.

        Raises BadFileError where a file cannot be written or read.
        """
        content = {
            f"/**/{name}": {"ros__parameters": values} for name, values in self.node_parameters().items()
        }
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(yaml.safe_dump(content, sort_keys=False), encoding="utf-8")
        except OSError as error:
            raise BadFileError(
                f"cannot write the run's parameters to {str(path)!r}: {error.strerror}"
            ) from error
        if self.user_parameters is None:
            return (path,)
        if not self.user_parameters.is_file():
            raise BadFileError(f"there is no parameter file {str(self.user_parameters)!r}")
        return (path, self.user_parameters)

    def process_plans(self, parameter_files: tuple[Path, ...]) -> list[ProcessPlan]:
        """One process per node."""
        arguments = tuple(part for file in parameter_files for part in ("--params-file", str(file)))
        return [
            ProcessPlan(package=row.package, executable=row.executable, ros_arguments=arguments)
            for row in self.nodes
        ]
