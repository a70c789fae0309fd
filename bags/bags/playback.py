"""What of a bag is played, in which order and when; knows no ROS."""

import re
from collections import deque
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from typing import Protocol

from bags.bag_metadata import TopicRow
from bags.played_qos import is_latched, latched_depth
from bags.reader import Bag, RawMessage
from robustnav_msgs_py.errors import BadFileError, BadParameterError

NS_PER_S = 1_000_000_000
# How long a step waits for a message that is still being read.
STEP_WAIT_S = 1.0
# How far before the start it is first looked for what was latched.
FIRST_SPAN_NS = 4 * NS_PER_S


@dataclass(frozen=True, slots=True, kw_only=True)
class Programme:
    """What is played: topics that have messages, from log time `start_ns`; `first_ns`, `last_ns`: the bag's.

    `left_out` holds a topic and a sentence for each that was chosen but has to be left out.
    """

    topics: tuple[TopicRow, ...]
    first_ns: int
    start_ns: int
    last_ns: int
    left_out: tuple[tuple[str, str], ...] = ()

    def messages(self, bag: Bag) -> Iterator[RawMessage]:
        """Its messages in order of log time.

        First come the last ones that were latched before the start: what a listener would have found there.
        Raises BadFileError where the bag is damaged inside.
        """
        if self.start_ns > self.first_ns:
            yield from _latched_before(bag, self.topics, self.first_ns, self.start_ns)
        wanted = {(row.name, row.type) for row in self.topics}
        for raw in bag.raw_messages({row.name for row in self.topics}, start_ns=self.start_ns):
            if (raw.topic, raw.type) in wanted:
                yield raw


def programme(
    bag: Bag, *, include: re.Pattern[str], exclude: re.Pattern[str] | None, start_s: float
) -> Programme:
    """The topics whose names match `include` and not `exclude`, wholly, from `start_s` after the bag's begin.

    Of a topic that was recorded with several types, the one with the most messages is played. Raises
    BadFileError where the bag holds no message, BadParameterError where nothing is chosen of what it holds.
    """
    span = bag.span_ns
    if span is None:
        raise BadFileError(f"{bag.path} holds no message, so there is nothing to play")
    start_ns = span[0] + round(start_s * NS_PER_S)
    if start_ns > span[1]:
        raise BadParameterError(
            f"parameter 'start_s' is {start_s!r}, but {bag.path} is only "
            f"{(span[1] - span[0]) / NS_PER_S:g} s long; start earlier"
        )
    chosen: dict[str, TopicRow] = {}
    left_out = []
    for row in bag.topics:
        skipped = not include.fullmatch(row.name) or (exclude and exclude.fullmatch(row.name))
        if skipped or not row.message_count:
            continue
        known = chosen.get(row.name)
        if known is None:
            chosen[row.name] = row
            continue
        more, fewer = sorted((known, row), key=lambda found: -found.message_count)
        chosen[row.name] = more
        left_out.append(
            (
                row.name,
                f"{fewer.message_count} messages of type {fewer.type} are left out: most are {more.type}",
            )
        )
    if not chosen:
        excluded = f" and not {exclude.pattern!r}" if exclude else ""
        raise BadParameterError(
            f"no topic of {bag.path} that has messages matches {include.pattern!r}{excluded}; see what it "
            "holds with `robustnav bag info`"
        )
    return Programme(
        topics=tuple(chosen.values()),
        first_ns=span[0],
        start_ns=start_ns,
        last_ns=span[1],
        left_out=tuple(left_out),
    )


def _latched_before(bag: Bag, topics: Collection[TopicRow], first_ns: int, start_ns: int) -> list[RawMessage]:
    """What a listener that came at `start_ns` would have found latched.

    It is looked for backwards, in longer and longer spans: of most topics the last message is near, and the
    index of a file leads past whatever does not hold the others.
    """
    types = {row.name: row.type for row in topics if is_latched(row)}
    depths = {row.name: latched_depth(row) for row in topics if row.name in types}
    kept: dict[str, list[RawMessage]] = {name: [] for name in types}
    span_ns, until_ns = FIRST_SPAN_NS, start_ns
    while until_ns > first_ns:
        wanted = {name for name, found in kept.items() if len(found) < depths[name]}
        if not wanted:
            break
        from_ns = max(first_ns, until_ns - span_ns)
        last = {name: deque[RawMessage](maxlen=depths[name] - len(kept[name])) for name in wanted}
        for raw in bag.raw_messages(wanted, start_ns=from_ns, stop_ns=until_ns):
            if raw.type == types[raw.topic]:
                last[raw.topic].append(raw)
        for name, found in last.items():
            kept[name] = [*found, *kept[name]]
        span_ns, until_ns = 4 * span_ns, from_ns
    return sorted((raw for found in kept.values() for raw in found), key=lambda raw: raw.log_time_ns)


class Source(Protocol):
    """Messages in the order in which they are played, as they are read."""

    @property
    def ended(self) -> bool:
        """Whether all were taken, and no more come."""

    @property
    def failure(self) -> Exception | None:
        """Why no more come, where that is not the end of the bag."""

    def first(self, wait_s: float = 0.0) -> RawMessage | None:
        """The next one, None where it is not read yet (after `wait_s`) or there is none."""

    def take(self) -> RawMessage:
        """Take the one that `first` gave."""


class Playback:
    """Says which message is due when: `rate` seconds of the bag pass in one second of wall time.

    Time starts with the first `due` for which a message is read. It stands while paused. Messages from before
    `start_ns` (what was latched) are due at once, also while paused. `now_s` is wall time from any begin.
    Use it from one thread.
    """

    def __init__(self, source: Source, *, start_ns: int, rate: float, paused: bool = False) -> None:
        self.paused = paused
        self._source = source
        self._start_ns = start_ns
        self._rate = rate
        self._last_ns = start_ns
        # Bag time passes from here on; no wall time belongs to it until the first message is there.
        self._from_ns = start_ns
        self._from_s: float | None = None

    @property
    def ended(self) -> bool:
        """Whether every message was played."""
        return self._source.ended

    def due(self, now_s: float) -> RawMessage | None:
        """Take the next message if its time has come.

        Raises BadFileError where the bag cannot be read any further.
        """
        message = self._next()
        if message is None:
            return None
        if message.log_time_ns < self._start_ns:
            return self._source.take()
        if self.paused:
            return None
        if self._from_s is None:
            self._from_s = now_s
        if message.log_time_ns > self._scheduled_ns(now_s):
            return None
        self._last_ns = max(self._last_ns, message.log_time_ns)
        return self._source.take()

    def late_s(self, message: RawMessage, now_s: float) -> float:
        """How much wall time after its time a message is played; 0 for what was latched before the start."""
        if message.log_time_ns < self._start_ns:
            return 0.0
        return (self._scheduled_ns(now_s) - message.log_time_ns) / NS_PER_S / self._rate

    def step(self) -> RawMessage | None:
        """Take the next message, whatever the time; None at the end. For use while paused.

        Raises BadFileError where the bag cannot be read any further.
        """
        if self._next(STEP_WAIT_S) is None:
            return None
        message = self._source.take()
        self._last_ns = self._from_ns = max(self._last_ns, message.log_time_ns)
        return message

    def pause(self, now_s: float) -> None:
        """Let time stand."""
        self._from_ns, self._from_s = self.time_ns(now_s), None
        self.paused = True

    def go_on(self, now_s: float) -> None:
        """Let time pass again, from where the bag stands."""
        self._from_ns, self._from_s = self.time_ns(now_s), None
        self.paused = False

    def set_rate(self, rate: float, now_s: float) -> None:
        """Play faster or slower, from where the bag stands: what is late is not made up for."""
        self._from_ns = self.time_ns(now_s)
        self._from_s = None if self._from_s is None else now_s
        self._rate = rate

    def time_ns(self, now_s: float) -> int:
        """Log time up to which the bag is played; never beyond a message that is still to come."""
        scheduled_ns = self._scheduled_ns(now_s)
        following = self._source.first()
        if following is None:  # at the end, or the disk is behind
            return min(scheduled_ns, self._last_ns)
        return max(self._last_ns, min(scheduled_ns, following.log_time_ns))

    def _next(self, wait_s: float = 0.0) -> RawMessage | None:
        message = self._source.first(wait_s)
        if message is None and self._source.ended and self._source.failure is not None:
            raise self._source.failure
        return message

    def _scheduled_ns(self, now_s: float) -> int:
        passed_s = 0.0 if self._from_s is None else now_s - self._from_s
        return self._from_ns + round(passed_s * self._rate * NS_PER_S)


class Audience:
    """Whether those who want to hear have come.

    They come one after the other, as they discover the player: it is waited until nobody new has come for
    `settle_s`, and `wait_s` at most.
    """

    def __init__(self, *, wait_s: float, settle_s: float) -> None:
        self._wait_s = wait_s
        self._settle_s = settle_s
        self._since_s: float | None = None
        self._changed_s = 0.0
        self._listeners = 0

    def is_there(self, listeners: int, now_s: float) -> bool:
        """Whether to begin at wall time `now_s`, when there are `listeners`."""
        if self._since_s is None:
            self._since_s = now_s
        if listeners != self._listeners:
            self._listeners, self._changed_s = listeners, now_s
        settled = listeners > 0 and now_s - self._changed_s >= self._settle_s
        return settled or now_s - self._since_s >= self._wait_s
