"""Nodes in lock-step: one thread, no transport, a clock that goes from timer to timer.

Every message is handled by all who hear it before the next one, in the order in which they were said; long
work is done at once; no wall clock is looked at. The same nodes, parameters and inputs say the same.
"""

import heapq
import itertools
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

from rclpy.lifecycle import LifecycleNode

from robustnav_msgs_py.contract import Topic
from robustnav_msgs_py.conversions import clock_from_message
from robustnav_nodes.graph.node import GraphNode

T = TypeVar("T")

NS_PER_S = 1_000_000_000
CLOCK = "/clock"


@dataclass(frozen=True, slots=True, kw_only=True)
class Said:
    """One message: `topic` is its full name, `row` its line of the contract, `time_ns` when it was said."""

    topic: str
    row: Topic
    message: Any
    time_ns: int


@dataclass(slots=True, kw_only=True)
class _Channel:
    """A topic: who hears it, and what a late listener still gets."""

    listeners: list[Callable[[Any], None]] = field(default_factory=list)
    kept: deque[Any] = field(default_factory=deque)


@dataclass(slots=True, kw_only=True, order=True)
class _Timer:
    due_ns: int
    number: int
    period_ns: int = field(compare=False)
    work: Callable[[], None] = field(compare=False)
    cancelled: bool = field(compare=False, default=False)


class Lockstep:
    """What joins the nodes of a run in lock-step. Use it from one thread.

    `wiring` is handed to the nodes (`GraphNode(wiring=...)`). `watch` is called with everything that is said,
    in order. `time_ns` stands for the wall clock: it moves only in `advance`.
    """

    def __init__(self, watch: Callable[[Said], None] = lambda _: None, *, begin_ns: int = NS_PER_S) -> None:
        self.time_ns = begin_ns
        self.ros_time_ns = 0
        self._watch = watch
        self._channels: dict[str, _Channel] = {}
        self._pending: deque[Callable[[], None]] = deque()
        self._timers: list[_Timer] = []
        self._numbers = itertools.count()

    def wiring(self, node: GraphNode[Any]) -> "LockstepWiring":
        """Join a node."""
        return LockstepWiring(self, node)

    def say(self, topic: str, row: Topic, message: Any) -> None:
        """Hand a message to all who hear `topic`, once what was said before is handled."""
        self._pending.append(partial(self._deliver, self._channel(topic), topic, row, message))

    def listen(self, topic: str, row: Topic, hear: Callable[[Any], None]) -> None:
        """Hear a topic from now on, and what is latched on it."""
        channel = self._channel(topic)
        channel.listeners.append(hear)
        # Before what waits: that is newer, and reaches the listener as all others.
        self._pending.extendleft(partial(hear, message) for message in reversed(channel.kept))

    def forget(self, topic: str, hear: Callable[[Any], None]) -> None:
        """No longer hear a topic."""
        self._channel(topic).listeners.remove(hear)

    def listeners(self, topic: str) -> int:
        """How many hear a topic."""
        return len(self._channel(topic).listeners)

    def soon(self, work: Callable[[], None]) -> None:
        """Do `work` once what was said before is handled."""
        self._pending.append(work)

    def settle(self) -> None:
        """Handle everything that was said, and what is said about it."""
        while self._pending:
            self._pending.popleft()()

    def timer(self, period_s: float, work: Callable[[], None]) -> _Timer:
        """Call `work` each `period_s`; of those that are due together the first made goes first."""
        period_ns = max(1, round(period_s * NS_PER_S))
        made = _Timer(
            due_ns=self.time_ns + period_ns, number=next(self._numbers), period_ns=period_ns, work=work
        )
        heapq.heappush(self._timers, made)
        return made

    def advance(self, until_ns: int) -> None:
        """Let time pass up to `until_ns`: timers fire when they are due, and all that follows is handled."""
        self.settle()
        while self._timers and self._timers[0].due_ns <= until_ns:
            timer = heapq.heappop(self._timers)
            if timer.cancelled:
                continue
            self.time_ns = max(self.time_ns, timer.due_ns)
            timer.due_ns += timer.period_ns
            heapq.heappush(self._timers, timer)
            timer.work()
            self.settle()
        self.time_ns = max(self.time_ns, until_ns)

    def _deliver(self, channel: _Channel, topic: str, row: Topic, message: Any) -> None:
        if row.qos.latched:
            channel.kept = deque([*channel.kept, message], maxlen=row.qos.depth)
        if topic == CLOCK:
            self.ros_time_ns = clock_from_message(message)
        self._watch(Said(topic=topic, row=row, message=message, time_ns=self.time_ns))
        for hear in list(channel.listeners):
            hear(message)

    def _channel(self, topic: str) -> _Channel:
        return self._channels.setdefault(topic, _Channel())


class LockstepOutlet:
    """A publisher in lock-step; `is_open` tells whether its node may speak."""

    def __init__(self, lockstep: Lockstep, topic: str, row: Topic, is_open: Callable[[], bool]) -> None:
        self._lockstep = lockstep
        self._topic = topic
        self._row = row
        self._is_open = is_open

    def publish(self, message: Any) -> None:
        """Say it; dropped while the node is not active."""
        if self._is_open():
            self._lockstep.say(self._topic, self._row, message)

    def get_subscription_count(self) -> int:
        """The nodes that hear, and the one that watches."""
        return self._lockstep.listeners(self._topic) + 1


class LockstepWork:
    """Does each job at once; its result is handed over when what was said before is handled."""

    def __init__(
        self,
        lockstep: Lockstep,
        guard: Callable[[Callable[[], None]], None],
        failed: Callable[[BaseException], None],
    ) -> None:
        self._lockstep = lockstep
        self._guard = guard
        self._failed = failed
        self.busy = False

    def submit(self, job: Callable[[], T], done: Callable[[T], None]) -> None:
        """Do `job`, and hand its result to `done`."""
        self.busy = True
        try:
            result = job()
        except Exception as error:
            self._lockstep.soon(partial(self._hand_over, partial(self._failed, error)))
        else:
            self._lockstep.soon(partial(self._hand_over, partial(self._guard, partial(done, result))))

    def _hand_over(self, work: Callable[[], None]) -> None:
        self.busy = False
        work()


class LockstepWiring:
    """Joins one node to a `Lockstep`; see `wiring.Wiring`."""

    def __init__(self, lockstep: Lockstep, node: GraphNode[Any]) -> None:
        self._lockstep = lockstep
        self._node = node
        self._timers: list[_Timer] = []
        self._heard: list[tuple[str, Callable[[Any], None]]] = []

    def publisher(self, row: Topic, *, managed: bool = True) -> LockstepOutlet:
        """See Wiring."""
        node = self._node
        is_open = (lambda: node.is_active) if managed else (lambda: True)
        return LockstepOutlet(self._lockstep, self._full_name(row), row, is_open)

    def subscription(self, row: Topic, hear: Callable[[Any], None]) -> None:
        """See Wiring."""
        topic = self._full_name(row)
        self._lockstep.listen(topic, row, hear)
        self._heard.append((topic, hear))

    def service(self, name: str, kind: str, respond: Callable[[Any, Any], Any]) -> None:
        """Nobody calls services in lock-step."""

    def timer(self, period_s: float, work: Callable[[], None], *, steady: bool) -> None:
        """See Wiring; ROS time and wall time go together here."""
        self._timers.append(self._lockstep.timer(period_s, work))

    def worker(
        self, guard: Callable[[Callable[[], None]], None], failed: Callable[[BaseException], None]
    ) -> LockstepWork:
        """See Wiring."""
        return LockstepWork(self._lockstep, guard, failed)

    def volatile_speakers(self, row: Topic) -> list[str]:
        """None: what is latched is latched."""
        return []

    def now_ns(self) -> int:
        """See Wiring: simulated time where `use_sim_time` is set."""
        simulated = bool(self._node.get_parameter("use_sim_time").value)
        return self._lockstep.ros_time_ns if simulated else self._lockstep.time_ns

    def steady_s(self) -> float:
        """See Wiring."""
        return self._lockstep.time_ns / NS_PER_S

    def take_down(self, silent_since_s: float) -> None:
        """See Wiring; what is said in lock-step has arrived."""
        for timer in self._timers:
            timer.cancelled = True
        for topic, hear in self._heard:
            self._lockstep.forget(topic, hear)
        self._timers.clear()
        self._heard.clear()

    def _full_name(self, row: Topic) -> str:
        node: LifecycleNode = self._node
        return str(node.resolve_topic_name(row.name))
