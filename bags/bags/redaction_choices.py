"""What a bag may keep when it is shared; the command line reads its choices from here."""

from enum import StrEnum


class Images(StrEnum):
    """What becomes of images."""

    REMOVE = "remove"
    BLUR = "blur"
    KEEP = "keep"


class Chat(StrEnum):
    """What becomes of what was said."""

    REMOVE = "remove"
    KEEP = "keep"
