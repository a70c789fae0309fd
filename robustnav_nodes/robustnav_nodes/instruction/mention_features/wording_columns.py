"""How a mention reads: all that can be told without a look at the walk."""

import numpy as np

from robustnav_msgs_py.values import Float64
from robustnav_nodes.instruction.concepts import DIRECTION, is_plural
from robustnav_nodes.instruction.direction_phrases import PHRASES, phrase_of
from robustnav_nodes.instruction.mention_features.columns import Columns, Told
from robustnav_nodes.instruction.mention_features.replacements import (
    ODDS,
    Replacements,
    replacement_odds,
    worst_other,
)
from robustnav_nodes.instruction.wording import KIND_OF_CONCEPT


def _words(line: str) -> tuple[str, ...]:
    return tuple(line.split())


EDGE = "|"  # beside the first and the last token
_FAR = 99.0  # tokens to what is not there
_BEFORE = _words(
    "the a your to into in of out exit leave enter turn on at past through by next and from down up left "
    "right toward towards near front go walk take make slight slightly sharp stop wait between around . , "
    "first second straight until reach with pass just continue head hard |"
)
_AFTER = _words(
    ". , and of on in to the your with at into side door down up until past through towards when then room "
    "stairs hallway one table |"
)
_BEFORE_NUMBER = {word: float(k) for k, word in enumerate(_BEFORE)}
_AFTER_NUMBER = {word: float(k) for k, word in enumerate(_AFTER)}
_OFTEN_BEFORE = ("the", "your", "turn", "to", "into", "exit", "in", "on", "past", "and", ".")
_OFTEN_AFTER = (".", ",", "and", "of", "on", "in", "the")


def add_wording(columns: Columns, said: Told, replacements: Replacements) -> Float64:
    """Add the columns; answers the log odds of a replacement (ODDS[0])."""
    rows = np.arange(len(said))
    own = said.fits[rows, said.numbers] if len(said) else np.zeros(0)
    columns.add("concept", said.numbers.astype(float))
    columns.add("fit", own)
    columns.add("fit_of_best", _best_of_kind(said))
    odds = replacement_odds(said.fits, said.numbers, replacements)
    for name, values in zip(ODDS, odds, strict=True):
        columns.add(f"blind_{name}", values)
    _add_neighbouring_words(columns, said)
    _add_places_in_text(columns, said)
    _add_other_mentions(columns, said)
    uniform: Float64 = odds[0]
    columns.add("fit_before", np.concatenate([[np.nan], uniform[:-1]]) if len(said) else uniform)
    columns.add("fit_after", np.concatenate([uniform[1:], [np.nan]]) if len(said) else uniform)
    columns.add("fit_worst_other", worst_other(uniform))
    return uniform


def _best_of_kind(said: Told) -> Float64:
    """float64 [M]: how well the concept fits that fits best where each mention stands."""
    own_kind = KIND_OF_CONCEPT[None, :] == KIND_OF_CONCEPT[said.numbers][:, None]
    best: Float64 = np.where(own_kind, said.fits, -np.inf).max(axis=1)
    return best


def _add_neighbouring_words(columns: Columns, said: Told) -> None:
    tokens = said.tokens
    before = [tokens[m.start - 1] if m.start else EDGE for m in said.mentions]
    before2 = [tokens[m.start - 2] if m.start > 1 else EDGE for m in said.mentions]
    ends = [m.start + m.length for m in said.mentions]
    after = [tokens[end] if end < len(tokens) else EDGE for end in ends]
    columns.add("before", np.array([_BEFORE_NUMBER.get(word, float(len(_BEFORE))) for word in before]))
    columns.add("before2", np.array([_BEFORE_NUMBER.get(word, float(len(_BEFORE))) for word in before2]))
    columns.add("after", np.array([_AFTER_NUMBER.get(word, float(len(_AFTER))) for word in after]))
    for word in _OFTEN_BEFORE:
        columns.add(f"before_{word}", np.array([float(one == word) for one in before]))
    for word in _OFTEN_AFTER:
        columns.add(f"after_{word}", np.array([float(one == word) for one in after]))


def _add_places_in_text(columns: Columns, said: Told) -> None:
    count, tokens = len(said), said.tokens
    starts = np.array([m.start for m in said.mentions], dtype=float)
    columns.add("said_at", starts / max(1, len(tokens) - 1))
    columns.add("tokens", np.full(count, float(len(tokens))))
    stops = np.array([k for k, token in enumerate(tokens) if token == "."], dtype=float)
    gaps = stops[None, :] - starts[:, None]
    columns.add("sentence", (gaps < 0.0).sum(axis=1).astype(float))
    columns.add("sentences_left", (gaps > 0.0).sum(axis=1).astype(float))
    columns.add("to_stop", np.where(gaps > 0.0, gaps, _FAR).min(axis=1, initial=_FAR))
    columns.add("from_stop", np.where(gaps < 0.0, -gaps, starts[:, None] + 1.0).min(axis=1, initial=_FAR))
    forms = [" ".join(tokens[m.start : m.start + m.length]) for m in said.mentions]
    columns.add("plural", np.array([float(is_plural(form)) for form in forms]))
    columns.add("words", np.array([float(m.length) for m in said.mentions]))


def _add_other_mentions(columns: Columns, said: Told) -> None:
    count = len(said)
    concepts = [m.concept for m in said.mentions]
    columns.add("mentions", np.full(count, float(count)))
    columns.add("same", np.array([float(concepts.count(concept)) for concept in concepts]))
    phrases = [phrase_of(said.tokens, m) if m.kind == DIRECTION else PHRASES for m in said.mentions]
    columns.add("phrase", np.array(phrases, dtype=float))
    starts = np.array([m.start for m in said.mentions], dtype=float)
    numbers = said.numbers.astype(float)
    columns.add("gap_before", np.diff(starts, prepend=-_FAR) if count else starts)
    columns.add("gap_after", np.diff(starts, append=2.0 * _FAR) if count else starts)
    columns.add("concept_before", np.concatenate([[-1.0], numbers[:-1]]) if count else numbers)
    columns.add("concept_after", np.concatenate([numbers[1:], [-1.0]]) if count else numbers)
