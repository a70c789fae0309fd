"""Turn recorded bytes into messages by the definitions that stand in the bag; needs no ROS on the machine."""

from functools import cache
from typing import Any

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, TypesysError, get_types_from_idl, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from robustnav_msgs_py.errors import BadFileError


class MessageDecoder:
    """Decodes the messages of one bag; a type without a definition there is taken from ROS 2 Jazzy's."""

    def __init__(self) -> None:
        self._types = get_typestore(Stores.EMPTY)

    def add(self, message_type: str, definition: str, encoding: str) -> None:
        """Learn a type from its text (`encoding`: ros2msg or ros2idl; anything else teaches nothing).

        Raises BadFileError where the text is not what it should be, or contradicts another one.
        """
        if encoding not in ("ros2msg", "ros2idl") or message_type in self._types.fielddefs:
            return
        try:
            is_msg = encoding == "ros2msg"
            types = get_types_from_msg(definition, message_type) if is_msg else get_types_from_idl(definition)
            self._types.register(types)
        except (TypesysError, ValueError, KeyError) as error:
            raise BadFileError(
                f"the bag's definition of {message_type} cannot be used: {' '.join(str(error).split())}"
            ) from error

    def decode(self, message_type: str, data: bytes) -> Any:
        """The message that `data` (CDR) holds, its arrays as numpy arrays; raises BadFileError."""
        types = self._types if message_type in self._types.fielddefs else _jazzy_types()
        if message_type not in types.fielddefs:
            raise BadFileError(f"nothing defines {message_type!r}, so its messages cannot be decoded")
        try:
            return types.deserialize_cdr(data, message_type)
        except KeyError as error:  # the definition names another type that nothing defines
            raise BadFileError(
                f"nothing defines {error.args[0]!r}, which {message_type!r} holds, so it cannot be decoded"
            ) from error
        except (SerdeError, IndexError, MemoryError) as error:
            raise BadFileError(f"{len(data)} bytes are no message of type {message_type}: {error}") from error

    def encode(self, message_type: str, message: Any) -> bytes:
        """Inverse of `decode`: the message as CDR."""
        types = self._types if message_type in self._types.fielddefs else _jazzy_types()
        return bytes(types.serialize_cdr(message, message_type))


@cache
def _jazzy_types() -> Typestore:
    return get_typestore(Stores.ROS2_JAZZY)
