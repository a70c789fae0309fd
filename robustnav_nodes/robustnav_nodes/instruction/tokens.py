"""An instruction as tokens: lower-case words and numbers, and the punctuation that ends or joins phrases."""

import re
import unicodedata
from itertools import groupby

MAX_TOKENS = 1000  # more than any instruction; what follows is left out
_PLANES = 0x20000  # beyond these two there are no letters with marks


def _marks() -> str:
    """All combining marks and both joiners as ranges of a character class: re knows no category of them."""
    codes = [code for code in range(_PLANES) if unicodedata.category(chr(code)).startswith("M")]
    runs = [[code for _, code in run] for _, run in groupby(enumerate(codes), lambda pair: pair[1] - pair[0])]
    return "".join(f"{chr(run[0])}-{chr(run[-1])}" for run in runs) + "\u200c\u200d"


# A word may hold one apostrophe ("you're"). Quotes, brackets, dashes, slashes and emoji only part words.
_WORD = rf"[^\W_](?:[^\W_]|[{_marks()}])*"
_TOKEN = re.compile(rf"{_WORD}(?:'{_WORD})?|[.,;:!?]")
_APOSTROPHES = str.maketrans({"’": "'", "‘": "'", "`": "'"})


def tokenized(text: str) -> tuple[str, ...]:
    """The tokens of a person's sentence; none where it holds no word. Any script is taken as it is.

    A letter with a mark is the same however it is encoded (Unicode's NFC).
    """
    said = unicodedata.normalize("NFC", text.translate(_APOSTROPHES).lower())
    return tuple(_TOKEN.findall(said)[:MAX_TOKENS])
