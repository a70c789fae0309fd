"""What was said last arrives before its speaker is gone.

A listener that learns that a publisher is gone drops what it has not received from it yet. So whoever leaves
waits until reliable listeners have acknowledged everything.
"""

import time
from collections.abc import Iterable

from rclpy.duration import Duration
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.publisher import Publisher

# A datagram that was lost is told of by the next heartbeat, which Fast DDS sends every 3 s.
RECEIVED_LIMIT_S = 4.0
# rclpy holds Python's lock while it waits; in between other threads have their turn.
SLICE_S = 0.05


def not_received(publishers: Iterable[Publisher], deadline_s: float) -> list[str]:
    """Wait until all that `publishers` said is received; the topics of which it is not by `deadline_s`.

    The deadline is on the clock of `time.monotonic`; when it is past, nothing is waited for.
    """
    return [publisher.topic for publisher in publishers if not _is_received(publisher, deadline_s)]


def _is_received(publisher: Publisher, deadline_s: float) -> bool:
    while True:
        left_s = max(0.0, deadline_s - time.monotonic())
        try:
            if publisher.wait_for_all_acked(Duration(seconds=min(left_s, SLICE_S))):
                return True
        except rclpy_implementation.RCLError:  # ROS was shut down before us: nobody can be asked
            return False
        if not left_s:
            return False
