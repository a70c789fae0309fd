"""The player: the messages of a bag on their recorded topics, as they were recorded.

| | |
|---|---|
| says | every recorded topic that is chosen, in the recorded bytes and with the recorded QoS |
| says | `/clock`, the time of the bag, where `clock_hz` asks for it and no recorded `/clock` is played |
| says | `/diagnostics`: time in the bag, messages sent, how late |

Services: `~/pause`, `~/step` (the next message, while paused), `~/reset` (from the start).

It plays any MCAP bag, of whatever recorder. Recorded names are absolute: a namespace moves the player alone,
and a remapping (`-r /odom:=/robot1/odom`) moves a topic. Time on `/clock` goes back at each `~/reset` and at
each turn of `loop`: listeners on simulated time see it jump. Started by hand, the player leaves at the end of
the bag; brought up by a manager it stands there until `~/reset`.
"""

import argparse
import dataclasses
import sys
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from rclpy.parameter import Parameter
from rclpy.utilities import remove_ros_args

from bags.parameters import PlayerParameters, pattern
from bags.playback import NS_PER_S, Audience, Playback, programme
from bags.read_ahead import ReadAhead
from bags.reader import Bag, RawMessage, open_bag
from bags.topic_speaker import TopicSpeaker, installed
from robustnav_msgs_py.conversions import clock_to_message
from robustnav_msgs_py.errors import BadFileError, BadParameterError, RobustnavError
from robustnav_msgs_py.values import ERROR
from robustnav_nodes.graph.node import GraphNode
from robustnav_nodes.graph.spin import RCLError, run_nodes

CLOCK = "/clock"
# How finely messages are timed.
TICK_S = 0.002
# How long the thread that reads may keep Python's lock from the one that plays; usually it is 5 ms.
SWITCH_INTERVAL_S = 0.0005
# How long the executor may be kept busy before services get their turn.
TURN_S = 0.01
FIGURES_PERIOD_S = 1.0
# Longer than a recorder takes between two looks for new topics.
SETTLE_S = 0.3
# A bag of a single moment, played in a loop, must not become a flood.
SHORTEST_LOOP_S = 0.1


class Player(GraphNode[PlayerParameters]):
    """Plays a bag while it is active; see the module's docstring for its interface."""

    executable: ClassVar[str] = "player"
    declaration: ClassVar[type] = PlayerParameters

    def __init__(self, **node_options: Any) -> None:
        super().__init__(**node_options)
        self._bag: Bag | None = None
        self._speaker: TopicSpeaker | None = None
        self._reading: ReadAhead | None = None
        if self.autostart:
            try:
                self._open()  # whoever started it by hand is told at once what cannot be played
            except RobustnavError:
                self.destroy_node()
                raise

    def configure(self) -> None:
        """Open the bag, and offer the services."""
        if self._bag is None:
            self._open()
        bag = self._opened
        for topic, sentence in self._programme.left_out:
            self.health.problem(topic, sentence)
        if bag.cut:
            self.health.problem("bag", f"{bag.cut}; this is played")
        self._played = self.parameters
        self.serve("~/pause", self._pause)
        self.serve("~/step", self._step)
        self.serve("~/reset", self._reset)
        self.every(TICK_S, self._run, steady=True)
        self.every(FIGURES_PERIOD_S, self._show_figures, steady=True)
        if self._played.clock_hz > 0.0 and all(row.name != CLOCK for row in self._programme.topics):
            self._clock_out = self.publisher(CLOCK)
            self.every(1.0 / self._played.clock_hz, self._tell_time, steady=True)

    def activate(self) -> None:
        """Take the topics, begin to read, and play as soon as somebody listens."""
        parameters, chosen = self.parameters, self._programme
        self._speaker = TopicSpeaker(self, chosen.topics, depth=parameters.depth, say=self.health.problem)
        if not self._speaker.topics:
            self.exit_code = 1 if self.autostart else None
            raise BadFileError(
                f"ROS takes none of the topics of {self._opened.path}, so nothing can be played"
            )
        self._audience: Audience | None = Audience(wait_s=parameters.wait_for_s, settle_s=SETTLE_S)
        self._begin(paused=parameters.start_paused)
        seconds = (chosen.last_ns - chosen.start_ns) / NS_PER_S
        self.get_logger().info(
            f"playing {self._opened.path}: {len(self._speaker.topics)} topics, {seconds:.1f} s, "
            f"at {parameters.rate:g} times its speed"
        )

    def deactivate(self) -> None:
        """Stop reading, and leave the topics when what was played is received."""
        self._stop_reading()
        if self._speaker is not None:
            self._speaker.close()
            self._speaker = None

    def cleanup(self) -> None:
        """Close the bag."""
        if self._bag is not None:
            self._bag.close()
            self._bag = None

    def destroy_node(self) -> None:
        """Stop playing, whatever state the node is in, and take it down."""
        self.deactivate()
        self.cleanup()
        super().destroy_node()

    def parameters_changed(self) -> None:
        """`rate` and `loop` count at once, everything else when the node is configured again."""
        if self._reading is None:
            return
        self._playback.set_rate(self.parameters.rate, self.steady_s())
        used = dataclasses.replace(self._played, rate=self.parameters.rate, loop=self.parameters.loop)
        if used != self.parameters:
            self.health.problem(
                "parameters", "all but rate and loop take effect when the node is configured again"
            )

    @property
    def _opened(self) -> Bag:
        if self._bag is None:
            raise BadFileError("no bag is open: configure the node first")
        return self._bag

    @property
    def _speaking(self) -> TopicSpeaker:
        if self._speaker is None:
            raise BadFileError("nothing is played: activate the node first")
        return self._speaker

    def _open(self) -> None:
        """Open the bag and choose what is played; raises where there is nothing to play."""
        parameters = self.parameters
        include = pattern("include", parameters.include)
        exclude = pattern("exclude", parameters.exclude) if parameters.exclude else None
        if not parameters.bag:
            raise BadParameterError("which bag is to be played? ros2 run bags player BAG, or -p bag:=BAG")
        self._bag = open_bag(Path(parameters.bag).expanduser())
        chosen = programme(self._bag, include=include, exclude=exclude, start_s=parameters.start_s)
        self._programme = installed(chosen, self._bag.path)

    def _begin(self, *, paused: bool) -> None:
        """Play from the start."""
        self._stop_reading()
        chosen = self._programme
        self._reading = ReadAhead(chosen.messages(self._opened))
        self._playback = Playback(
            self._reading, start_ns=chosen.start_ns, rate=self.parameters.rate, paused=paused
        )
        self._begun_s = self.steady_s()
        self._at_end = False
        self._sent, self._latest_s = 0, 0.0

    def _stop_reading(self) -> None:
        if self._reading is not None:
            self._reading.close()
            self._reading = None

    def _run(self) -> None:
        """Play what is due, as much as fits into one turn."""
        now_s = self.steady_s()
        if self._at_end or not self._audience_is_there(now_s):
            return
        end_of_turn_s = now_s + TURN_S
        try:
            while now_s < end_of_turn_s and (message := self._playback.due(now_s)) is not None:
                self._say(message)
                self._latest_s = max(self._latest_s, self._playback.late_s(message, now_s))
                now_s = self.steady_s()
            ended = self._playback.ended
        except BadFileError as error:
            self.health.problem("bag", str(error), ERROR)
            self._end(1)
            return
        if not ended or self._playback.paused:
            return
        if not self.parameters.loop:
            self._end(0)
        elif now_s - self._begun_s >= SHORTEST_LOOP_S:
            self._begin(paused=False)

    def _audience_is_there(self, now_s: float) -> bool:
        if self._audience is not None and self._audience.is_there(self._speaking.listeners(), now_s):
            self._audience = None
            self._begun_s = now_s
        return self._audience is None

    def _say(self, message: RawMessage) -> None:
        if self._speaking.say(message):
            self._sent += 1

    def _end(self, exit_code: int) -> None:
        """Nothing more is played; the process leaves where nobody else decides that."""
        self._at_end = True
        seconds = self.steady_s() - self._begun_s
        self.get_logger().info(f"the bag is at its end: {self._sent} messages played in {seconds:.1f} s")
        self._show_figures()
        if self.autostart:
            self.exit_code = exit_code

    def _tell_time(self) -> None:
        self._clock_out.publish(clock_to_message(self._playback.time_ns(self.steady_s())))

    def _show_figures(self) -> None:
        chosen, playback = self._programme, self._playback
        figures = {
            "bag": self._opened.path,
            "time in the bag, s": round((playback.time_ns(self.steady_s()) - chosen.first_ns) / NS_PER_S, 3),
            "length, s": round((chosen.last_ns - chosen.first_ns) / NS_PER_S, 3),
            "messages sent": self._sent,
            "late at most, ms": round(self._latest_s * 1e3, 3),  # since it was last shown
            "state": "at the end" if self._at_end else "paused" if playback.paused else "playing",
        }
        for name, value in figures.items():
            self.health.figure(name, str(value))
        self._latest_s = 0.0

    def _pause(self, request: Any, response: Any) -> Any:
        change = self._playback.pause if request.data else self._playback.go_on
        change(self.steady_s())
        response.success = True
        response.message = "time stands" if request.data else "time goes on"
        return response

    def _step(self, _request: Any, response: Any) -> Any:
        response.success = False
        if not self._playback.paused:
            response.message = "time is not paused: call ~/pause with data: true first"
            return response
        message = self._playback.step()
        if message is None:
            response.message = "the bag is at its end" if self._playback.ended else "the bag is still read"
            return response
        self._say(message)
        seconds = (message.log_time_ns - self._programme.first_ns) / NS_PER_S
        response.success, response.message = True, f"{message.topic} at {seconds:.6f} s"
        return response

    def _reset(self, _request: Any, response: Any) -> Any:
        self._begin(paused=self._playback.paused)
        response.success, response.message = True, "playing from the start"
        return response


def main() -> int:
    """Play a bag to its end, or until told to stop."""
    parser = argparse.ArgumentParser(
        prog="player",
        description="Play a bag. Its parameters follow --ros-args: --ros-args -p rate:=2.0 -p loop:=true",
    )
    parser.add_argument("bag", nargs="?", help="folder of the bag, or an .mcap file (parameter bag)")
    try:
        arguments = remove_ros_args(sys.argv)[1:]
    except RCLError:
        arguments = []  # run_nodes says what is wrong with them
    bag = parser.parse_args(arguments).bag
    sys.setswitchinterval(SWITCH_INTERVAL_S)
    given = [] if bag is None else [Parameter("bag", value=bag)]
    return run_nodes([partial(Player, parameter_overrides=given)])


if __name__ == "__main__":
    sys.exit(main())
