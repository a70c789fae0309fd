"""Which of the detector's classes a person means."""

import re
from collections.abc import Sequence


def matching_class(thing: str, names: Sequence[str]) -> str | None:
    """The class that `thing` names: 'coffee mugs' means 'mug'; the longest match wins; None where none does.

    Only whole words count, singular or plural; what else the person says about the thing is not used here.
    """
    words = _words(thing)
    found = [name for name in names if _contains(words, _words(name))]
    return max(found, key=len, default=None)


def listed(names: Sequence[str], most: int) -> str:
    """Class names as a person reads them, at most `most` of them."""
    shown = ", ".join(sorted(names)[:most])
    return shown if len(names) <= most else f"{shown} and {len(names) - most} more"


def _words(text: str) -> list[str]:
    return [_singular(word) for word in re.findall(r"[^\W_]+", text.casefold())]


def _singular(word: str) -> str:
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(("ches", "shes", "sses", "xes")):
        return word[:-2]
    if word.endswith("s") and not word.endswith("ss") and len(word) > 3:
        return word[:-1]
    return word


def _contains(words: list[str], part: list[str]) -> bool:
    size = len(part)
    return size > 0 and any(words[start : start + size] == part for start in range(len(words) - size + 1))
