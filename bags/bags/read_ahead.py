"""Reads messages ahead in a thread of its own, with bounded memory: playing never waits for the disk."""

import threading
import time
from collections import deque
from collections.abc import Iterator

from bags.reader import RawMessage

READ_AHEAD_BYTES = 32 * 1024 * 1024
# What a message takes in memory besides its bytes; millions of tiny ones must not slip through the bound.
MESSAGE_BYTES = 400


class ReadAhead:
    """Messages of an iterator, which its thread runs ahead of the one that takes them.

    At most `limit_bytes` wait to be taken (a single message may be larger). The iterator, and what it reads
    from, belong to the thread until `close()` returns; what it raises ends the reading, and is `failure`. All
    else belongs to one other thread.
    """

    def __init__(self, messages: Iterator[RawMessage], *, limit_bytes: int = READ_AHEAD_BYTES) -> None:
        self.failure: Exception | None = None
        self._messages = messages
        self._limit_bytes = limit_bytes
        self._waiting: deque[RawMessage] = deque()
        self._waiting_bytes = 0
        self._finished = self._closing = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="reading ahead", daemon=True)
        self._thread.start()

    @property
    def waiting_bytes(self) -> int:
        """Memory that messages take which are read but not taken."""
        return self._waiting_bytes

    @property
    def ended(self) -> bool:
        """Whether all were taken, and no more come."""
        return self._finished and not self._waiting

    def first(self, wait_s: float = 0.0) -> RawMessage | None:
        """The next message, None where it is not read yet (after `wait_s`) or there is none."""
        if not self._waiting and wait_s > 0.0:
            deadline_s = time.monotonic() + wait_s
            with self._changed:
                while not self._waiting and not self._finished:
                    left_s = deadline_s - time.monotonic()
                    if left_s <= 0.0:
                        break
                    self._changed.wait(left_s)
        return self._waiting[0] if self._waiting else None

    def take(self) -> RawMessage:
        """Take the message that `first` gave."""
        with self._changed:
            message = self._waiting.popleft()
            before = self._waiting_bytes
            self._waiting_bytes -= _size(message)
            # Not for each message: a thread that wakes for each one costs more than reading it.
            if before > self._limit_bytes // 2 >= self._waiting_bytes or not self._waiting:
                self._changed.notify_all()
            return message

    def close(self) -> None:
        """Stop reading; returns when the thread has ended."""
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join()

    def _run(self) -> None:
        try:
            for message in self._messages:
                if not self._put(message):
                    break
        except Exception as error:  # it is raised where the messages are taken
            self.failure = error
        with self._changed:
            self._finished = True
            self._changed.notify_all()

    def _put(self, message: RawMessage) -> bool:
        """Hand over a message once there is room; False where no more are wanted."""
        size = _size(message)
        with self._changed:
            if self._waiting and self._waiting_bytes + size > self._limit_bytes:
                self._changed.wait_for(lambda: self._has_room(size))
            if self._closing:
                return False
            self._waiting.append(message)
            self._waiting_bytes += size
            if len(self._waiting) == 1:
                self._changed.notify_all()
            return True

    def _has_room(self, size: int) -> bool:
        if self._closing or not self._waiting:
            return True
        half_empty = self._waiting_bytes <= self._limit_bytes // 2
        return half_empty and self._waiting_bytes + size <= self._limit_bytes


def _size(message: RawMessage) -> int:
    return len(message.data) + MESSAGE_BYTES
