"""Tokens are words and the punctuation between phrases, whatever a person types."""

import pytest

from robustnav_nodes.instruction.tokens import MAX_TOKENS, tokenized


@pytest.mark.parametrize(
    ("text", "tokens"),
    [
        ("", ()),
        ("  \n", ()),
        ("Turn LEFT, then go.", ("turn", "left", ",", "then", "go", ".")),
        ("you'll see the men’s walk-in", ("you'll", "see", "the", "men's", "walk", "in")),
        ('the "exit" (on the left)', ("the", "exit", "on", "the", "left")),
        ("turn 90 degrees 🙂🚪", ("turn", "90", "degrees")),
        ("поверни налево", ("поверни", "налево")),
        ("रसोई में बाएँ मुड़ें।", ("रसोई", "में", "बाएँ", "मुड़ें")),
        ("می‌خواهم", ("می‌خواهم",)),
        ("stop at the cafe\u0301 🚪\ufe0f", ("stop", "at", "the", "café")),
    ],
)
def test_tokens(text: str, tokens: tuple[str, ...]) -> None:
    assert tokenized(text) == tokens


def test_a_book_is_cut() -> None:
    assert len(tokenized("left " * 10_000)) == MAX_TOKENS
