"""Replay a bag through the real nodes, in lock-step, and compare what they say with what was recorded."""

import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import rclpy
import yaml
from rclpy.context import Context
from rclpy.serialization import deserialize_message, serialize_message
from rclpy.signals import SignalHandlerOptions

from bags.comparison import FieldDifference, differences
from bags.manifest import Manifest, NodeParameters, ParameterValue
from bags.reader import Bag, RawMessage
from robustnav_msgs_py import contract
from robustnav_msgs_py.errors import BadFileError, BadParameterError, GraphError
from robustnav_nodes.graph.environment import prepare_environment
from robustnav_nodes.graph.lockstep import CLOCK, Lockstep, Said
from robustnav_nodes.graph.message_class import message_class
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.one_process import node_class
from robustnav_nodes.graph.search_graph import check_parameter_file
from robustnav_nodes.graph.spin import RCLError

# What stands in for the world and the person is not asked again: what it said is the input.
REPLAYED = ("detection", "belief", "planner", "dialogue")
NOT_COMPARED = ("/diagnostics",)
DECISIONS = "planner/decision"
# The nodes complain again of what they complained of then.
QUIET = ("--ros-args", "--log-level", "error")


@dataclass(frozen=True, slots=True, kw_only=True)
class Difference:
    """The first message of a topic that is not as recorded: number `number` (from 0), said at `time_ns`.

    `position` is its place among all that was recorded of the replayed nodes, so that what was said in one
    moment has an order. `fields` is empty where one of the two is missing; `what` is a sentence.
    """

    topic: str
    number: int
    time_ns: int
    position: int
    what: str
    fields: tuple[FieldDifference, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicComparison:
    """One topic: how many messages were recorded, said again, the same, and the same but for their stamps."""

    topic: str
    recorded: int
    replayed: int
    same: int
    same_but_stamps: int
    first: Difference | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Replay:
    """What came of a replay. `inputs`: messages that were fed."""

    nodes: tuple[str, ...]
    inputs: int
    topics: tuple[TopicComparison, ...]

    @property
    def is_same(self) -> bool:
        """Whether every message came again, the same."""
        return all(topic.first is None for topic in self.topics)

    @property
    def first(self) -> Difference | None:
        """The earliest difference."""
        found = [topic.first for topic in self.topics if topic.first is not None]
        return min(found, key=lambda difference: (difference.time_ns, difference.position)) if found else None

    @property
    def first_decision(self) -> Difference | None:
        """The first decision of the planner that is another one."""
        return next((topic.first for topic in self.topics if topic.topic.endswith(DECISIONS)), None)


def replay(
    bag: Bag,
    *,
    nodes: Sequence[str] = (),
    parameter_file: Path | None = None,
) -> Replay:
    """Feed what was recorded to `nodes` (all that the bag knows of REPLAYED where empty), and compare.

    The nodes have the parameters of the recorded run, and those of `parameter_file` (a ROS parameter file)
    over them. Raises BadFileError where the bag tells no parameters of a node or the file is none,
    BadParameterError for a name that is no node of the graph and for parameters that do not fit.
    """
    manifest = bag.manifest
    if manifest is None:
        raise BadFileError(f"{bag.path} has no manifest, so nobody knows with which parameters its nodes ran")
    told = _told(manifest)
    if parameter_file is not None:
        check_parameter_file(parameter_file)
    names = tuple(nodes) or tuple(name for name in REPLAYED if name in told)
    if not names:
        raise BadFileError(
            f"{bag.path} tells the parameters of no node that can be replayed ({', '.join(REPLAYED)}): was "
            "it recorded by robustnav's recorder?"
        )
    for name in names:
        _check(name, told, bag)
    session = _Session(bag, {name: told[name] for name in names}, parameter_file)
    try:
        session.run()
        return session.result()
    finally:
        session.close()


def _told(manifest: Manifest) -> dict[str, NodeParameters]:
    """What the manifest tells of each node, by executable."""
    known = {row.executable for row in contract.NODES}
    last = ((node.node.rpartition("/")[2], node) for node in manifest.nodes)
    return {name: node for name, node in last if name in known}


def _check(name: str, told: dict[str, NodeParameters], bag: Bag) -> None:
    if name not in REPLAYED:
        raise BadParameterError(f"no node {name!r} can be replayed; there are {', '.join(REPLAYED)}")
    if name not in told:
        raise BadFileError(f"{bag.path} does not tell the parameters of {name!r}; it knows {', '.join(told)}")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Output:
    time_ns: int
    data: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class _Recorded:
    position: int
    raw: RawMessage


class _Session:
    """One replay: the nodes, and what they said, by topic."""

    def __init__(self, bag: Bag, told: dict[str, NodeParameters], parameter_file: Path | None) -> None:
        prepare_environment(local=True)
        self._bag = bag
        span = bag.span_ns
        if span is None:
            raise BadFileError(f"{bag.path} holds no message")
        self._lockstep = Lockstep(self._hear, begin_ns=span[0])
        self._inputs = 0
        self._names = tuple(told)
        self._said: dict[str, list[_Output]] = {}
        self._nodes: list[GraphNode[Any]] = []
        self._context = Context()
        rclpy.init(args=list(QUIET), context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        try:
            for name, parameters in told.items():
                self._nodes.append(self._made(name, parameters, parameter_file))
                _refuse_unknown(self._nodes[-1], parameters, parameter_file)
            self._outputs = {
                node.resolve_topic_name(row.name): row
                for node in self._nodes
                for row in contract.spoken_by(node.executable)
                if row.name not in NOT_COMPARED
            }
            self._fed = {
                topic: row
                for node in self._nodes
                for row in contract.heard_by(node.executable)
                if (topic := node.resolve_topic_name(row.name)) not in self._outputs
            } | {CLOCK: contract.topic(CLOCK)}
            for change in ("configure", "activate"):
                for node in self._nodes:
                    getattr(node, f"trigger_{change}")()
                    if not node.is_active and change == "activate":
                        raise GraphError(f"{node.executable} cannot be replayed; its log says why")
                    self._lockstep.settle()
        except BaseException:
            self.close()
            raise

    def run(self) -> None:
        """Feed the bag in log order; what is due before a message happens before it.

        Inputs that were said in one breath, with no output between them, are heard in one.
        """
        for raw in self._bag.raw_messages([*self._fed, *self._outputs]):
            row = self._fed.get(raw.topic)
            if row is None:
                self._lockstep.settle()
                continue
            if raw.type != row.type:
                raise BadFileError(
                    f"{self._bag.path} holds {raw.topic} as {raw.type!r}; the nodes hear {row.type!r}"
                )
            if raw.log_time_ns > self._lockstep.time_ns:
                self._lockstep.advance(raw.log_time_ns - 1)
                self._lockstep.time_ns = raw.log_time_ns
            self._lockstep.say(raw.topic, row, deserialize_message(raw.data, message_class(row.type)))
            self._inputs += 1
        span = self._bag.span_ns
        if span is not None:
            self._lockstep.advance(span[1])

    def result(self) -> Replay:
        """Compare what was said with what was recorded."""
        recorded: dict[str, list[_Recorded]] = {topic: [] for topic in self._outputs}
        for position, raw in enumerate(self._bag.raw_messages(list(self._outputs))):
            recorded[raw.topic].append(_Recorded(position=position, raw=raw))
        kept = {row.name for row in self._bag.topics}  # a recorder may leave topics out
        return Replay(
            nodes=self._names,
            inputs=self._inputs,
            topics=tuple(
                _compared(topic, row, recorded[topic], self._said.get(topic, []))
                for topic, row in sorted(self._outputs.items())
                if topic in kept
            ),
        )

    def close(self) -> None:
        """Take the nodes down."""
        for node in reversed(self._nodes):
            node.trigger_shutdown()
            node.destroy_node()
        self._nodes.clear()
        rclpy.try_shutdown(context=self._context)

    def _made(self, name: str, told: NodeParameters, parameter_file: Path | None) -> GraphNode[Any]:
        row = next(row for row in contract.NODES if row.executable == name)
        namespace = told.node.rpartition("/")[0] or "/"
        with tempfile.NamedTemporaryFile("w", suffix=".yaml", encoding="utf-8") as recorded:
            values = {item.name: _plain(item.value) for item in told.parameters if item.value is not None}
            yaml.safe_dump({f"/**/{name}": {"ros__parameters": values}}, recorded)
            recorded.flush()
            files = [recorded.name, *([] if parameter_file is None else [str(parameter_file)])]
            kind = node_class(row.package, row.executable)
            arguments = [part for file in files for part in ("--params-file", file)]
            try:
                return kind(
                    wiring=self._lockstep.wiring,
                    context=self._context,
                    namespace=namespace,
                    cli_args=["--ros-args", *arguments],
                )
            except RCLError as error:
                raise BadParameterError(
                    f"{name} does not take these parameters: {files[-1]!r} is no ROS parameter file ({error})"
                ) from error

    def _hear(self, said: Said) -> None:
        if said.topic in self._outputs:
            # through the wire and back, as a recorder would have it: fields lose the digits that CDR drops
            output = _Output(time_ns=said.time_ns, data=serialize_message(said.message))
            self._said.setdefault(said.topic, []).append(output)


def _refuse_unknown(node: GraphNode[Any], told: NodeParameters, parameter_file: Path | None) -> None:
    """A parameter that is misspelt would change nothing, and all would be "the same".

    One that was recorded and is no longer there is passed over: bags outlive versions.
    """
    unknown = node.unknown_parameters - {item.name for item in told.parameters}
    if unknown:
        raise BadParameterError(
            f"{node.executable} has no parameter {', '.join(map(repr, sorted(unknown)))}; is it misspelt in "
            f"{str(parameter_file)!r}?"
        )


def _plain(value: ParameterValue) -> Any:
    return list(value) if isinstance(value, tuple) else value


def _compared(
    topic: str, row: contract.Topic, recorded: Sequence[_Recorded], replayed: Sequence[_Output]
) -> TopicComparison:
    same = same_but_stamps = 0
    first: Difference | None = None
    for number, (then, now) in enumerate(zip_longest(recorded, replayed)):
        if then is None or now is None:
            missing = "was not recorded" if then is None else "did not come again"
            first = first or Difference(
                topic=topic,
                number=number,
                time_ns=now.time_ns if now is not None else then.raw.log_time_ns,
                position=then.position if then is not None else sys.maxsize,
                what=missing,
            )
            continue
        kind = message_class(row.type)
        before, after = deserialize_message(then.raw.data, kind), deserialize_message(now.data, kind)
        fields = tuple(differences(before, after))
        if not fields:
            same += 1
            continue
        if not next(iter(differences(before, after, with_stamps=False)), None):
            same_but_stamps += 1
        first = first or Difference(
            topic=topic,
            number=number,
            time_ns=then.raw.log_time_ns,
            position=then.position,
            what="differs",
            fields=fields,
        )
    return TopicComparison(
        topic=topic,
        recorded=len(recorded),
        replayed=len(replayed),
        same=same,
        same_but_stamps=same_but_stamps,
        first=first,
    )
