"""Messages of every type of the contract, with something in every field."""

from typing import Any

import numpy as np
from rosidl_parser import definition as rosidl

from robustnav_msgs_py import contract
from robustnav_nodes.graph.message_class import message_class

TYPES = sorted(
    {row.type for row in contract.TOPICS if row.is_available}
    | {"rcl_interfaces/msg/Log", "std_msgs/msg/Empty"}
)


def filled(kind: Any, rng: np.random.Generator) -> Any:
    """A message of type `kind` with something different in every field."""
    message = kind()
    for name, slot in zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True):
        setattr(message, name, value_of(slot, rng))
    return message


def value_of(slot: Any, rng: np.random.Generator) -> Any:
    if isinstance(slot, rosidl.NamespacedType):
        return filled(message_class("/".join((*slot.namespaces, slot.name))), rng)
    if isinstance(slot, rosidl.AbstractString):
        return "".join(chr(code) for code in rng.integers(32, 0x2FF, rng.integers(0, 9)))
    if isinstance(slot, rosidl.Array):
        return [value_of(slot.value_type, rng) for _ in range(slot.size)]
    if isinstance(slot, rosidl.AbstractSequence):
        return [value_of(slot.value_type, rng) for _ in range(rng.integers(0, 4))]
    if slot.typename == "boolean":
        return bool(rng.integers(2))
    if slot.typename == "octet":
        return bytes([rng.integers(256)])
    if slot.typename in ("float", "double"):
        return float(np.float32(rng.normal()))
    bits, signed = int(slot.typename.strip("uint")), not slot.typename.startswith("u")
    low, high = (-(2 ** (bits - 1)), 2 ** (bits - 1)) if signed else (0, 2**bits)
    return int(rng.integers(low, high, dtype=np.uint64 if bits == 64 and not signed else np.int64))
