"""From facts to an instruction: each fact in a frame, the clauses joined and spelled as a writer does."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from robustnav_nodes.instruction.generated.choosing import choose_facts
from robustnav_nodes.instruction.generated.dwelling import Thing
from robustnav_nodes.instruction.generated.facts import LEFT, RIGHT, Fact, Kind, Surroundings
from robustnav_nodes.instruction.generated.frames import FRAMES, chosen
from robustnav_nodes.instruction.generated.naming import named, noun_of
from robustnav_nodes.instruction.generated.room_words import WORDS
from robustnav_nodes.instruction.generated.writers import Spelling, Writer

_COUNTS = {-1: "last", 1: "first", 2: "second", 3: "third", 4: "fourth", 5: "fifth"}
_WORDS_OF_NUMBERS = ("zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten")
_FEET_A_METRE = 3.281
_MOST_IN_A_SENTENCE = 3
_SENTENCE_JOINTS = (*(". ",) * 12, ". then ", ". next, ", ". after that, ", ". now ")
_CLAUSE_JOINTS = (" and ", " and ", " and ", ", ", ", then ", " then ", ", and then ", " and then ")
_ARTICLES = re.compile(r"\b(?:the|a|an|your) (?!(?:left|right|little|bit|first|second|third|last|two)\b)")
_SENTENCE_START = re.compile(r"(^|[.!?] )([a-z])")


@dataclass(frozen=True, slots=True, kw_only=True)
class Clause:
    """A part of an instruction, as it is joined in, and the fact that it tells."""

    text: str
    fact: Fact


@dataclass(frozen=True, slots=True, kw_only=True)
class Told:
    """An instruction, and its clauses in their order; an opener or closer is no clause."""

    text: str
    writer: str
    clauses: tuple[Clause, ...]


def tell(facts: Sequence[Fact], around: Surroundings, writer: Writer, rng: np.random.Generator) -> Told:
    """An instruction for the walk by one writer; the generator decides all that is free."""
    words = _Words(around, writer, rng)
    spelling = writer.spelling
    how = spelling[int(rng.choice(len(spelling), p=[p for _, p in spelling]))][0]
    told: list[Clause] = []
    text = _one_of(writer.openers, rng)
    in_sentence = 0
    for fact in choose_facts(facts, around, writer, rng):
        said = words.of(fact)
        if not told:
            joint = ""
        elif said.startswith("=") or in_sentence >= _MOST_IN_A_SENTENCE or rng.random() < writer.p_sentence:
            joint = _one_of(_SENTENCE_JOINTS, rng)
            joint = ". " if said.startswith("=") else joint
            in_sentence = 0
        else:
            joint = _one_of(_CLAUSE_JOINTS, rng)
        said = said.removeprefix("=")
        in_sentence += 1 + 2 * (". " in said)
        text += joint + said
        told.append(Clause(text=(joint + said).strip(" .,"), fact=fact))
    closer = _one_of(writer.closers, rng)
    text += (". " + closer if closer else "") + "."
    return Told(text=_spelled(text, how), writer=writer.name, clauses=tuple(told))


class _Words:
    """Fills frames for one instruction: a room keeps its name from clause to clause."""

    def __init__(self, around: Surroundings, writer: Writer, rng: np.random.Generator) -> None:
        self._around = around
        self._writer = writer
        self._rng = rng
        self._rooms: dict[str, str] = {}
        self._recent: set[str] = set()

    def of(self, fact: Fact) -> str:
        frames = FRAMES[fact.kind]
        ways = [self._frame(frames) for _ in range(2 if self._writer.wordy else 1)]
        ways.sort(key=lambda way: len(way.split()) * self._writer.wordy)
        side = fact.side or ""
        slots = {
            "side": side,
            "sidemost": f"{side}most",
            "the_side": self._at_side(side),
            "the_left": self._at_side(LEFT),
            "the_right": self._at_side(RIGHT),
            "count": _COUNTS.get(fact.count, ""),
            "distance": "" if fact.metres is None else self._distance(fact.metres),
        }
        for slot, room in zip(("room", "entered"), fact.rooms, strict=False):
            slots[slot] = self._room(room, entered=slot == "entered" or fact.kind is Kind.STOP_OUTSIDE)
        for slot, thing in zip(("thing", "other"), fact.things, strict=False):
            slots[slot] = named(thing, self._like(fact, thing), self._rng, p_look=self._writer.p_look)
        if fact.things:
            slots["noun"] = noun_of(fact.things[0], self._rng, plain=True)
        said = ways[-1].format_map(slots)
        return _ARTICLES.sub("", said) if self._writer.drops_articles and self._rng.random() < 0.5 else said

    def _frame(self, frames: tuple[str, ...]) -> str:
        """One that was not used in this instruction, where there is one."""
        fresh = [frame for frame in frames if frame not in self._recent] or list(frames)
        frame = fresh[int(self._rng.integers(len(fresh)))]
        self._recent.add(frame)
        return chosen(frame, self._rng)

    def _at_side(self, side: str) -> str:
        return f"{'your' if self._rng.random() < self._writer.p_your else 'the'} {side}"

    def _room(self, name: str, *, entered: bool) -> str:
        """By its name; now and then only "the room" that one is in, or "the next room"."""
        if self._rng.random() < self._writer.p_the_room:
            return "the next room" if entered else "the room"
        if name not in self._rooms:
            said = WORDS[self._around.dwelling.room(name).kind].said
            self._rooms[name] = said[int(self._rng.integers(len(said)))]
        return f"the {self._rooms[name]}"

    def _like(self, fact: Fact, thing: Thing) -> list[Thing]:
        seen = {number for at in range(fact.first, fact.last + 1) for number in self._around.in_sight[at]}
        things = self._around.dwelling.things
        return [things[n] for n in sorted(seen) if things[n].name == thing.name and n != thing.number]

    def _distance(self, metres: float) -> str:
        """Rounded as people do: to metres, or to five feet."""
        if self._writer.metric:
            whole = max(1, round(metres))
            number = _WORDS_OF_NUMBERS[whole] if whole < len(_WORDS_OF_NUMBERS) else str(whole)
            return f"{number} {'meter' if whole == 1 else 'meters'}"
        feet = 5 * max(1, math.floor(metres * _FEET_A_METRE / 5.0 + 0.5))
        return f"{_WORDS_OF_NUMBERS[feet] if feet < len(_WORDS_OF_NUMBERS) else feet} feet"


def _one_of(words: Sequence[str], rng: np.random.Generator) -> str:
    return words[int(rng.integers(len(words)))] if words else ""


def _spelled(text: str, how: Spelling) -> str:
    if how is Spelling.UPPER:
        return text.upper()
    if how is Spelling.CARELESS:
        return text.removesuffix(".").replace(". ", ", ")
    if how is Spelling.LOWER:
        return text
    return _SENTENCE_START.sub(lambda match: match[1] + match[2].upper(), text)
