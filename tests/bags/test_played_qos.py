"""Whoever heard one of the recorded publishers hears the player."""

import pytest

from bags.bag_metadata import TopicRow
from bags.offered_qos import OfferedQos
from bags.played_qos import latched_depth, offer_to_play

RELIABLE = OfferedQos(history="unknown", depth=0)
BEST_EFFORT = OfferedQos(reliability="best_effort", history="unknown", depth=0)
LATCHED = OfferedQos(durability="transient_local", history="unknown", depth=0)


def row(*offers: OfferedQos, name: str = "/a", kind: str = "std_msgs/msg/String") -> TopicRow:
    return TopicRow(name=name, type=kind, offers=offers, message_count=1)


@pytest.mark.parametrize(
    ("offers", "reliability", "durability"),
    [
        ((), "reliable", "volatile"),
        ((RELIABLE,), "reliable", "volatile"),
        ((BEST_EFFORT, BEST_EFFORT), "best_effort", "volatile"),
        ((BEST_EFFORT, RELIABLE), "reliable", "volatile"),
        ((LATCHED,), "reliable", "transient_local"),
        ((BEST_EFFORT, LATCHED), "reliable", "transient_local"),
    ],
)
def test_the_most_that_anybody_offered_is_offered(
    offers: tuple[OfferedQos, ...], reliability: str, durability: str
) -> None:
    offer = offer_to_play(row(*offers), depth=1000)
    assert (offer.reliability, offer.durability, offer.history) == (reliability, durability, "keep_last")


def test_deadline_and_lifespan_are_offered_again_where_all_agreed() -> None:
    timed = OfferedQos(deadline_ns=10**8, lifespan_ns=10**9, depth=3)
    assert offer_to_play(row(timed, timed), depth=1).deadline_ns == 10**8
    assert offer_to_play(row(timed, timed), depth=1).lifespan_ns == 10**9
    assert offer_to_play(row(timed, RELIABLE), depth=1).deadline_ns == OfferedQos().deadline_ns


@pytest.mark.parametrize(
    ("topic", "depth"),
    [
        (row(OfferedQos(durability="transient_local", depth=7)), 7),
        (row(LATCHED), 1),
        (row(LATCHED, LATCHED, RELIABLE), 2),
        (row(LATCHED, name="/chat/to_user"), 50),
        (row(LATCHED, name="/robot1/chat/to_user"), 50),
        (row(LATCHED, name="/chat/to_user", kind="std_msgs/msg/UInt64"), 1),
        (row(LATCHED, name="/tf_static", kind="tf2_msgs/msg/TFMessage"), 100),
    ],
)
def test_a_late_listener_gets_as_much_as_in_the_recorded_run(topic: TopicRow, depth: int) -> None:
    assert latched_depth(topic) == depth
    assert offer_to_play(topic, depth=1000).depth == depth


def test_volatile_topics_keep_enough_for_slow_listeners() -> None:
    assert offer_to_play(row(RELIABLE), depth=1000).depth == 1000
    assert offer_to_play(row(OfferedQos(depth=5000)), depth=1000).depth == 5000
