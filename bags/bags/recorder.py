"""The recorder: every topic of the graph into one bag, with a manifest of what made the run.

| | |
|---|---|
| hears | every topic that has a publisher, as soon as it appears, hidden ones too |
| says | `/diagnostics`: messages, bytes and drops of each topic |
| serves | `~/split`: the bag goes on in its next file |
| asks | every node's `list_parameters` and `get_parameters`, for the manifest |

It records while it is active. With `resume` it goes on in the bag of its name that a killed recorder left:
that one's file is repaired, and the next file of the bag is begun. Deactivating returns at once: what has
arrived until then is still written, by a thread of its own. Cleaning up, shutting down or ending the process
waits until the bag is closed.
"""

import sys
import time
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any, ClassVar

from diagnostic_msgs.msg import DiagnosticStatus
from rcl_interfaces.msg import ParameterEvent
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock

from bags.manifest import Manifest
from bags.parameter_survey import ParameterSurvey
from bags.parameters import RecorderParameters, pattern
from bags.provenance import manifest_of_this_run
from bags.recording import Recording, TopicCount
from bags.topic_listener import Observer, TopicListener
from bags.writer import BagWriter, SplitRule
from robustnav_msgs_py.conversions import record_from_message, stamp_from_message
from robustnav_msgs_py.errors import BadFileError
from robustnav_msgs_py.records import Episode
from robustnav_msgs_py.values import ERROR, WARN
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import run_nodes

FIGURES_PERIOD_S = 1.0
MANIFEST_PERIOD_S = 5.0


class Recorder(GraphNode[RecorderParameters]):
    """Records every topic while it is active; see the module's docstring for its interface.

    `folder_of_bag` is where the bag of the last activation lies, None before the first.
    """

    executable: ClassVar[str] = "recorder"
    declaration: ClassVar[type] = RecorderParameters
    # What was said when the end came is on its way, and belongs to the run.
    listen_on_s: ClassVar[float] = 0.5

    def __init__(self, **node_options: Any) -> None:
        super().__init__(**node_options)
        self.folder_of_bag: Path | None = None
        self._recording: Recording | None = None
        self._closing: list[Recording] = []
        self._untold_repairs: list[Recording] = []
        self._told_drops = 0
        self._noted: Manifest | None = None
        self._listener: TopicListener | None = None
        self._survey: ParameterSurvey | None = None
        # Asks git, which takes a moment: here, where nothing is heard yet.
        self._manifest: Manifest = manifest_of_this_run(Path(__file__).resolve())

    def configure(self) -> None:
        """Check the parameters, and make the timers that run while the node is active."""
        parameters = self.parameters
        pattern("include", parameters.include)
        pattern("exclude", parameters.exclude)
        pattern("patient", parameters.patient)
        self.serve("~/split", self._split)
        self.every(parameters.discovery_period_s, self._discover, steady=True)
        self.every(FIGURES_PERIOD_S, self._show_figures, steady=True)
        self.every(MANIFEST_PERIOD_S, self._note_manifest, steady=True)

    def activate(self) -> None:
        """Begin a bag, or go on in one; refused where its folder exists already or cannot be written."""
        parameters = self.parameters
        self._manifest = replace(
            self._manifest, wall_start_ns=time.time_ns(), seed=None, scene="", sim_start_ns=None
        )
        writer = BagWriter(
            _bag_folder(parameters, datetime.now().astimezone()),
            manifest=self._manifest,
            chunk_bytes=parameters.chunk_size_bytes,
            resume=parameters.resume,
            split=SplitRule(
                size_bytes=parameters.split_size_bytes,
                duration_s=parameters.split_duration_s,
                repeat_latched=parameters.repeat_latched,
            ),
        )
        self.folder_of_bag = writer.folder
        self._recording = Recording(
            writer, queue_bytes=parameters.queue_size_bytes, flush_period_s=parameters.flush_period_s
        )
        self._untold_repairs.append(self._recording)
        self._survey = ParameterSurvey(self)
        self._listener = TopicListener(
            self,
            self._recording,
            include=pattern("include", parameters.include),
            exclude=pattern("exclude", parameters.exclude) if parameters.exclude else None,
            patient=pattern("patient", parameters.patient),
            patience_s=parameters.patience_s,
            depth=parameters.depth,
            observer_of=self._observer_of,
            say=self.health.problem,
        )
        self._told_drops, self._noted = 0, None
        self.get_logger().info(f"recording to {writer.path}")

    def deactivate(self) -> None:
        """Hear nothing more, and let the bag be closed."""
        if self._listener is not None:
            self._listener.close()
        if self._survey is not None and self._recording is not None:
            self._note_manifest()
            self._recording.finish()
            self._survey.close()
            self._closing.append(self._recording)
        self._recording = self._listener = self._survey = None

    def cleanup(self) -> None:
        """Wait until the bag is closed."""
        self._wait_until_closed()

    def destroy_node(self) -> None:
        """Close the bag, whatever state the node is in, and take the node down."""
        self.deactivate()
        self._wait_until_closed()
        super().destroy_node()

    def counts(self) -> tuple[TopicCount, ...]:
        """What became of the messages heard since the last activation; empty while inactive."""
        return self._recording.counts() if self._recording is not None else ()

    def _note_manifest(self) -> None:
        """Have what is known by now stored, so that it is in the bag of a run that is killed, too."""
        if self._survey is None or self._recording is None:
            return
        known = replace(self._manifest, nodes=self._survey.answers, silent_nodes=self._survey.silent)
        if known != self._noted:
            self._noted = known
            self._recording.update_manifest(known)

    def _split(self, _request: Any, response: Any) -> Any:
        """Answers at once; what was heard until now is still written to the file that ends."""
        if self._recording is None or not self._recording.split():
            raise BadFileError("nothing is being written, so there is no file to end; see /diagnostics")
        response.success = True
        response.message = f"{self._recording.folder} goes on in its next file"
        return response

    def _discover(self) -> None:
        if self._listener is not None and self._survey is not None:
            self._listener.discover()
            self._survey.step()

    def _observer_of(self, topic: str, message_type: str) -> Observer | None:
        """What the manifest needs to know of the messages that pass by."""
        if message_type == "rcl_interfaces/msg/ParameterEvent":
            return lambda data: self._guard(topic, self._take_parameter_event, data)
        if topic == "/clock" and message_type == "rosgraph_msgs/msg/Clock":
            return lambda data: self._guard(topic, self._take_clock, data)
        if topic.endswith("/truth/episode") and message_type == "diagnostic_msgs/msg/DiagnosticStatus":
            return lambda data: self._guard(topic, self._take_episode, data)
        return None

    def _take_parameter_event(self, data: bytes) -> None:
        if self._survey is not None:
            self._survey.take_event(deserialize_message(data, ParameterEvent))

    def _take_clock(self, data: bytes) -> None:
        if self._manifest.sim_start_ns is None:
            stamp = deserialize_message(data, Clock).clock
            self._manifest = replace(self._manifest, sim_start_ns=stamp_from_message(stamp))

    def _take_episode(self, data: bytes) -> None:
        episode = record_from_message(deserialize_message(data, DiagnosticStatus), Episode)
        self._manifest = self._manifest.with_episode(episode)

    def _show_figures(self) -> None:
        self._tell_repairs()
        if self._recording is None:
            return
        counts = self._recording.counts()
        dropped = sum(count.dropped for count in counts)
        self.health.figure("bag", self._recording.folder)
        self.health.figure("messages", sum(count.messages for count in counts))
        self.health.figure("bytes", sum(count.size_bytes for count in counts))
        self.health.figure("dropped", dropped)
        self.health.figure("waiting to be written, bytes", self._recording.waiting_bytes)
        for count in counts:
            told = f"{count.messages} messages, {count.size_bytes} bytes, {count.dropped} dropped"
            self.health.figure(count.topic, told)
        if self._recording.failure:
            self.health.problem("bag", self._recording.failure, ERROR)
        elif dropped > self._told_drops:
            self._told_drops = dropped
            self.health.problem(
                "queue",
                f"{dropped} messages came while the disk was behind, and are not in the bag: raise "
                "queue_size_bytes, exclude topics, or record to a faster disk",
                WARN,
            )

    def _tell_repairs(self) -> None:
        """Say what was repaired of a bag that is gone on with, once it is."""
        for recording in list(self._untold_repairs):
            earlier = recording.earlier
            if earlier is None:
                continue
            self._untold_repairs.remove(recording)
            for report in earlier.repairs:
                self.get_logger().info(report.sentence)
            for problem in earlier.problems:
                self.health.problem("earlier file", problem, WARN)

    def _wait_until_closed(self) -> None:
        for recording in self._closing:
            if not recording.wait(self.parameters.closing_limit_s):
                self.health.problem("bag", f"{recording.folder} is still not closed", ERROR)
            elif recording.failure:
                self.health.problem("bag", recording.failure, ERROR)
            else:
                counts = recording.counts()
                total, dropped = sum(c.messages for c in counts), sum(c.dropped for c in counts)
                without = f", {dropped} dropped" if dropped else ""
                self.get_logger().info(f"closed {recording.folder} with {total} messages{without}")
        self._closing.clear()
        self._tell_repairs()


def _bag_folder(parameters: RecorderParameters, now: datetime) -> Path:
    folder = Path(parameters.folder).expanduser()
    if parameters.name:
        return folder / parameters.name
    stem = f"run_{now:%Y%m%d_%H%M%S}"
    names = [stem, *(f"{stem}_{number}" for number in range(2, 100))]
    return next((folder / name for name in names if not (folder / name).exists()), folder / stem)


def main() -> int:
    """Run the node until it is told to stop."""
    return run_nodes([Recorder])


if __name__ == "__main__":
    sys.exit(main())
