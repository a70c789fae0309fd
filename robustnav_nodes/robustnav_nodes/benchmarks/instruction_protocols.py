"""The protocols of instruction errors as choices on the command line."""

from enum import StrEnum


class OneProtocol(StrEnum):
    """How wrong words are drawn: any that common sense allows, or such as read as well as the right ones."""

    UNIFORM = "uniform"
    MATCHED = "matched"


class ProtocolChoice(StrEnum):
    """One of them, or both."""

    UNIFORM = "uniform"
    MATCHED = "matched"
    BOTH = "both"
