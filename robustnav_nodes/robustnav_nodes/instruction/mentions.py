"""The mentions in an instruction: each stretch of tokens that names a direction, an object or a room."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from robustnav_nodes.instruction.concepts import (
    AFTER_GOING,
    DIRECTION,
    GOING,
    OBJECT,
    OBJECTS,
    OPPOSITES,
    ROOM,
    ROOMS,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Mention:
    """`length` tokens from `start` that name `concept`, which is of `kind` direction, object or room."""

    start: int
    length: int
    kind: str
    concept: str


def find_mentions(tokens: Sequence[str]) -> tuple[Mention, ...]:
    """All mentions in their order, none overlapping; of several at one token the longest."""
    forms, longest = _forms()
    found: list[Mention] = []
    at = 0
    while at < len(tokens):
        for length in range(min(longest, len(tokens) - at), 0, -1):
            named = forms.get(tuple(tokens[at : at + length]))
            if named is None or (named[1] in AFTER_GOING and (at == 0 or tokens[at - 1] not in GOING)):
                continue
            found.append(Mention(start=at, length=length, kind=named[0], concept=named[1]))
            at += length
            break
        else:
            at += 1
    return tuple(found)


def concepts_of_name(name: str) -> frozenset[str]:
    """The object concepts that a detector's name such as "dining chair" may be called by."""
    return _concepts_of_name(name.lower())


@cache
def _concepts_of_name(name: str) -> frozenset[str]:
    words = name.replace("_", " ").split()
    forms, longest = _forms()
    found = set()
    for first in range(len(words)):
        for length in range(1, min(longest, len(words) - first) + 1):
            named = forms.get(tuple(words[first : first + length]))
            if named is not None and named[0] == OBJECT:
                found.add(named[1])
    return frozenset(found)


@cache
def _forms() -> tuple[dict[tuple[str, ...], tuple[str, str]], int]:
    """(kind, concept) by form, and the number of words of the longest form."""
    forms: dict[tuple[str, ...], tuple[str, str]] = {}
    for kind, concepts in ((ROOM, ROOMS), (OBJECT, OBJECTS)):
        for concept, written in concepts.items():
            for form in written:
                forms[tuple(form.split())] = (kind, concept)
    for direction in OPPOSITES:
        forms[tuple(direction.split())] = (DIRECTION, direction)
    return forms, max(map(len, forms))
