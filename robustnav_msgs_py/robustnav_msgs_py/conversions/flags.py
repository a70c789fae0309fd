"""Yes and no: std_msgs/Bool."""

from typing import Any

from robustnav_msgs_py.message_types import Bool


def flag_to_message(flag: bool) -> Bool:
    """A Bool; anything but Python's own bool would arrive as False."""
    return Bool(data=bool(flag))


def flag_from_message(message: Any) -> bool:
    """What a Bool says."""
    return bool(message.data)
