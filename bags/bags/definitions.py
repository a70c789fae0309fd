"""The text that defines a message type; bags carry it, so that they can be read where the type is missing."""

import json
import os
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

SEPARATOR = "=" * 80
TYPE_NAME = re.compile(r"(?P<package>\w+)/msg/(?P<name>\w+)")
FIELD_TYPE = re.compile(r"^\s*(?:(?P<package>\w+)/(?:msg/)?)?(?P<name>[A-Za-z]\w*)")
PRIMITIVES = re.compile(r"bool|byte|char|float(32|64)|u?int(8|16|32|64)|w?string")


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageDefinition:
    """What a bag stores of a message type.

    `text` is the type's own definition followed by those of every type it uses (ros2msg), `type_hash` is
    the RIHS01 hash that publishers announce. Both are empty where the type is unknown: its messages can
    be recorded and played, but only who has the type can decode them.
    """

    type: str
    text: str
    type_hash: str


def ament_prefixes() -> tuple[Path, ...]:
    """Where ROS packages are installed: AMENT_PREFIX_PATH, or this Python's prefix where that is not set."""
    listed = os.environ.get("AMENT_PREFIX_PATH", sys.prefix)
    return tuple(Path(entry) for entry in listed.split(os.pathsep) if entry)


def message_definition(message_type: str, prefixes: Sequence[Path]) -> MessageDefinition:
    """Definition of `message_type` ("package/msg/Name") from the first of `prefixes` that has it.

    A type that is in none of them is taken from the standard types of ROS 2 Jazzy.
    """
    installed = _installed_text(message_type, prefixes)
    standard = _jazzy_types()
    if installed is not None:
        return MessageDefinition(
            type=message_type, text=installed, type_hash=_installed_hash(message_type, prefixes)
        )
    if message_type in standard.fielddefs:
        text, _ = standard.generate_msgdef(message_type, ros_version=2)
        return MessageDefinition(type=message_type, text=text, type_hash=standard.hash_rihs01(message_type))
    return MessageDefinition(type=message_type, text="", type_hash="")


def _installed_text(message_type: str, prefixes: Sequence[Path]) -> str | None:
    """Concatenated .msg texts, None where one of them is not installed."""
    pending, texts = [message_type], dict[str, str]()
    while pending:
        current = pending.pop(0)
        if current in texts:
            continue
        path = _find(current, ".msg", prefixes)
        if path is None:
            return None
        text = path.read_text(encoding="utf-8")
        texts[current] = text if text.endswith("\n") else text + "\n"
        pending.extend(_used_types(text, current.split("/")[0]))
    parts = [texts.pop(message_type)]
    for used, text in texts.items():
        parts.append(f"{SEPARATOR}\nMSG: {used.replace('/msg/', '/')}\n{text}")
    return "".join(parts)


def _used_types(text: str, package: str) -> list[str]:
    """Names of the message types that the fields of one .msg text have."""
    used = []
    for line in text.splitlines():
        field = FIELD_TYPE.match(line)
        if field and not PRIMITIVES.fullmatch(field["name"]):
            used.append(f"{field['package'] or package}/msg/{field['name']}")
    return used


def _installed_hash(message_type: str, prefixes: Sequence[Path]) -> str:
    path = _find(message_type, ".json", prefixes)
    if path is None:
        return ""
    for row in json.loads(path.read_text(encoding="utf-8"))["type_hashes"]:
        if row["type_name"] == message_type:
            return str(row["hash_string"])
    return ""


def _find(message_type: str, suffix: str, prefixes: Sequence[Path]) -> Path | None:
    name = TYPE_NAME.fullmatch(message_type)
    if name is None:
        return None
    for prefix in prefixes:
        path = prefix / "share" / name["package"] / "msg" / (name["name"] + suffix)
        if path.is_file():
            return path
    return None


@cache
def _jazzy_types() -> Typestore:
    return get_typestore(Stores.ROS2_JAZZY)
