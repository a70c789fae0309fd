"""Stamps and headers: nanoseconds of ROS time <-> builtin_interfaces/Time, std_msgs/Header."""

from typing import Any

from robustnav_msgs_py.message_types import Clock, Header, Time

NANOSECONDS = 1_000_000_000


def stamp_to_message(stamp_ns: int) -> Time:
    """Nanoseconds since the epoch (or the start of simulated time) as a Time."""
    seconds, nanoseconds = divmod(int(stamp_ns), NANOSECONDS)
    return Time(sec=seconds, nanosec=nanoseconds)


def stamp_from_message(message: Any) -> int:
    """Nanoseconds of a Time."""
    return int(message.sec) * NANOSECONDS + int(message.nanosec)


def header(stamp_ns: int, frame_id: str) -> Header:
    """A header with stamp and frame."""
    return Header(stamp=stamp_to_message(stamp_ns), frame_id=frame_id)


def clock_to_message(stamp_ns: int) -> Clock:
    """Simulated time as a /clock message."""
    return Clock(clock=stamp_to_message(stamp_ns))


def clock_from_message(message: Any) -> int:
    """Simulated time, nanoseconds."""
    return stamp_from_message(message.clock)
