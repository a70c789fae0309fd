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

    parameters: what this run sets, by executable, over `user_parameters` (a ROS parameter file, None: none),
    which stand over the nodes' own defaults. seed: of all that is left to chance, None: as the parameters
    say. The bag is `bag`, None: nothing is recorded. ros_arguments: for every node (`-r odom:=pose`).
    """

    seed: int | None = 1
    with_simulation: bool = True
    with_simulated_user: bool = True
    bag: Path | None = None
    user_parameters: Path | None = None
    ros_arguments: tuple[str, ...] = ()
    parameters: Mapping[str, Mapping[str, Any]]

    @property
    def nodes(self) -> tuple[contract.NodeRow, ...]:
        """The nodes of the run, in the contract's order."""
        left_out = set()
        if not self.with_simulation:
            left_out |= {"sim_bridge", "simulated_user"}
        if not self.with_simulated_user:
            left_out.add("simulated_user")
        if self.bag is None:
            left_out.add("recorder")
        return tuple(row for row in contract.NODES if row.in_graph and row.executable not in left_out)

    def node_parameters(self) -> dict[str, dict[str, Any]]:
        """What each node starts with, by executable."""
        names = [row.executable for row in self.nodes]
        chosen: dict[str, dict[str, Any]] = {}
        for name in names:
            simulated_time = self.with_simulation and name not in ON_WALL_TIME
            chosen[name] = {"use_sim_time": simulated_time, "autostart": name == "manager"}
            if self.seed is not None and name in ("sim_bridge", "planner", "detection", "simulated_user"):
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

        Raises BadFileError where a file cannot be written, or the user's is not there or no YAML.
        """
        if self.user_parameters is not None:
            check_parameter_file(self.user_parameters)
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
        return (path,) if self.user_parameters is None else (self.user_parameters, path)

    def process_plans(self, parameter_files: tuple[Path, ...]) -> list[ProcessPlan]:
        """One process per node."""
        arguments = self.arguments(parameter_files)
        return [
            ProcessPlan(package=row.package, executable=row.executable, ros_arguments=arguments)
            for row in self.nodes
        ]

    def arguments(self, parameter_files: tuple[Path, ...]) -> tuple[str, ...]:
        """What every node gets after `--ros-args`."""
        files = tuple(part for file in parameter_files for part in ("--params-file", str(file)))
        return (*files, *self.ros_arguments)


def check_parameter_file(path: Path) -> None:
    """Raise BadFileError where a ROS parameter file is not there, or no YAML."""
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise BadFileError(f"cannot read the parameter file {str(path)!r}: {error}") from error
    except yaml.YAMLError as error:
        raise BadFileError(f"the parameter file {str(path)!r} is no YAML: {error}") from error
    if not isinstance(content, dict):
        raise BadFileError(
            f"the parameter file {str(path)!r} must hold nodes and their ros__parameters, not {content!r}"
        )
