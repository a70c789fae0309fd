"""Parameters of the recorder and of the player."""

import re
from dataclasses import dataclass

from robustnav_msgs_py.errors import BadParameterError
from robustnav_msgs_py.parameters import parameter


@dataclass(frozen=True, slots=True, kw_only=True)
class RecorderParameters:
    """Where the recorder writes, what, and how much may wait to be written."""

    folder: str = parameter("runs", "folder that bags are written to")
    name: str = parameter("", "name of the bag; empty: run_ and the date and time at which it begins")
    resume: bool = parameter(
        False, "go on in the bag of this name that a killed recorder left; it is refused otherwise"
    )
    include: str = parameter(".*", "regular expression; topics that match it wholly are recorded")
    exclude: str = parameter(
        ".*/detections/boxes",
        "regular expression; topics that match it wholly are left out; boxes are drawn only while heard",
    )
    patient: str = parameter(
        ".*/chat/from_user",
        "regular expression; topics on which people say one thing and leave: heard a little later",
    )
    patience_s: float = parameter(1.0, "how much later", unit="s", low=0.0, high=60.0)
    chunk_size_bytes: int = parameter(
        1_048_576, "size at which a chunk is compressed and written", unit="B", low=1024, high=268_435_456
    )
    split_size_bytes: int = parameter(
        0,
        "the bag goes on in a next file when one is this large, to within a chunk; 0: never",
        unit="B",
        low=0,
        high=1_000_000_000_000,
    )
    split_duration_s: float = parameter(
        0.0, "the bag goes on in a next file when one is this long; 0: never", unit="s", low=0.0, high=86400.0
    )
    repeat_latched: bool = parameter(
        False,
        "begin each further file with what latched topics said last; played as one bag, it is said twice",
    )
    flush_period_s: float = parameter(
        0.5, "a run that is killed loses at most this much", unit="s", low=0.1, high=60.0
    )
    queue_size_bytes: int = parameter(
        134_217_728,
        "messages that wait to be written; more are dropped and counted",
        unit="B",
        low=1_048_576,
        high=17_179_869_184,
    )
    depth: int = parameter(1000, "messages of a topic that may wait in the middleware", low=100, high=100_000)
    discovery_period_s: float = parameter(
        0.2, "how often the graph is searched for new topics", unit="s", low=0.02, high=10.0
    )
    closing_limit_s: float = parameter(
        30.0, "how long the end of the process waits for the bag to be closed", unit="s", low=1.0, high=600.0
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PlayerParameters:
    """What the player plays, how fast, and how it begins and ends."""

    bag: str = parameter("", "folder of the bag, or an .mcap file; also the first argument of the command")
    rate: float = parameter(1.0, "seconds of the bag in one second", low=0.01, high=100.0)
    start_s: float = parameter(
        0.0, "where to begin, counted from the begin of the bag", unit="s", low=0.0, high=1e7
    )
    loop: bool = parameter(False, "begin again at the end")
    start_paused: bool = parameter(False, "begin with time standing; ~/pause and ~/step go on")
    include: str = parameter(".*", "regular expression; recorded topics that match it wholly are played")
    exclude: str = parameter("", "regular expression; topics that match it wholly are left out")
    clock_hz: float = parameter(
        0.0,
        "how often the bag's time is said on /clock; 0: not at all; a /clock that is played comes first",
        unit="Hz",
        low=0.0,
        high=1000.0,
    )
    wait_for_s: float = parameter(
        1.0, "how long to wait for listeners before the first message", unit="s", low=0.0, high=600.0
    )
    depth: int = parameter(
        1000, "messages of a volatile topic that are kept for slow listeners", low=1, high=100_000
    )


def pattern(name: str, expression: str) -> re.Pattern[str]:
    """The regular expression that the parameter `name` holds; raises BadParameterError."""
    try:
        return re.compile(expression)
    except re.error as error:
        raise BadParameterError(
            f"parameter {name!r} is {expression!r}; it is no regular expression: {error}"
        ) from error
