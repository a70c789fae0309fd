"""Reading ahead keeps order, stays within its memory, and hands errors over after what came before."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from bags.read_ahead import MESSAGE_BYTES, ReadAhead
from bags.reader import RawMessage
from robustnav_msgs_py.errors import BadFileError

LIMIT_S = 20.0


def message(number: int, size: int = 0) -> RawMessage:
    return RawMessage(topic="/a", type="T", log_time_ns=number, publish_time_ns=number, data=bytes(size))


@contextmanager
def reading(messages: Iterator[RawMessage], limit_bytes: int) -> Iterator[ReadAhead]:
    made = ReadAhead(messages, limit_bytes=limit_bytes)
    try:
        yield made
    finally:
        made.close()


def take_all(source: ReadAhead) -> list[int]:
    taken = []
    while source.first(LIMIT_S) is not None:
        taken.append(source.take().log_time_ns)
    return taken


@pytest.mark.parametrize("limit_bytes", [1, 10 * MESSAGE_BYTES, 10**9])
def test_all_messages_come_in_order_whatever_the_bound(limit_bytes: int) -> None:
    with reading((message(number) for number in range(3000)), limit_bytes) as source:
        assert take_all(source) == list(range(3000))
        assert source.ended
        assert source.failure is None
        assert source.waiting_bytes == 0


def test_no_more_is_read_than_the_bound_allows() -> None:
    sizes = [10, 900, 30, 2000, 5, 5, 700, 5000, 1, 1] * 50
    limit_bytes = 4 * MESSAGE_BYTES + 2500
    messages = (message(number, size) for number, size in enumerate(sizes))
    with reading(messages, limit_bytes) as source:
        for size in sizes:
            assert source.first(LIMIT_S) is not None
            assert source.waiting_bytes <= max(limit_bytes, MESSAGE_BYTES + size)
            source.take()


def test_an_error_comes_after_what_was_read_before_it() -> None:
    def broken() -> Iterator[RawMessage]:
        yield message(0)
        yield message(1)
        raise BadFileError("damaged inside")

    with reading(broken(), 10**6) as source:
        assert take_all(source) == [0, 1]
        assert source.ended
        assert isinstance(source.failure, BadFileError)


def test_nothing_is_waited_for_unless_asked() -> None:
    gate = threading.Event()

    def slow() -> Iterator[RawMessage]:
        gate.wait(LIMIT_S)
        yield message(0)

    with reading(slow(), 10**6) as source:
        assert source.first() is None
        assert not source.ended
        gate.set()
        assert source.first(LIMIT_S) == message(0)


def test_reading_can_be_stopped_while_it_waits_for_room() -> None:
    read = []

    def endless() -> Iterator[RawMessage]:
        for number in range(10**9):
            read.append(number)
            yield message(number)

    with reading(endless(), 5 * MESSAGE_BYTES) as source:
        source.first(LIMIT_S)
    assert len(read) <= 7
