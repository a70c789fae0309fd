"""Replace what a person and the robot said to each other, wherever in a bag it stands."""

from collections.abc import Collection, Iterable
from dataclasses import fields, is_dataclass
from typing import Any

CHAT_FOLDERS = frozenset({"chat", "dialogue"})
# What every node says of itself, below its name: nobody's words.
OF_EVERY_NODE = frozenset({"lifecycle_msgs", "rcl_interfaces", "service_msgs"})
STATUS = "diagnostic_msgs/msg/DiagnosticStatus"
# Of the dialogue's state: what is no text of anybody. The target is a class name, or looked for elsewhere.
KEPT_VALUES = frozenset({"scenario", "target", "lines_heard"})
# Shorter texts ("yes", "stop") stand in many messages without having been said there.
SHORTEST_CHARS = 8
CUT = "…"  # ends a text that was shortened for display


def carries_chat(topic: str, message_type: str) -> bool:
    """Whether a topic, in whatever namespace, is one of the dialogue's: chat/..., dialogue/..."""
    is_of_ros = message_type.partition("/")[0] in OF_EVERY_NODE
    return bool(CHAT_FOLDERS & set(topic.split("/"))) and not is_of_ros


def replacement(text: str) -> str:
    """What stands in the place of `text`."""
    return f"[redacted {len(text)} characters]" if text else ""


class SpokenTexts:
    """What was said in a bag, to be found again in messages that are not the dialogue's."""

    def __init__(self, class_names: Collection[str]) -> None:
        self._known = frozenset(class_names)
        self._texts: dict[str, bytes] = {}

    def add(self, texts: Iterable[str]) -> None:
        """Remember what was said; class names and very short texts are not looked for."""
        for text in texts:
            told = text.strip().removesuffix(CUT).strip()
            if len(told) >= SHORTEST_CHARS and told not in self._known:
                self._texts[told] = told.encode()

    def add_target(self, target: str) -> None:
        """Remember what was searched for, where the detector has no class of that name: somebody typed it."""
        if target.strip() and target not in self._known:
            self._texts[target] = target.encode()

    def stand_in(self, data: bytes) -> bool:
        """Whether one of the texts stands in a message's bytes."""
        return any(text in data for text in self._texts.values())

    def replaced(self, text: str) -> str:
        """`text` with every one of the texts in it replaced, the longest first."""
        for spoken in sorted(self._texts, key=len, reverse=True):
            text = text.replace(spoken, replacement(spoken))
        return text


def chat_texts(message_type: str, message: Any) -> list[str]:
    """What was said in a message of the dialogue."""
    said: list[str] = []

    def note(text: str) -> str:
        said.append(text)
        return text

    _change_chat(message_type, message, note)
    return said


def redact_chat(message_type: str, message: Any) -> None:
    """Replace, in place, what was said in a message of the dialogue."""
    _change_chat(message_type, message, replacement)


def change_texts(message: Any, change: Any) -> None:
    """Put every text of a decoded message through `change`, in place; names of frames stay."""
    for item in fields(message):
        value = getattr(message, item.name)
        if isinstance(value, str) and item.name not in ("frame_id", "child_frame_id", "__msgtype__"):
            setattr(message, item.name, change(value))
        elif is_dataclass(value):
            change_texts(value, change)
        elif isinstance(value, list):
            for index, part in enumerate(value):
                if isinstance(part, str):
                    value[index] = change(part)
                elif is_dataclass(part):
                    change_texts(part, change)


def _change_chat(message_type: str, message: Any, change: Any) -> None:
    if message_type != STATUS:
        change_texts(message, change)
        return
    message.message = change(message.message)
    for pair in message.values:
        if pair.key not in KEPT_VALUES:
            pair.value = change(pair.value)
