"""Episodes of the benchmark of instruction errors: a walk, what was said, and which words are wrong."""

from dataclasses import dataclass

from robustnav_msgs_py.errors import BadParameterError
from robustnav_nodes.instruction.concepts import DIRECTION, OBJECT, ROOM
from robustnav_nodes.instruction.trajectory import Trajectory

# The kinds that are wrong in each type of error (thesis 4.1.2).
ERROR_TYPES: dict[str, tuple[str, ...]] = {
    "direction": (DIRECTION,),
    "room": (ROOM,),
    "object": (OBJECT,),
    "room_object": (ROOM, OBJECT),
    "all": (DIRECTION, ROOM, OBJECT),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Instruction:
    """What a person said about one walk, as tokens. `group` names the home: data is split by it."""

    key: str
    group: str
    tokens: tuple[str, ...]
    trajectory: Trajectory


@dataclass(frozen=True, slots=True, kw_only=True)
class WrongSpan:
    """Tokens that were put in instead of the right ones: where, of which kind, and both concepts."""

    start: int
    length: int
    kind: str
    right: str
    wrong: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorEpisode:
    """An instruction, clean or with errors put in; `error_type` names the benchmark split it is part of."""

    key: str
    group: str
    error_type: str
    tokens: tuple[str, ...]
    trajectory: Trajectory
    wrong: tuple[WrongSpan, ...] = ()

    def __post_init__(self) -> None:
        for span in self.wrong:
            if not 0 <= span.start < span.start + span.length <= len(self.tokens):
                raise BadParameterError(
                    f"the wrong span at token {span.start} of episode {self.key!r} lies outside its "
                    f"{len(self.tokens)} tokens"
                )

    @property
    def label(self) -> int:
        """1 where the instruction holds an error, else 0."""
        return int(bool(self.wrong))
