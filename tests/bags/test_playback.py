"""What is played of a bag, in which order, and when; with a clock that the test turns."""

import itertools
import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bags.definitions import message_definition
from bags.manifest import Manifest
from bags.offered_qos import OfferedQos
from bags.playback import Audience, Playback, Programme, programme
from bags.reader import Bag, RawMessage, open_bag
from bags.writer import BagWriter
from robustnav_msgs_py.errors import BadFileError, BadParameterError

PREFIXES = (Path(sys.prefix),)
S = 1_000_000_000
BEGIN_NS = 1000 * S
LATCHED = OfferedQos(durability="transient_local", history="unknown", depth=0)


@dataclass
class Listed:
    """Messages that are read already, but for those from number `unread` on."""

    messages: list[RawMessage]
    unread: int | None = None
    failure: Exception | None = None
    _taken: int = field(default=0)

    @property
    def ended(self) -> bool:
        return self._taken == len(self.messages)

    def first(self, wait_s: float = 0.0) -> RawMessage | None:
        return None if self.ended or self._taken == self.unread else self.messages[self._taken]

    def take(self) -> RawMessage:
        self._taken += 1
        return self.messages[self._taken - 1]


def message(at_s: float, topic: str = "/a") -> RawMessage:
    time_ns = BEGIN_NS + round(at_s * S)
    return RawMessage(topic=topic, type="T", log_time_ns=time_ns, publish_time_ns=time_ns, data=b"")


def playing(*at_s: float, rate: float = 1.0, paused: bool = False, start_s: float = 0.0) -> Playback:
    return Playback(
        Listed([message(second) for second in at_s]),
        start_ns=BEGIN_NS + round(start_s * S),
        rate=rate,
        paused=paused,
    )


def seconds(found: RawMessage | None) -> float | None:
    return None if found is None else (found.log_time_ns - BEGIN_NS) / S


def due(playback: Playback, now_s: float) -> list[float]:
    """All that is due at once, in seconds of the bag."""
    found = iter(lambda: seconds(playback.due(now_s)), None)
    return [second for second in found if second is not None]


def time_s(playback: Playback, now_s: float) -> float:
    return (playback.time_ns(now_s) - BEGIN_NS) / S


def write(folder: Path, *spoken: tuple[str, float], offers: dict[str, OfferedQos] | None = None) -> Path:
    """A bag of texts: topic and second of each message, numbered from 0 in the order given."""
    with BagWriter(folder, manifest=Manifest(version="0", wall_start_ns=1)) as writer:
        channels: dict[str, int] = {}
        for number, (topic, second) in enumerate(spoken):
            if topic not in channels:
                definition = message_definition("std_msgs/msg/UInt64", PREFIXES)
                told = (offers or {}).get(topic)
                channels[topic] = writer.add_topic(topic, definition, [told] if told else [])
            at_ns = BEGIN_NS + round(second * S)
            data = b"\0\1\0\0" + number.to_bytes(8, "little")
            writer.write(channels[topic], log_time_ns=at_ns, publish_time_ns=at_ns, data=data)
    return folder


def chosen(bag: Bag, include: str = ".*", exclude: str = "", start_s: float = 0.0) -> Programme:
    leave_out = re.compile(exclude) if exclude else None
    return programme(bag, include=re.compile(include), exclude=leave_out, start_s=start_s)


def numbers(bag: Bag, played: Programme) -> list[int]:
    return [int.from_bytes(raw.data[4:], "little") for raw in played.messages(bag)]


# What is played, and in which order.


def test_every_message_is_played_in_order_of_log_time(tmp_path: Path) -> None:
    with open_bag(write(tmp_path / "bag", ("/a", 0.0), ("/b", 2.0), ("/a", 1.0), ("/b", 3.0))) as bag:
        assert numbers(bag, chosen(bag)) == [0, 2, 1, 3]


def test_topics_are_chosen_by_expressions_that_match_wholly(tmp_path: Path) -> None:
    with open_bag(write(tmp_path / "bag", ("/a", 0.0), ("/ab", 1.0), ("/abc", 2.0))) as bag:
        assert [row.name for row in chosen(bag, include="/ab?").topics] == ["/a", "/ab"]
        assert [row.name for row in chosen(bag, exclude="/ab").topics] == ["/a", "/abc"]
        assert numbers(bag, chosen(bag, include="/a.*", exclude="/a")) == [1, 2]


def test_a_late_start_leaves_out_what_was_before(tmp_path: Path) -> None:
    with open_bag(write(tmp_path / "bag", ("/a", 0.0), ("/a", 1.0), ("/a", 2.0))) as bag:
        assert numbers(bag, chosen(bag, start_s=1.0)) == [1, 2]
        assert numbers(bag, chosen(bag, start_s=1.5)) == [2]


def test_what_was_latched_before_the_start_comes_first_the_last_of_each(tmp_path: Path) -> None:
    spoken = (("/map", 0.0), ("/plan", 1.0), ("/odom", 2.0), ("/map", 3.0), ("/odom", 5.0), ("/plan", 6.0))
    offers = {"/map": LATCHED, "/plan": LATCHED}
    with open_bag(write(tmp_path / "bag", *spoken, offers=offers)) as bag:
        assert numbers(bag, chosen(bag, start_s=4.0)) == [1, 3, 4, 5]
        assert numbers(bag, chosen(bag, include="/plan|/odom", start_s=4.0)) == [1, 4, 5]
        assert numbers(bag, chosen(bag)) == [0, 1, 2, 3, 4, 5]


def test_as_many_latched_messages_come_first_as_a_late_listener_would_have_had(tmp_path: Path) -> None:
    spoken = [*(("/two", float(second)) for second in range(5)), ("/two", 9.0)]
    offers = {"/two": OfferedQos(durability="transient_local", depth=2)}
    with open_bag(write(tmp_path / "bag", *spoken, offers=offers)) as bag:
        assert numbers(bag, chosen(bag, start_s=8.0)) == [3, 4, 5]


def test_what_was_latched_long_before_the_start_is_found(tmp_path: Path) -> None:
    often = [("/often", 0.25 * number) for number in range(4000)]
    spoken = [("/once", 0.0), ("/twice", 3.0), *often, ("/twice", 500.0), ("/often", 1000.0)]
    two = OfferedQos(durability="transient_local", depth=2)
    offers = {"/once": LATCHED, "/twice": two, "/often": two}
    with open_bag(write(tmp_path / "bag", *spoken, offers=offers)) as bag:
        found = numbers(bag, chosen(bag, start_s=999.9))
    assert found == [0, 1, 2 + 4000, 2 + 3998, 2 + 3999, 2 + 4001]


def test_of_a_topic_with_two_types_the_one_with_more_messages_is_played(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag", manifest=Manifest(version="0", wall_start_ns=1)) as writer:
        for kind, count in (("std_msgs/msg/String", 1), ("std_msgs/msg/UInt64", 2)):
            channel = writer.add_topic("/a", message_definition(kind, PREFIXES))
            for number in range(count):
                data = b"\0\1\0\0" + number.to_bytes(8, "little")
                writer.write(channel, log_time_ns=BEGIN_NS, publish_time_ns=BEGIN_NS, data=data)
    with open_bag(tmp_path / "bag") as bag:
        played = chosen(bag)
        assert [row.type for row in played.topics] == ["std_msgs/msg/UInt64"]
        ((topic, sentence),) = played.left_out
        assert {raw.type for raw in played.messages(bag)} == {"std_msgs/msg/UInt64"}
    assert topic == "/a"
    assert "1 messages of type std_msgs/msg/String are left out" in sentence


def test_what_cannot_be_played_is_a_sentence(tmp_path: Path) -> None:
    write(tmp_path / "empty")
    with (
        open_bag(tmp_path / "empty") as bag,
        pytest.raises(BadFileError, match="empty holds no message, so there is nothing to play"),
    ):
        chosen(bag)
    with open_bag(write(tmp_path / "bag", ("/a", 0.0), ("/a", 2.5))) as bag:
        with pytest.raises(BadParameterError, match=r"'start_s' is 3.0, but .*bag is only 2.5 s long"):
            chosen(bag, start_s=3.0)
        with pytest.raises(BadParameterError, match="no topic of .* matches '/b'"):
            chosen(bag, include="/b")
        with pytest.raises(BadParameterError, match="matches '.*' and not '/.'"):
            chosen(bag, exclude="/.")


# When it is played.


@pytest.mark.parametrize("rate", [0.01, 1.0, 100.0])
def test_a_message_is_due_when_its_time_has_come_at_the_rate(rate: float) -> None:
    playback = playing(0.0, 1.0, 2.0, rate=rate)
    assert due(playback, 50.0) == [0.0]
    assert due(playback, 50.0 + 0.999 / rate) == []
    assert due(playback, 50.0 + 1.001 / rate) == [1.0]
    assert due(playback, 50.0 + 2.001 / rate) == [2.0]
    assert playback.ended


@given(
    gaps=st.lists(st.floats(0.0, 5.0), min_size=1, max_size=30),
    looks=st.lists(st.floats(0.001, 3.0), min_size=1, max_size=30),
    rate=st.floats(0.01, 100.0),
)
def test_nothing_comes_early_and_everything_comes_in_order(
    gaps: list[float], looks: list[float], rate: float
) -> None:
    times = [round(second, 6) for second in itertools.accumulate(gaps)]
    playback = playing(*times, rate=rate)
    heard = due(playback, 7.0)
    for now_s in itertools.accumulate(looks, initial=7.0):
        heard += due(playback, now_s)
        passed_s = (now_s - 7.0) * rate
        assert heard == [second for second in times if second <= heard[-1]] if heard else True
        assert not heard or heard[-1] <= passed_s + 1e-6
        assert all(second > passed_s - 1e-6 for second in times[len(heard) :])


def test_time_begins_with_the_first_message_that_is_read_not_before() -> None:
    source = Listed([message(0.0), message(1.0)], unread=0)
    playback = Playback(source, start_ns=BEGIN_NS, rate=1.0)
    assert due(playback, 10.0) == []
    source.unread = None
    assert due(playback, 60.0) == [0.0]
    assert due(playback, 60.9) == []
    assert due(playback, 61.0) == [1.0]


def test_how_late_a_message_is_counts_in_wall_time() -> None:
    playback = playing(0.0, 1.0, rate=2.0)
    due(playback, 0.0)
    found = playback.due(0.75)
    assert found is not None
    assert playback.late_s(found, 0.75) == pytest.approx(0.25)


def test_what_was_latched_is_due_at_once_even_while_paused_and_is_never_late() -> None:
    playback = playing(0.0, 3.0, 4.0, 5.0, start_s=4.0, paused=True)
    latched = playback.due(100.0)
    assert latched is not None
    assert (seconds(latched), playback.late_s(latched, 100.0)) == (0.0, 0.0)
    assert due(playback, 100.0) == [3.0]
    playback.go_on(200.0)
    assert due(playback, 200.0) == [4.0]
    assert due(playback, 201.0) == [5.0]


def test_a_pause_takes_no_time_of_the_bag() -> None:
    playback = playing(0.0, 1.0, 2.0)
    assert due(playback, 0.0) == [0.0]
    playback.pause(0.5)
    assert due(playback, 100.0) == []
    assert time_s(playback, 100.0) == 0.5
    playback.go_on(100.0)
    assert due(playback, 100.0) == []
    assert due(playback, 100.5) == [1.0]
    assert due(playback, 101.4) == []
    assert due(playback, 101.5) == [2.0]


def test_a_step_gives_the_next_message_and_time_goes_on_from_there() -> None:
    playback = playing(0.0, 1.0, 5.0, 6.0, paused=True)
    assert [seconds(playback.step()) for _ in range(3)] == [0.0, 1.0, 5.0]
    assert time_s(playback, 10.0) == 5.0
    playback.go_on(10.0)
    assert due(playback, 10.0) == []
    assert due(playback, 11.0) == [6.0]
    assert playback.step() is None


def test_another_rate_counts_from_where_the_bag_stands() -> None:
    playback = playing(0.0, 1.0, 11.0)
    due(playback, 0.0)
    assert due(playback, 1.0) == [1.0]
    playback.set_rate(10.0, 2.0)
    assert due(playback, 2.85) == []
    assert due(playback, 2.95) == [11.0]


def test_bag_time_never_overtakes_a_message_that_is_still_to_come() -> None:
    source = Listed([message(0.0), message(1.0), message(2.0)], unread=2)
    playback = Playback(source, start_ns=BEGIN_NS, rate=1.0)
    assert time_s(playback, 50.0) == 0.0
    assert due(playback, 50.0) == [0.0]
    assert time_s(playback, 50.4) == pytest.approx(0.4)
    assert time_s(playback, 57.0) == 1.0
    assert due(playback, 57.0) == [1.0]
    assert time_s(playback, 58.0) == 1.0  # the disk is behind: who knows what comes
    source.unread = None
    assert due(playback, 58.0) == [2.0]
    assert time_s(playback, 99.0) == 2.0


def test_a_bag_that_cannot_be_read_further_is_said_after_what_was_read() -> None:
    playback = Playback(
        Listed([message(0.0)], failure=BadFileError("damaged inside")), start_ns=BEGIN_NS, rate=1.0
    )
    assert seconds(playback.due(0.0)) == 0.0
    with pytest.raises(BadFileError, match="damaged inside"):
        playback.due(0.0)
    with pytest.raises(BadFileError, match="damaged inside"):
        playback.step()
    assert time_s(playback, 5.0) == 0.0


# For whom it waits.


def test_an_audience_is_there_when_nobody_new_comes() -> None:
    audience = Audience(wait_s=5.0, settle_s=0.3)
    looks = [(0, 10.0), (1, 11.0), (1, 11.2), (2, 11.25), (2, 11.5), (2, 11.6)]
    assert [audience.is_there(listeners, now_s) for listeners, now_s in looks] == [False] * 5 + [True]


def test_an_audience_that_does_not_come_is_not_waited_for_longer() -> None:
    audience = Audience(wait_s=1.0, settle_s=0.3)
    assert [audience.is_there(0, now_s) for now_s in (10.0, 10.9, 11.0)] == [False, False, True]
    assert Audience(wait_s=0.0, settle_s=0.3).is_there(0, 10.0)
