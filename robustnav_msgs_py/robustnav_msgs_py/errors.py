"""Every error robustnav raises on purpose, under one root.

A message is a full sentence (or two): what was wrong, with the value, where, and what to do about it.
"""


class RobustnavError(Exception):
    """Root of all errors that robustnav raises on purpose."""


class BadMessageError(RobustnavError):
    """A message or value does not hold what its type promises (wrong size, encoding, NaN, ...)."""


class BadMapError(RobustnavError):
    """A map on which nothing can be searched (empty, too large, no free floor, no candidates)."""


class BadParameterError(RobustnavError):
    """A parameter is unknown, of the wrong type or out of its range."""


class BadFileError(RobustnavError):
    """A file or folder cannot be read or written, or does not hold what it should."""


class BadSceneError(RobustnavError):
    """A home cannot be generated or does not hold together."""


class ContractError(RobustnavError):
    """A node uses a topic or service in a way that `contract.py` does not list."""


class GraphError(RobustnavError):
    """The graph of nodes could not be started or did not answer in time."""
