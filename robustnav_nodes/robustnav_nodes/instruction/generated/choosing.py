"""Which facts of a walk a writer tells: some of each topic, one for each event, in the order of the way."""

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from robustnav_nodes.instruction.generated.crossing import crossing_facts
from robustnav_nodes.instruction.generated.dwelling import DOOR, Thing
from robustnav_nodes.instruction.generated.facts import Fact, Kind, Surroundings
from robustnav_nodes.instruction.generated.naming import SAID
from robustnav_nodes.instruction.generated.passing import passing_facts
from robustnav_nodes.instruction.generated.stopping import stop_facts
from robustnav_nodes.instruction.generated.turning import start_facts, turn_facts
from robustnav_nodes.instruction.generated.writers import TOPIC_OF, Topic, Writer
from robustnav_nodes.instruction.mentions import concepts_of_name

# How gladly each kind is told where an event can be told in several ways; 1 where nothing stands here.
_WEIGHT: Mapping[Kind, float] = MappingProxyType(
    {
        Kind.START_FACING: 0.4,
        Kind.START_BESIDE: 0.5,
        Kind.START_BACK: 2.0,
        Kind.START_BACKWARD: 5.0,
        Kind.TURN_AT: 0.5,
        Kind.TURN_TOWARDS: 0.5,
        Kind.AROUND: 3.0,
        Kind.CROSS_COUNTED: 1.2,
        Kind.CROSS_OUTERMOST: 0.45,
        Kind.PASS_BETWEEN: 0.4,
        Kind.SEE: 0.25,
        Kind.STOP_NEAR: 2.0,
        Kind.STOP_FACING: 0.8,
        Kind.STOP_BESIDE: 0.6,
        Kind.STOP_BETWEEN: 0.5,
        Kind.STOP_OUTERMOST: 1.5,
        Kind.STOP_IN_DOOR: 1.0,
        Kind.STOP_IN: 0.5,
        Kind.STOP_INSIDE: 1.4,
        Kind.STOP_OUTSIDE: 1.6,
    }
)
_PREFERRED = 2.5
_DOOR_WEIGHT, _NAMELESS_WEIGHT = 0.06, 0.15
# Topics in the order in which they claim events: a door that is turned through takes the turn with it.
_ORDER = (Topic.STOP, Topic.CROSSING, Topic.START, Topic.TURN, Topic.LEG, Topic.PASSING)
# What is left out first where too much is said, and brought back first where too little is.
_LEAST = (Topic.PASSING, Topic.LEG, Topic.START, Topic.TURN, Topic.CROSSING)


def all_facts(around: Surroundings) -> list[Fact]:
    """Everything that can be said of a walk, but of things that have no word."""
    found = (
        *start_facts(around),
        *turn_facts(around),
        *crossing_facts(around),
        *passing_facts(around),
        *stop_facts(around),
    )
    return [fact for fact in found if all(thing.name in SAID for thing in fact.things)]


def choose_facts(
    facts: Sequence[Fact], around: Surroundings, writer: Writer, rng: np.random.Generator
) -> list[Fact]:
    """The facts that this writer tells, in their order along the way."""
    common = Counter(thing.name for thing in around.dwelling.things)
    events: dict[Topic, dict[str, list[Fact]]] = defaultdict(lambda: defaultdict(list))
    for fact in facts:
        events[TOPIC_OF[fact.kind]][fact.event].append(fact)
    told: list[Fact] = []
    spare: list[Fact] = []
    covered: set[str] = set()
    named: set[int] = set()
    for topic in _ORDER:
        for event, all_ways in events[topic].items():
            ways = [fact for fact in all_ways if fact.needs is None or fact.needs in covered]
            if not ways:
                continue
            fact = _one_way(ways, writer, common, rng)
            wanted = rng.random() < writer.p[topic]
            clashes = event in covered or not covered.isdisjoint(fact.instead_of)
            if clashes or _is_named_already(fact, named):
                continue
            if wanted:
                told.append(fact)
                covered.update((event, *fact.instead_of))
                named.update(thing.number for thing in fact.things if thing.joins is None)
            else:
                spare.append(fact)
    fewest, most = writer.clauses
    told = list(_without_least(told, most))
    events_told = {event for fact in told for event in (fact.event, *fact.instead_of)}
    told = [fact for fact in told if fact.needs is None or fact.needs in events_told]
    for topic in reversed(_LEAST):
        for fact in spare:
            is_new = fact.event not in covered and not _is_named_already(fact, named)
            if len(told) < fewest and TOPIC_OF[fact.kind] is topic and is_new:
                told.append(fact)
                covered.add(fact.event)
                named.update(thing.number for thing in fact.things if thing.joins is None)
    return sorted(told, key=lambda fact: (fact.at_m, fact.kind.name.startswith("STOP")))


def _is_named_already(fact: Fact, named: set[int]) -> bool:
    """People do not speak of the same thing twice."""
    return any(thing.number in named for thing in fact.things)


def _one_way(ways: list[Fact], writer: Writer, common: Mapping[str, int], rng: np.random.Generator) -> Fact:
    salience = [_salience(fact.things, common) for fact in ways]
    of_kind: defaultdict[Kind, float] = defaultdict(float)
    for fact, value in zip(ways, salience, strict=True):
        of_kind[fact.kind] += value
    weights = np.array(
        [
            value
            / of_kind[fact.kind]
            * _WEIGHT.get(fact.kind, 1.0)
            * (_PREFERRED if fact.kind in writer.prefers else 1.0)
            for fact, value in zip(ways, salience, strict=True)
        ]
    )
    below = np.cumsum(weights)
    return ways[min(int(np.searchsorted(below, rng.random() * below[-1], side="right")), len(ways) - 1)]


def _salience(things: Sequence[Thing], common: Mapping[str, int]) -> float:
    """Large and rare things are spoken of."""
    value = 1.0
    for thing in things:
        extent = max(high - low for low, high in zip(thing.low_m, thing.high_m, strict=True))
        value *= max(extent, 0.1) ** 0.3 / common[thing.name] ** 0.7
        if thing.name == DOOR:
            value *= _DOOR_WEIGHT
        elif not concepts_of_name(thing.name):
            value *= _NAMELESS_WEIGHT
    return value


def _without_least(told: list[Fact], most: int) -> Iterator[Fact]:
    dropped: set[int] = set()
    for topic in _LEAST:
        for k, fact in enumerate(told):
            if len(told) - len(dropped) > most and TOPIC_OF[fact.kind] is topic:
                dropped.add(k)
    yield from (fact for k, fact in enumerate(told) if k not in dropped)
