"""An instruction as tokens: lower-case words and numbers, and the punctuation that ends or joins phrases."""

import re

MAX_TOKENS = 1000  # more than any instruction; what follows is left out
# A word may hold one apostrophe ("you're"). Quotes, brackets, dashes, slashes and emoji only part words.
_TOKEN = re.compile(r"[^\W_]+(?:'[^\W_]+)?|[.,;:!?]")
_APOSTROPHES = str.maketrans({"’": "'", "‘": "'", "`": "'"})


def tokenized(text: str) -> tuple[str, ...]:
    """The tokens of a person's sentence; none where it holds no word. Any script is taken as it is."""
    return tuple(_TOKEN.findall(text.translate(_APOSTROPHES).lower())[:MAX_TOKENS])
