"""What the person says about a find, as it comes on search/facts: `confirmed mug`, `refuted mug`."""

from robustnav_msgs_py.errors import BadMessageError

CONFIRMED, REFUTED = "confirmed", "refuted"


def read_verdict(line: str) -> tuple[str, bool]:
    """The class, and whether the find was confirmed; raises BadMessageError for any other line."""
    word, _, label = line.strip().partition(" ")
    if word not in (CONFIRMED, REFUTED) or not label.strip():
        shown = line if len(line) <= 80 else line[:77] + "..."
        raise BadMessageError(
            f"search/facts says {shown!r}; it must be '{CONFIRMED} CLASS' or '{REFUTED} CLASS'"
        )
    return label.strip(), word == CONFIRMED
