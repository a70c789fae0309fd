"""Nodes in lock-step without nodes: who hears what, in which order, and when timers fire."""

import itertools
from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py import contract
from robustnav_msgs_py.conversions import clock_to_message
from robustnav_nodes.graph.lockstep import (
    CLOCK,
    NS_PER_S,
    Lockstep,
    LockstepOutlet,
    LockstepWork,
    Said,
)

VOLATILE = contract.topic("cmd_vel")
LATCHED = contract.topic("map")
MS = 1_000_000


def test_everybody_hears_a_message_before_the_next_one() -> None:
    heard: list[tuple[str, Any]] = []
    lockstep = Lockstep()
    for name in ("a", "b"):
        lockstep.listen("/t", VOLATILE, lambda message, name=name: heard.append((name, message)))
    for message in (1, 2):
        lockstep.say("/t", VOLATILE, message)
    assert heard == []
    lockstep.settle()
    assert heard == [("a", 1), ("b", 1), ("a", 2), ("b", 2)]


def test_what_is_said_about_a_message_comes_after_what_was_said_before() -> None:
    heard: list[Any] = []
    lockstep = Lockstep(lambda said: heard.append((said.topic, said.message)))

    def answer(message: Any) -> None:
        lockstep.say("/answer", VOLATILE, -message)

    lockstep.listen("/ask", VOLATILE, answer)
    lockstep.say("/ask", VOLATILE, 1)
    lockstep.say("/ask", VOLATILE, 2)
    lockstep.settle()
    assert heard == [("/ask", 1), ("/ask", 2), ("/answer", -1), ("/answer", -2)]


def test_who_comes_late_hears_what_is_latched_and_nothing_else() -> None:
    lockstep = Lockstep()
    for message in range(5):
        lockstep.say("/map", LATCHED, message)
        lockstep.say("/cmd_vel", VOLATILE, message)
    lockstep.settle()
    late: list[Any] = []
    lockstep.listen("/map", LATCHED, late.append)
    lockstep.listen("/cmd_vel", VOLATILE, late.append)
    assert late == []
    lockstep.settle()
    assert late == list(range(5))[-LATCHED.qos.depth :]


def test_who_comes_between_a_word_and_its_delivery_hears_it_once_after_what_was_latched() -> None:
    lockstep, heard = Lockstep(), list[int]()
    lockstep.say("map", LATCHED, 1)
    lockstep.settle()
    lockstep.say("map", LATCHED, 2)
    lockstep.listen("map", LATCHED, heard.append)
    lockstep.settle()
    assert heard == [1, 2]


def test_who_no_longer_listens_hears_nothing() -> None:
    lockstep, heard = Lockstep(), []
    lockstep.listen("/t", VOLATILE, heard.append)
    assert lockstep.listeners("/t") == 1
    lockstep.forget("/t", heard.append)
    lockstep.say("/t", VOLATILE, 1)
    lockstep.settle()
    assert heard == []
    assert lockstep.listeners("/t") == 0


@given(st.lists(st.integers(1, 40), min_size=1, max_size=6), st.lists(st.integers(0, 120), max_size=5))
def test_timers_fire_when_they_are_due_the_first_made_first(
    periods_ms: list[int], stops_ms: list[int]
) -> None:
    """However time is cut into pieces."""
    lockstep = Lockstep(begin_ns=0)
    fired: list[tuple[int, int]] = []
    for number, period_ms in enumerate(periods_ms):
        lockstep.timer(period_ms / 1e3, lambda number=number: fired.append((lockstep.time_ns, number)))
    for stop_ms in [*sorted(stops_ms), 120]:
        lockstep.advance(stop_ms * MS)
        assert lockstep.time_ns == stop_ms * MS
    due = [
        (k * p * MS, n)
        for n, p in enumerate(periods_ms)
        for k in itertools.takewhile(lambda k, p=p: k * p <= 120, itertools.count(1))
    ]
    assert fired == sorted(due)


def test_all_that_follows_a_timer_is_handled_before_the_next_one() -> None:
    order: list[str] = []
    lockstep = Lockstep(begin_ns=0)
    lockstep.listen("/t", VOLATILE, lambda _: order.append("heard"))
    lockstep.timer(0.010, lambda: (order.append("first"), lockstep.say("/t", VOLATILE, 1)))
    lockstep.timer(0.010, lambda: order.append("second"))
    lockstep.advance(10 * MS)
    assert order == ["first", "heard", "second"]


def test_a_cancelled_timer_fires_no_more_and_one_made_by_a_timer_does() -> None:
    lockstep = Lockstep(begin_ns=0)
    fired: list[str] = []

    def once() -> None:
        fired.append("once")
        timer.cancelled = True
        lockstep.timer(0.030, lambda: fired.append("later"))

    timer = lockstep.timer(0.010, once)
    lockstep.advance(100 * MS)
    assert fired == ["once", "later", "later", "later"]


def test_advancing_backwards_does_nothing() -> None:
    lockstep = Lockstep(begin_ns=NS_PER_S)
    lockstep.timer(0.1, lambda: pytest.fail("it is not due"))
    lockstep.advance(0)
    assert lockstep.time_ns == NS_PER_S


def test_what_is_said_is_watched_at_its_time_and_the_clock_sets_ros_time() -> None:
    said: list[Said] = []
    lockstep = Lockstep(said.append, begin_ns=5 * NS_PER_S)
    lockstep.say(CLOCK, contract.topic(CLOCK), clock_to_message(7 * NS_PER_S))
    assert lockstep.ros_time_ns == 0
    lockstep.settle()
    assert lockstep.ros_time_ns == 7 * NS_PER_S
    assert [(item.topic, item.time_ns) for item in said] == [(CLOCK, 5 * NS_PER_S)]


def test_an_outlet_is_silent_while_its_node_is_not_active() -> None:
    lockstep, heard, is_open = Lockstep(), [], False
    lockstep.listen("/t", VOLATILE, heard.append)
    outlet = LockstepOutlet(lockstep, "/t", VOLATILE, lambda: is_open)
    outlet.publish(1)
    is_open = True
    outlet.publish(2)
    lockstep.settle()
    assert heard == [2]
    assert outlet.get_subscription_count() == 2  # with the one that watches


def run_guarded(work: Callable[[], None]) -> None:
    work()


def test_work_is_done_at_once_and_handed_over_when_its_turn_comes() -> None:
    lockstep, order = Lockstep(), []
    lockstep.listen("/t", VOLATILE, order.append)
    worker = LockstepWork(lockstep, run_guarded, pytest.fail)
    lockstep.say("/t", VOLATILE, "before")
    worker.submit(lambda: order.append("job") or "result", order.append)
    lockstep.say("/t", VOLATILE, "after")
    assert order == ["job"]
    assert worker.busy
    lockstep.settle()
    assert order == ["job", "before", "result", "after"]
    assert not worker.busy


def test_a_job_that_fails_is_told_and_the_worker_goes_on() -> None:
    lockstep, failures, results = Lockstep(), [], []
    worker = LockstepWork(lockstep, run_guarded, failures.append)
    worker.submit(lambda: 1 // 0, results.append)
    assert failures == []
    lockstep.settle()
    assert [type(failure) for failure in failures] == [ZeroDivisionError]
    assert not worker.busy
    worker.submit(lambda: 7, results.append)
    lockstep.settle()
    assert results == [7]
