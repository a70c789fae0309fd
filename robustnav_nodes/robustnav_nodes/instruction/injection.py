"""Errors put into clean instructions (thesis 4.1.2), with the positions of the wrong words as ground truth.

Two protocols. `uniform` is the thesis': a mention of the wanted kind and what replaces it are drawn
uniformly. Rare words then give the errors away, without a look at the walk. `matched` accepts what is drawn
as Metropolis and Hastings do, with probability min(1, p(new) / p(old) * q(back) / q(there)): p by how people
write (`Wording`), q how often the one is drawn for the other. With single draws wrong instructions read like
clean ones; a few tries for each instruction find more errors, and the wording then tells a little of them.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from robustnav_nodes.instruction.common_sense import CommonSense
from robustnav_nodes.instruction.concepts import (
    CONCEPT_NUMBER,
    DIRECTION,
    HARDLY_LISTED,
    KINDS,
    OPPOSITES,
    is_plural,
    put_in_form,
)
from robustnav_nodes.instruction.episodes import ERROR_TYPES, ErrorEpisode, Instruction, WrongSpan
from robustnav_nodes.instruction.mentions import Mention, find_mentions
from robustnav_nodes.instruction.wording import Wording, learn_wording

Protocol = Literal["uniform", "matched"]
PROTOCOLS: tuple[Protocol, ...] = ("uniform", "matched")

MIN_TOKENS = 10  # instructions of fewer are too simple (the thesis' threshold has no number)
_MATCHED_TRIES = 3  # with 40 all is found, and the wording tells much of it


@dataclass(frozen=True, slots=True, kw_only=True)
class Injector:
    """What decides the errors besides chance: plausible replacements, and (matched only) the wording."""

    common_sense: CommonSense
    wording: Wording | None = None  # None: the protocol `uniform`

    def perturbed(
        self, tokens: Sequence[str], error_type: str, rng: np.random.Generator
    ) -> tuple[tuple[str, ...], tuple[WrongSpan, ...]] | None:
        """The instruction with one error of each kind of `error_type`.

        None where there is nothing to replace, or (matched) none of a few proposals was accepted.
        """
        for _ in range(1 if self.wording is None else _MATCHED_TRIES):
            proposal = self._proposal(tuple(tokens), error_type, rng)
            if proposal is None:
                continue
            said, spans, log_acceptance = proposal
            if self.wording is None or math.log(rng.uniform(1e-300, 1.0)) < log_acceptance:
                return said, tuple(sorted(spans, key=lambda span: span.start))
        return None

    def _proposal(
        self, said: tuple[str, ...], error_type: str, rng: np.random.Generator
    ) -> tuple[tuple[str, ...], list[WrongSpan], float] | None:
        """Put in one error after the other; with the logarithm of the Metropolis-Hastings ratio of them all.

        None where there is nothing to replace, or the words put in read as something else beside the others.
        """
        spans: list[WrongSpan] = []
        log_acceptance = 0.0
        for kind in ERROR_TYPES[error_type]:
            mentions = find_mentions(said)
            choices = self._choices(mentions, kind)
            if not choices:
                return None
            m, others = choices[int(rng.integers(len(choices)))]
            mention, concept = mentions[m], others[int(rng.integers(len(others)))]
            if self.wording is not None:
                fits = self.wording.log_fits_at(said, mentions, m)
                old, new = CONCEPT_NUMBER[kind, mention.concept], CONCEPT_NUMBER[kind, concept]
                log_acceptance += float(fits[new] - fits[old])
            said, spans = _put_in(said, spans, mention, concept)
            changed = find_mentions(said)
            if not _all_found(spans, changed):
                return None
            if self.wording is not None:
                choices_back = self._choices(changed, kind)
                back = dict(choices_back).get(m, ())  # empty where common sense leads one way only
                ways = len(choices) * len(others), max(1, len(choices_back)) * max(1, len(back))
                log_acceptance += math.log(ways[0] / ways[1])
        return said, spans, log_acceptance

    def _choices(self, mentions: Sequence[Mention], kind: str) -> list[tuple[int, tuple[str, ...]]]:
        """Which mentions of a kind can be replaced, and by what."""
        return [
            (m, others)
            for m, mention in enumerate(mentions)
            if mention.kind == kind and (others := self._others(mention))
        ]

    def _others(self, mention: Mention) -> tuple[str, ...]:
        if mention.kind == DIRECTION:
            return (OPPOSITES[mention.concept],)
        if self.wording is not None and mention.concept in HARDLY_LISTED:
            return ()
        others = self.common_sense.of(mention.kind, mention.concept)
        if self.wording is None:
            return others
        return tuple(other for other in others if other not in HARDLY_LISTED)


def _put_in(
    said: tuple[str, ...], spans: list[WrongSpan], mention: Mention, concept: str
) -> tuple[tuple[str, ...], list[WrongSpan]]:
    end = mention.start + mention.length
    form = " ".join(said[mention.start : end])
    words = put_in_form(mention.kind, concept, plural=is_plural(form)).split()
    longer = len(words) - mention.length
    moved = [
        replace(span, start=span.start + longer) if span.start > mention.start else span for span in spans
    ]
    span = WrongSpan(
        start=mention.start, length=len(words), kind=mention.kind, right=mention.concept, wrong=concept
    )
    return (*said[: mention.start], *words, *said[end:]), [*moved, span]


def _all_found(spans: Sequence[WrongSpan], mentions: Sequence[Mention]) -> bool:
    """Whether what was put in is mentioned as such: "hall" before "way" would be a hallway."""
    found = {(m.start, m.length, m.kind, m.concept) for m in mentions}
    return all((span.start, span.length, span.kind, span.wrong) in found for span in spans)


def error_episodes(
    instructions: Iterable[Instruction], error_type: str, injector: Injector, *seeds: int
) -> Iterator[ErrorEpisode]:
    """Clean and perturbed episodes in pairs, half with an error; the seeds and the key decide each."""
    for instruction in instructions:
        if len(instruction.tokens) < MIN_TOKENS:
            continue
        number = [ord(letter) for letter in f"{error_type}/{instruction.key}"]
        found = injector.perturbed(instruction.tokens, error_type, np.random.default_rng([*seeds, *number]))
        if found is None:
            continue
        said, spans = found
        for suffix, tokens, wrong in (("c", instruction.tokens, ()), ("p", said, spans)):
            yield ErrorEpisode(
                key=f"{instruction.key}_{suffix}",
                group=instruction.group,
                error_type=error_type,
                tokens=tokens,
                trajectory=instruction.trajectory,
                wrong=wrong,
            )


def episodes_put_in(
    instructions: Sequence[Instruction],
    common_sense: CommonSense,
    protocol: Protocol,
    seed: int,
    *,
    wording: Wording | None = None,
) -> dict[str, list[ErrorEpisode]]:
    """By type of error. `wording` is what matched ones are drawn by, and that of other homes: by their own,
    what stands there fits best; None: that of the other half of the homes.
    """
    homes = sorted({one.group for one in instructions})
    halves = (set(homes[::2]), set(homes[1::2]))
    found: dict[str, list[ErrorEpisode]] = {name: [] for name in ERROR_TYPES}
    for half in filter(None, halves):
        others = wording
        if protocol == "matched" and others is None:
            others = learn_wording(one.tokens for one in instructions if one.group not in half)
        injector = Injector(common_sense=common_sense, wording=others if protocol == "matched" else None)
        own = [one for one in instructions if one.group in half]
        for name, episodes in found.items():
            episodes += error_episodes(own, name, injector, seed)
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorStatistics:
    """A row of the thesis' table 4.1."""

    error_type: str
    episodes: int
    errors_per_episode: float
    mean_tokens: float
    kinds: tuple[tuple[str, int], ...]


def error_statistics(error_type: str, episodes: Sequence[ErrorEpisode]) -> ErrorStatistics:
    """Count the episodes of one error type; all is 0 where there are none."""
    wrong = [episode for episode in episodes if episode.wrong]
    spans = [span for episode in wrong for span in episode.wrong]
    return ErrorStatistics(
        error_type=error_type,
        episodes=len(episodes),
        errors_per_episode=len(spans) / len(wrong) if wrong else 0.0,
        mean_tokens=float(np.mean([len(e.tokens) for e in episodes])) if episodes else 0.0,
        kinds=tuple((kind, sum(span.kind == kind for span in spans)) for kind in KINDS),
    )
