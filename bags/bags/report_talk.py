"""What was said during a search: by the person, by the robot, and by nodes that were not well."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from bags.episodes import EpisodeSpan
from bags.reader import Bag
from bags.recorded_values import RecordedValue
from robustnav_msgs_py import conversions
from robustnav_msgs_py.errors import BadMessageError
from robustnav_msgs_py.values import ERROR, OK, STALE, WARN

Clock = Callable[[int], float]

CHAT = ("chat/from_user", "chat/to_user")
DIAGNOSTICS, LOG = "/diagnostics", "/rosout"
DIAGNOSTICS_TYPE, LOG_TYPE = "diagnostic_msgs/msg/DiagnosticArray", "rcl_interfaces/msg/Log"
LOG_WARN, LOG_ERROR = 30, 40
LEVELS = {OK: "ok", WARN: "warning", ERROR: "error", STALE: "stale"}
MOST_COMPLAINTS = 500


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One line of the conversation; `who` is "person" or "robot"."""

    t_s: float
    who: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Complaint:
    """A node was not well from `t_s` on, or is well again (level "ok")."""

    t_s: float
    node: str
    level: str
    text: str


def conversation(said: Iterable[RecordedValue], clock: Clock) -> tuple[Line, ...]:
    """The lines of both, in order."""
    lines = sorted(said, key=lambda value: value.log_time_ns)
    return tuple(
        Line(
            t_s=clock(value.log_time_ns),
            who="person" if value.topic == CHAT[0] else "robot",
            text=value.value,
        )
        for value in lines
    )


def complaints(bag: Bag, span: EpisodeSpan | None, clock: Clock) -> tuple[Complaint, ...]:
    """What diagnostics and the nodes' logs warn of; a state that lasts is told once, with its end.

    Only what was told during the search `span`, everything where that is None.
    """
    found: list[Complaint] = []
    states: dict[str, tuple[int, str]] = {}
    for recorded in bag.messages([DIAGNOSTICS, LOG]):
        elsewhere = span is not None and not span.holds(recorded.log_time_ns)
        if elsewhere or len(found) >= MOST_COMPLAINTS:
            continue
        t_s = clock(recorded.log_time_ns)
        if recorded.type == LOG_TYPE and recorded.message.level >= LOG_WARN:
            level = "error" if recorded.message.level >= LOG_ERROR else "warning"
            text = f"{recorded.message.msg} (log)"
            found.append(Complaint(t_s=t_s, node=str(recorded.message.name), level=level, text=text))
        elif recorded.type == DIAGNOSTICS_TYPE:
            for message in recorded.message.status:
                try:
                    status = conversions.status_from_message(message)
                except BadMessageError:  # a level that does not exist, of somebody else's node
                    continue
                before = states.get(status.name, (OK, ""))
                now = (status.level, status.message if status.level else "")
                states[status.name] = now
                if now != before:
                    text = status.message if status.level else "well again"
                    found.append(Complaint(t_s=t_s, node=status.name, level=LEVELS[status.level], text=text))
    return tuple(found)
