"""Errors put into clean instructions (thesis 4.1.2), with the positions of the wrong words as ground truth.

Two protocols. `uniform` is the thesis': a mention of the wanted kind and what replaces it are drawn
uniformly. Rare words then give the errors away, without a look at the walk. `matched` accepts a draw with
probability min(1, fit(new) / fit(old)), by how people write (`Wording`): the wording alone tells almost
nothing.
"""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from robustnav_nodes.instruction.common_sense import CommonSense
from robustnav_nodes.instruction.concepts import (
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
_MATCHED_TRIES = 40  # draws until a kind counts as not replaceable in an instruction


@dataclass(frozen=True, slots=True, kw_only=True)
class Injector:
    """What decides the errors besides chance: plausible replacements, and (matched only) the wording."""

    common_sense: CommonSense
    wording: Wording | None = None  # None: the protocol `uniform`

    def perturbed(
        self, tokens: Sequence[str], error_type: str, rng: np.random.Generator
    ) -> tuple[tuple[str, ...], tuple[WrongSpan, ...]] | None:
        """The instruction with one error of each kind of `error_type`; None where one cannot be put in."""
        chosen: list[tuple[Mention, str]] = []
        mentions = find_mentions(tokens)
        for kind in ERROR_TYPES[error_type]:
            draw = self._draw(tokens, [mention for mention in mentions if mention.kind == kind], rng)
            if draw is None:
                return None
            chosen.append(draw)
        chosen.sort(key=lambda draw: draw[0].start)
        said: list[str] = []
        spans: list[WrongSpan] = []
        at = 0
        for mention, concept in chosen:
            said += tokens[at : mention.start]
            at = mention.start + mention.length
            form = " ".join(tokens[mention.start : at])
            words = put_in_form(mention.kind, concept, plural=is_plural(form)).split()
            spans.append(
                WrongSpan(
                    start=len(said),
                    length=len(words),
                    kind=mention.kind,
                    right=mention.concept,
                    wrong=concept,
                )
            )
            said += words
        return (*said, *tokens[at:]), tuple(spans)

    def _draw(
        self, tokens: Sequence[str], mentions: Sequence[Mention], rng: np.random.Generator
    ) -> tuple[Mention, str] | None:
        replaceable = [(mention, others) for mention in mentions if (others := self._others(mention))]
        if not replaceable:
            return None
        for _ in range(1 if self.wording is None else _MATCHED_TRIES):
            mention, others = replaceable[int(rng.integers(len(replaceable)))]
            concept = others[int(rng.integers(len(others)))]
            if self.wording is None:
                return mention, concept
            gain = self.wording.gain(tokens, mention, concept)
            if math.log(rng.uniform(1e-300, 1.0)) < gain:
                return mention, concept
        return None

    def _others(self, mention: Mention) -> tuple[str, ...]:
        if mention.kind == DIRECTION:
            return (OPPOSITES[mention.concept],)
        if self.wording is not None and mention.concept in HARDLY_LISTED:
            return ()
        others = self.common_sense.of(mention.kind, mention.concept)
        if self.wording is None:
            return others
        return tuple(other for other in others if other not in HARDLY_LISTED)


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
    instructions: Sequence[Instruction], common_sense: CommonSense, protocol: Protocol, seed: int
) -> dict[str, list[ErrorEpisode]]:
    """Matched by the wording of the other half of the homes: by their own, what stands there fits best."""
    homes = sorted({one.group for one in instructions})
    halves = (set(homes[::2]), set(homes[1::2]))
    found: dict[str, list[ErrorEpisode]] = {name: [] for name in ERROR_TYPES}
    for half in halves:
        wording = None
        if protocol == "matched":
            wording = learn_wording(one.tokens for one in instructions if one.group not in half)
        injector = Injector(common_sense=common_sense, wording=wording)
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
