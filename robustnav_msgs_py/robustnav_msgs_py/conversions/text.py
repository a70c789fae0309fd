"""Lines of text: std_msgs/String, as a person could type them."""

from collections.abc import Sequence
from typing import Any

from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.message_types import String

LABEL_SEPARATOR = ", "


def text_to_message(text: str) -> String:
    """A String."""
    return String(data=text)


def text_from_message(message: Any) -> str:
    """The text of a String."""
    return str(message.data)


def labels_to_message(labels: Sequence[str]) -> String:
    """Class names in the order of their label numbers, comma-separated."""
    for label in labels:
        if not label.strip() or "," in label:
            raise BadMessageError(f"a class name must not be empty or hold a comma: {label!r}")
    return String(data=LABEL_SEPARATOR.join(labels))


def labels_from_message(message: Any) -> tuple[str, ...]:
    """Class names; an empty line gives none."""
    names = tuple(name.strip() for name in str(message.data).split(","))
    return () if names == ("",) else names
