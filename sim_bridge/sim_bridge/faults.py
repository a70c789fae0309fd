"""What goes wrong on request: sensors that fall silent or freeze, wheels that slip, doors that are blocked.

One plain line each, as a person types it; the seconds are of simulated time, and without them a fault lasts
until 'clear':

    silent camera|depth|scan|odom [SECONDS]
    frozen camera [SECONDS]
    slip SHARE [SECONDS]                        0 < SHARE <= 1 of the motion is lost while the wheels claim it
    block ROOM / ROOM [SECONDS]                 the doors between the two rooms; the slash may be left out
    move object NUMBER to FURNITURE
    clear
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import StrEnum

from robustnav_msgs_py.errors import BadMessageError

MOST_CHARACTERS = 200
SHOWN_CHARACTERS = 80
MOST_SECONDS = 3600.0
NS_PER_S = 1_000_000_000
NUMBER = re.compile(r"\d{1,9}(\.\d{1,9})?", re.ASCII)
FORMS = (
    "'silent camera|depth|scan|odom [SECONDS]', 'frozen camera [SECONDS]', 'slip SHARE [SECONDS]', "
    "'block ROOM / ROOM [SECONDS]', 'move object NUMBER to FURNITURE' or 'clear'"
)


class Sensor(StrEnum):
    """What can fall silent."""

    CAMERA = "camera"
    DEPTH = "depth"
    SCAN = "scan"
    ODOM = "odom"


@dataclass(frozen=True, slots=True, kw_only=True)
class HomeNames:
    """What the lines may name: rooms that a door joins, objects by number, furniture that carries things."""

    doors: tuple[tuple[str, str], ...]
    objects: tuple[int, ...]
    furniture: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Silent:
    """The sensor says nothing; `seconds` None: until it is cleared."""

    sensor: Sensor
    seconds: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Frozen:
    """The sensor repeats its last picture; `seconds` None: until it is cleared."""

    sensor: Sensor
    seconds: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Slip:
    """This share (0..1) of the wheels' motion is lost; `seconds` None: until it is cleared."""

    share: float
    seconds: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Blocked:
    """The doors between two rooms are closed; `rooms` as the home lists them."""

    rooms: tuple[str, str]
    seconds: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Move:
    """An object is put elsewhere, at once."""

    instance: int
    furniture: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Clear:
    """Everything that lasts ends, at once."""


Lasting = Silent | Frozen | Slip | Blocked
Fault = Lasting | Move | Clear


def parse_fault(line: str, names: HomeNames) -> Fault:
    """The fault that a line asks for, in a home with these names.

    Raises BadMessageError, with the forms that are understood, where the line is none of them or names what
    is not there.
    """
    if len(line) > MOST_CHARACTERS:
        raise BadMessageError(
            f"a fault is a line of at most {MOST_CHARACTERS} characters, not {len(line)}; type {FORMS}"
        )
    verb, *rest = line.casefold().split() or [""]
    parser = _PARSERS.get(verb)
    if parser is None:
        raise _refused(line, "there is no such fault")
    try:
        return parser(rest, names)
    except BadMessageError as problem:
        raise _refused(line, str(problem)) from problem


class Faults:
    """The faults that last, each until its end. Owned by the simulation, asked from its thread."""

    def __init__(self) -> None:
        self._ends: dict[Lasting, int | None] = {}

    def start(self, fault: Lasting, now_ns: int) -> None:
        """Let the fault begin at `now_ns`; it takes the place of one that concerns the same thing."""
        end_ns = None if fault.seconds is None else now_ns + round(fault.seconds * NS_PER_S)
        kept = {
            other: end
            for other, end in self._ends.items()
            if _concern(other) != _concern(fault) and _lasts(end, now_ns)
        }
        self._ends = {**kept, fault: end_ns}

    def clear(self) -> None:
        """End them all."""
        self._ends = {}

    def active(self, now_ns: int) -> tuple[Lasting, ...]:
        """Those that last at `now_ns`, in the order in which they began."""
        return tuple(fault for fault, end_ns in self._ends.items() if _lasts(end_ns, now_ns))

    def is_silent(self, sensor: str, now_ns: int) -> bool:
        """Whether the sensor says nothing."""
        return any(isinstance(fault, Silent) and fault.sensor == sensor for fault in self.active(now_ns))

    def is_frozen(self, sensor: str, now_ns: int) -> bool:
        """Whether the sensor repeats its last picture."""
        return any(isinstance(fault, Frozen) and fault.sensor == sensor for fault in self.active(now_ns))

    def slip(self, now_ns: int) -> float:
        """The share (0..1) of the wheels' motion that is lost."""
        return next((fault.share for fault in self.active(now_ns) if isinstance(fault, Slip)), 0.0)

    def blocked_doors(self, now_ns: int) -> tuple[tuple[str, str], ...]:
        """The pairs of rooms between which all doors are closed, in the order in which they were."""
        return tuple(fault.rooms for fault in self.active(now_ns) if isinstance(fault, Blocked))


def _lasts(end_ns: int | None, now_ns: int) -> bool:
    return end_ns is None or now_ns < end_ns


def _concern(fault: Lasting) -> tuple[object, ...]:
    """What only one fault at a time can concern."""
    match fault:
        case Silent() | Frozen():
            return type(fault), fault.sensor
        case Slip():
            return (Slip,)
        case Blocked():
            return (Blocked, *sorted(fault.rooms))


def _refused(line: str, why: str) -> BadMessageError:
    return BadMessageError(f"the fault {line[:SHOWN_CHARACTERS]!r} cannot be: {why}; type {FORMS}")


def _silent(words: list[str], _names: HomeNames) -> Silent:
    sensors = [str(sensor) for sensor in Sensor]
    if not words or words[0] not in sensors:
        raise BadMessageError(f"only {', '.join(sensors)} can be silent")
    return Silent(sensor=Sensor(words[0]), seconds=_seconds(words[1:]))


def _frozen(words: list[str], _names: HomeNames) -> Frozen:
    if not words or words[0] != Sensor.CAMERA:
        raise BadMessageError("only the camera can be frozen")
    return Frozen(sensor=Sensor.CAMERA, seconds=_seconds(words[1:]))


def _slip(words: list[str], _names: HomeNames) -> Slip:
    share = _number(words[0]) if words else None
    if share is None or not 0.0 < share <= 1.0:
        raise BadMessageError("a share is more than 0 and at most 1")
    return Slip(share=share, seconds=_seconds(words[1:]))


def _block(words: list[str], names: HomeNames) -> Blocked:
    said = [word for word in " ".join(words).replace("/", " ").split() if word]
    found = [
        (len(named), rooms, said[len(named) :])
        for rooms in names.doors
        for named in _ways_to_say(rooms)
        if said[: len(named)] == named
    ]
    if not found:
        doors = ", ".join(f"{one} / {other}" for one, other in names.doors) or "none"
        raise BadMessageError(f"no door joins two rooms so named (there are: {doors})")
    # The longest name wins: 'bedroom 2' is a room rather than the bedroom for 2 seconds.
    _, rooms, rest = max(found, key=lambda match: match[0])
    return Blocked(rooms=rooms, seconds=_seconds(rest))


def _ways_to_say(rooms: tuple[str, str]) -> Iterator[list[str]]:
    one, other = (room.casefold().split() for room in rooms)
    yield one + other
    yield other + one


def _move(words: list[str], names: HomeNames) -> Move:
    if len(words) < 4 or words[0] != "object" or words[2] != "to":
        raise BadMessageError("it takes the object's number and the furniture to put it on")
    instance = next((number for number in names.objects if str(number) == words[1]), None)
    if instance is None:
        raise BadMessageError(f"there is no object {words[1]!r}")
    place = words[3:]
    furniture = next((name for name in names.furniture if name.casefold().split() == place), None)
    if furniture is None:
        raise BadMessageError(f"there is no furniture {' '.join(place)!r} that carries objects")
    return Move(instance=instance, furniture=furniture)


def _clear(words: list[str], _names: HomeNames) -> Clear:
    if words:
        raise BadMessageError("'clear' stands alone")
    return Clear()


def _seconds(words: list[str]) -> float | None:
    """The seconds that end a line; None where it ends before."""
    if not words:
        return None
    seconds = _number(words[0])
    if len(words) > 1 or seconds is None or not 0.0 < seconds <= MOST_SECONDS:
        raise BadMessageError(
            f"{' '.join(words)!r} is not a time of more than 0 and at most {MOST_SECONDS:g} seconds"
        )
    return seconds


def _number(word: str) -> float | None:
    return float(word) if NUMBER.fullmatch(word) else None


_PARSERS: dict[str, Callable[[list[str], HomeNames], Fault]] = {
    "silent": _silent,
    "frozen": _frozen,
    "slip": _slip,
    "block": _block,
    "move": _move,
    "clear": _clear,
}
