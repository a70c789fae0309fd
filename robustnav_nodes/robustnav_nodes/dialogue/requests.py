"""What a line of the person asks for. What a person writes is data: it is matched, never evaluated."""

import re
import unicodedata
from dataclasses import dataclass
from enum import StrEnum

from robustnav_msgs_py.errors import RobustnavError


class RequestKind(StrEnum):
    """What the person wants."""

    FIND = "find"
    STOP = "stop"
    WHERE = "where"
    WHY = "why"
    THANKS = "thanks"
    RIGHT = "right"
    WRONG = "wrong"
    GREETING = "greeting"
    HELP = "help"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """One request; `thing` is what to find, as the person named it, "" for the other kinds."""

    kind: RequestKind
    thing: str = ""


class UnreadableLineError(RobustnavError):
    """A line that is empty, too long or not text; its message is what the robot answers."""


_FIND = re.compile(
    r"^(?:(?:please|hey|hi|hello|ok|no|robot|now|then)[\s,]+)*"
    r"(?:(?:can|could|would|will) you (?:please )?|i(?: a|')m looking for |i (?:want|need)(?: you to)? "
    r"|help me )?"
    r"(?:(?:find|search for|look for|locate|seek|fetch|get|bring|where(?: is|'s| are))(?: me)? )?"
    r"(?P<thing>.+)$"
)
_VERB = re.compile(
    r"\b(?:find|search for|look(?:ing)? for|locate|seek|fetch|get|bring|where(?: is|'s| are)|i need|i want)\b"
)
_ARTICLES = re.compile(r"^(?:(?:the|a|an|my|our|your|some|any|that|this|one of the)\s+)+")
_ENDINGS = re.compile(r"(?:[\s,]*(?:please|for me|now|again|thanks|thank you))*[\s.!?]*$")

_NOT_IT = (
    r"^(?:(?:no|nope|sorry)[\s,.!]+)*"
    r"(?:(?:that|this|it)(?:'s| is| was) (?:not|the wrong|wrong)|(?:that|this|it) (?:isn't|wasn't)"
    r"|not (?:it|that|this)|wrong (?:one|thing|object))\b"
)

_FIXED = (
    (RequestKind.WRONG, re.compile(_NOT_IT + r"|^(?:no|nope|wrong)[\s,.!]*$")),
    (
        RequestKind.STOP,
        re.compile(r"^(?:please[\s,]+)?(?:stop|halt|cancel|abort|never ?mind|forget (?:it|about it))\b"),
    ),
    (RequestKind.WHERE, re.compile(r"^(?:and )?where(?: are|'re) (?:you|we)\b")),
    (RequestKind.WHY, re.compile(r"^(?:but )?(?:why\b|what are you doing|how come)")),
    (RequestKind.THANKS, re.compile(r"^(?:thanks|thank you|thx|cheers|great|well done|perfect)\b")),
    (
        RequestKind.RIGHT,
        re.compile(
            r"^(?:(?:yes|yep|yeah)[\s,.!]*$|(?:(?:yes|yep|yeah)[\s,.!]+)?"
            r"(?:(?:that|this|it)(?:'s| is) (?:it|right|correct|the one|mine)|correct|exactly)\b)"
        ),
    ),
    (RequestKind.HELP, re.compile(r"^(?:help|what can you (?:do|find)|what do you know)[\s?!.]*$")),
    (
        RequestKind.GREETING,
        re.compile(r"^(?:hi|hello|hey|good (?:morning|afternoon|evening))[\s,!.]*(?:robot)?[\s!.]*$"),
    ),
)


def read_line(line: str, max_chars: int) -> Request:
    """The request in a line; raises UnreadableLineError, whose message is the answer, where there is none."""
    if len(line) > max_chars:
        raise UnreadableLineError(
            f"That was {len(line):,} characters; I read up to {max_chars}. Please say it in a few words."
        )
    text = "".join(" " if unicodedata.category(char).startswith("C") else char for char in line)
    text = " ".join(unicodedata.normalize("NFKC", text).replace("\u2019", "'").casefold().split())
    if not any(char.isalnum() for char in text):
        raise UnreadableLineError("I heard no words. You can say, for example: find the mug.")
    for kind, pattern in _FIXED:
        if pattern.search(text):
            return Request(kind=kind)
    if not _VERB.search(text):
        return Request(kind=RequestKind.UNKNOWN, thing=_thing(text))
    found = _FIND.match(text)
    thing = _thing(found["thing"]) if found else ""
    return Request(kind=RequestKind.FIND, thing=thing) if thing else Request(kind=RequestKind.UNKNOWN)


def _thing(text: str) -> str:
    """'the blue mugs, please!' -> 'blue mugs'."""
    return _ARTICLES.sub("", _ENDINGS.sub("", text)).strip()
