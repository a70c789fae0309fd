"""What made a run: version, commit, seed, scene, and every node's parameters; stored inside its bag."""

import json
import re
from dataclasses import asdict, dataclass, replace
from typing import Any, Self

from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.records import Episode

FORMAT = 1
BACK_END = re.compile(r"(^|[._])back_?end$")
ParameterScalar = bool | int | float | str | None
ParameterValue = ParameterScalar | tuple[ParameterScalar, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class NamedParameter:
    """One parameter of a node, as the node had it."""

    name: str
    value: ParameterValue


@dataclass(frozen=True, slots=True, kw_only=True)
class NodeParameters:
    """All parameters of one node, `node` being its full name, in the order the node lists them."""

    node: str
    parameters: tuple[NamedParameter, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class BackEnd:
    """Which of several implementations a node ran, from its parameter `parameter`."""

    node: str
    parameter: str
    choice: str


@dataclass(frozen=True, slots=True, kw_only=True)
class PackageVersion:
    """An installed package that the run's results may depend on."""

    package: str
    version: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Manifest:
    """What made a run. A value that nobody told is None or empty; nothing is guessed.

    `commit` is the checkout's commit, "" where the code was installed rather than checked out;
    `uncommitted_changes` says that the files differed from it. `sim_start_ns` is the first time on
    `/clock`. `silent_nodes` were in the graph and did not tell their parameters. `lockstep` says that the run
    can be had again, message by message. `redacted` says what was taken out of the bag after the run, before
    it was shared.
    """

    version: str
    wall_start_ns: int
    commit: str = ""
    uncommitted_changes: bool = False
    seed: int | None = None
    scene: str = ""
    sim_start_ns: int | None = None
    platform: str = ""
    packages: tuple[PackageVersion, ...] = ()
    nodes: tuple[NodeParameters, ...] = ()
    silent_nodes: tuple[str, ...] = ()
    lockstep: bool = False
    redacted: tuple[str, ...] = ()

    @property
    def back_ends(self) -> tuple[BackEnd, ...]:
        """What each node's parameters called `back_end`, `..._back_end` or in one word `backend` say."""
        return tuple(
            BackEnd(node=node.node, parameter=parameter.name, choice=str(parameter.value))
            for node in self.nodes
            for parameter in node.parameters
            if BACK_END.search(parameter.name)
        )

    @property
    def back_ends_text(self) -> str:
        """The back ends as a person reads them, "" for none."""
        return ", ".join(f"{row.node} {row.parameter}={row.choice}" for row in self.back_ends)

    def with_node(self, node: NodeParameters) -> Self:
        """This manifest with `node` in place of what it held of that node."""
        others = (known for known in self.nodes if known.node != node.node)
        return replace(
            self,
            nodes=tuple(sorted((*others, node), key=lambda known: known.node)),
            silent_nodes=tuple(name for name in self.silent_nodes if name != node.node),
        )

    def with_episode(self, episode: Episode) -> Self:
        """This manifest with seed and scene of a simulated `episode`."""
        rooms = f" ({', '.join(episode.rooms)})" if episode.rooms else ""
        return replace(self, seed=episode.seed, scene=episode.home + rooms)

    def as_json(self) -> str:
        """One line of JSON that `manifest_from_json` reads back to an equal manifest."""
        return json.dumps({"format": FORMAT, **asdict(self)}, ensure_ascii=False)


def manifest_from_json(text: str) -> Manifest:
    """Inverse of `Manifest.as_json`; raises BadFileError for anything else.

    Fields that this version does not know are left out, so that newer bags stay readable.
    """
    try:
        record = json.loads(text)
        return Manifest(
            version=str(record["version"]),
            wall_start_ns=int(record["wall_start_ns"]),
            commit=str(record.get("commit", "")),
            uncommitted_changes=bool(record.get("uncommitted_changes", False)),
            seed=_optional_int(record.get("seed")),
            scene=str(record.get("scene", "")),
            sim_start_ns=_optional_int(record.get("sim_start_ns")),
            platform=str(record.get("platform", "")),
            packages=tuple(
                PackageVersion(package=str(row["package"]), version=str(row["version"]))
                for row in record.get("packages", ())
            ),
            nodes=tuple(_node_parameters(row) for row in record.get("nodes", ())),
            silent_nodes=tuple(str(name) for name in record.get("silent_nodes", ())),
            lockstep=bool(record.get("lockstep", False)),
            redacted=tuple(str(what) for what in record.get("redacted", ())),
        )
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise BadFileError(f"this is no manifest of a run: {text[:80]!r} ({error!r})") from error


def _node_parameters(row: dict[str, Any]) -> NodeParameters:
    return NodeParameters(
        node=str(row["node"]),
        parameters=tuple(
            NamedParameter(name=str(parameter["name"]), value=_value(parameter["value"]))
            for parameter in row["parameters"]
        ),
    )


def _value(value: Any) -> ParameterValue:
    if isinstance(value, list):
        return tuple(value)
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise TypeError(f"{value!r} is no parameter value")


def _optional_int(value: Any) -> int | None:
    return None if value is None else int(value)
