"""Faults are understood as people type them, and end when they should."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robustnav_msgs_py.errors import BadMessageError
from sim_bridge.faults import (
    MOST_CHARACTERS,
    Blocked,
    Clear,
    Fault,
    Faults,
    Frozen,
    HomeNames,
    Move,
    Sensor,
    Silent,
    Slip,
    parse_fault,
)

NAMES = HomeNames(
    doors=(
        ("kitchen", "hallway"),
        ("living room", "hallway"),
        ("hallway", "bedroom"),
        ("hallway", "bedroom 2"),
        ("living room", "kitchen"),
    ),
    objects=(0, 3, 12),
    furniture=("desk 1", "Coffee Table 2"),
)
S = 1_000_000_000


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("silent camera", Silent(sensor=Sensor.CAMERA)),
        ("silent depth 2.5", Silent(sensor=Sensor.DEPTH, seconds=2.5)),
        ("  Silent   SCAN  3600 ", Silent(sensor=Sensor.SCAN, seconds=3600.0)),
        ("silent odom 0.001", Silent(sensor=Sensor.ODOM, seconds=0.001)),
        ("frozen camera 10", Frozen(sensor=Sensor.CAMERA, seconds=10.0)),
        ("slip 0.3", Slip(share=0.3)),
        ("slip 1 5", Slip(share=1.0, seconds=5.0)),
        ("block kitchen hallway", Blocked(rooms=("kitchen", "hallway"))),
        ("block hallway kitchen 7", Blocked(rooms=("kitchen", "hallway"), seconds=7.0)),
        ("block living room / hallway", Blocked(rooms=("living room", "hallway"))),
        ("block hallway/living room 4", Blocked(rooms=("living room", "hallway"), seconds=4.0)),
        ("block living room kitchen 30", Blocked(rooms=("living room", "kitchen"), seconds=30.0)),
        # A room's number is no time.
        ("block hallway bedroom 2", Blocked(rooms=("hallway", "bedroom 2"))),
        ("block hallway bedroom 3", Blocked(rooms=("hallway", "bedroom"), seconds=3.0)),
        ("block hallway bedroom 2 3", Blocked(rooms=("hallway", "bedroom 2"), seconds=3.0)),
        ("move object 3 to desk 1", Move(instance=3, furniture="desk 1")),
        ("Move Object 12 to coffee table 2", Move(instance=12, furniture="Coffee Table 2")),
        ("clear", Clear()),
    ],
)
def test_what_a_person_types_is_understood(line: str, fault: Fault) -> None:
    assert parse_fault(line, NAMES) == fault


@pytest.mark.parametrize(
    ("line", "why"),
    [
        ("", "there is no such fault"),
        ("break camera", "there is no such fault"),
        ("silent", "only camera, depth, scan, odom can be silent"),
        ("silent truth", "only camera, depth, scan, odom can be silent"),
        ("frozen scan", "only the camera can be frozen"),
        ("slip", "a share is more than 0 and at most 1"),
        ("slip 0", "a share is more than 0 and at most 1"),
        ("slip 1.01", "a share is more than 0 and at most 1"),
        ("slip nan", "a share is more than 0 and at most 1"),
        ("block", "no door joins two rooms so named"),
        ("block kitchen bedroom", r"no door joins two rooms so named \(there are: kitchen / hallway, living"),
        ("move object 4 to desk 1", "there is no object '4'"),
        ("move object 03 to desk 1", "there is no object '03'"),
        ("move object 3 to desk", "there is no furniture 'desk' that carries objects"),
        ("move object 3 to", "it takes the object's number and the furniture"),
        ("move 3 desk 1", "it takes the object's number and the furniture"),
        ("clear all", "'clear' stands alone"),
    ],
)
def test_what_is_no_fault_is_refused_with_the_reason_and_the_forms(line: str, why: str) -> None:
    with pytest.raises(BadMessageError, match=why) as caught:
        parse_fault(line, NAMES)
    assert "type 'silent camera|depth|scan|odom [SECONDS]', 'frozen camera" in str(caught.value)


@pytest.mark.parametrize(
    "seconds", ["0", "0.0", "-1", "3600.1", "nan", "inf", "1e2", "1_0", "٣", "soon", "1 2", "9" * 40]
)
def test_times_that_cannot_be_are_refused(seconds: str) -> None:
    for fault in ("silent camera", "frozen camera", "slip 0.5", "block kitchen hallway"):
        with pytest.raises(BadMessageError, match="is not a time of more than 0 and at most 3600 seconds"):
            parse_fault(f"{fault} {seconds}", NAMES)


def test_a_line_that_is_too_long_is_refused_without_repeating_it() -> None:
    with pytest.raises(BadMessageError, match="a line of at most 200 characters, not 201") as caught:
        parse_fault("clear" + " " * (MOST_CHARACTERS - 4), NAMES)
    assert parse_fault("clear" + " " * (MOST_CHARACTERS - 5), NAMES) == Clear()
    with pytest.raises(BadMessageError):
        parse_fault("x" * 100_000, NAMES)
    assert len(str(caught.value)) < 500


@given(
    st.one_of(
        st.text(max_size=220),
        st.lists(
            st.sampled_from(
                [
                    "silent",
                    "camera",
                    "slip",
                    "0.5",
                    "block",
                    "kitchen",
                    "hallway",
                    "/",
                    "move",
                    "object",
                    "3",
                    "to",
                    "desk",
                    "1",
                ]
            ),
            max_size=7,
        ).map(" ".join),
    )
)
def test_any_line_is_a_fault_or_refused(line: str) -> None:
    with contextlib.suppress(BadMessageError):
        assert isinstance(parse_fault(line, NAMES), Fault)


def test_a_fault_lasts_from_its_beginning_to_its_end() -> None:
    faults = Faults()
    faults.start(Silent(sensor=Sensor.CAMERA, seconds=2.0), 5 * S)
    assert [faults.is_silent("camera", now) for now in (5 * S, 7 * S - 1, 7 * S, 9 * S)] == [
        True,
        True,
        False,
        False,
    ]
    assert not faults.is_silent("depth", 5 * S)
    assert not faults.is_frozen("camera", 5 * S)
    faults.start(Frozen(sensor=Sensor.CAMERA), 8 * S)
    assert faults.is_frozen("camera", 10**6 * S)
    assert faults.active(8 * S) == (Frozen(sensor=Sensor.CAMERA),)
    faults.clear()
    assert faults.active(8 * S) == ()


def test_a_fault_takes_the_place_of_one_that_concerns_the_same_thing() -> None:
    faults = Faults()
    for fault in (
        Slip(share=0.2),
        Silent(sensor=Sensor.SCAN),
        Silent(sensor=Sensor.ODOM),
        Blocked(rooms=("kitchen", "hallway")),
        Blocked(rooms=("living room", "hallway"), seconds=1.0),
        Slip(share=0.7, seconds=3.0),
        Silent(sensor=Sensor.SCAN, seconds=1.0),
        Blocked(rooms=("hallway", "kitchen"), seconds=2.0),
    ):
        faults.start(fault, S)
    assert len(faults.active(S)) == 5
    assert faults.slip(S) == 0.7
    assert faults.slip(4 * S) == 0.0
    assert faults.blocked_doors(S) == (("living room", "hallway"), ("hallway", "kitchen"))
    assert faults.blocked_doors(2 * S) == (("hallway", "kitchen"),)
    assert not faults.is_silent("scan", 2 * S)
    assert faults.active(10 * S) == (Silent(sensor=Sensor.ODOM),)


def test_the_same_fault_again_lasts_from_then_on() -> None:
    faults = Faults()
    faults.start(Slip(share=0.5, seconds=2.0), S)
    faults.start(Slip(share=0.5, seconds=2.0), 2 * S)
    assert faults.slip(3 * S) == 0.5
    assert faults.slip(4 * S) == 0.0


def test_faults_that_ended_are_forgotten() -> None:
    faults = Faults()
    for number in range(1000):
        faults.start(Blocked(rooms=(f"room {number}", "hallway"), seconds=1.0), number * S)
    assert len(faults._ends) <= 2
