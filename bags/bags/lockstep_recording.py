"""Records a run in lock-step: what is said goes straight into the bag, at the run's own times."""

import re
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any

from rclpy.serialization import serialize_message

from bags.definitions import ament_prefixes, message_definition
from bags.manifest import Manifest, NamedParameter, NodeParameters
from bags.offered_qos import OfferedQos
from bags.parameters import RecorderParameters
from bags.provenance import manifest_of_this_run
from bags.writer import BagWriter
from robustnav_msgs_py.contract import Qos
from robustnav_msgs_py.conversions import clock_from_message, record_from_message
from robustnav_msgs_py.records import Episode
from robustnav_nodes.graph.lockstep import CLOCK, Said
from robustnav_nodes.graph.lockstep_run import LockstepRun


class LockstepRecording:
    """A bag of a run in lock-step. `take` is what the run calls with everything that is said.

    Log times are those of the run's clock, which begins at one second: the same run gives the same bag.
    """

    def __init__(self, folder: Path) -> None:
        """Begin the bag. Raises BadFileError where the folder exists already or cannot be made."""
        self._manifest: Manifest = replace(manifest_of_this_run(Path(__file__).resolve()), lockstep=True)
        self._writer = BagWriter(folder, manifest=self._manifest)
        self._channels: dict[str, int] = {}
        self._exclude = re.compile(RecorderParameters().exclude)

    def take(self, said: Said) -> None:
        """Write one message; what the recorder leaves out unless asked is left out here, too."""
        if self._exclude.fullmatch(said.topic):
            return
        channel = self._channels.get(said.topic)
        if channel is None:
            definition = message_definition(said.row.type, ament_prefixes())
            channel = self._writer.add_topic(said.topic, definition, (_offered(said.row.qos),))
            self._channels[said.topic] = channel
        if said.row.name == "truth/episode":
            self._manifest = self._manifest.with_episode(record_from_message(said.message, Episode))
        if said.row.name == CLOCK and self._manifest.sim_start_ns is None:
            self._manifest = replace(self._manifest, sim_start_ns=clock_from_message(said.message))
        self._writer.write(
            channel,
            log_time_ns=said.time_ns,
            publish_time_ns=said.time_ns,
            data=serialize_message(said.message),
        )

    def note_parameters(self, run: LockstepRun) -> None:
        """Store the parameters of the run's nodes in the manifest."""
        nodes = tuple(
            NodeParameters(node=node, parameters=tuple(_named(name, value) for name, value in told.items()))
            for node, told in sorted(run.parameters().items())
        )
        self._manifest = replace(self._manifest, nodes=nodes)

    def close(self) -> None:
        """Store the manifest and close the bag."""
        self._writer.update_manifest(self._manifest)
        self._writer.close()

    def __enter__(self) -> "LockstepRecording":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _offered(qos: Qos) -> OfferedQos:
    return OfferedQos(depth=qos.depth, durability="transient_local" if qos.latched else "volatile")


def _named(name: str, value: Any) -> NamedParameter:
    return NamedParameter(name=name, value=tuple(value) if isinstance(value, (list, tuple)) else value)
