"""Which rooms adjoin and which objects share a room: what makes a wrong word plausible (thesis 4.1.2)."""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations, pairwise

from robustnav_nodes.instruction.concepts import OBJECT, OBJECTS, ROOM, ROOM_TYPES_OF, ROOMS
from robustnav_nodes.instruction.episodes import Instruction
from robustnav_nodes.instruction.mentions import concepts_of_name, find_mentions
from robustnav_nodes.instruction.trajectory import ROOM_TYPES, Viewpoint

# People call one thing by either name: to swap them is no error.
SAME_THING = (
    frozenset({"bathroom", "restroom"}),
    frozenset({"living room", "lounge"}),
    frozenset({"entryway", "archway"}),
    frozenset({"chair", "armchair"}),
    frozenset({"chair", "stool"}),
    frozenset({"armchair", "couch"}),
    frozenset({"plant", "flowers"}),
    frozenset({"plant", "vase"}),
    frozenset({"flowers", "vase"}),
    frozenset({"table", "desk"}),
    frozenset({"table", "nightstand"}),
    frozenset({"counter", "island"}),
    frozenset({"dresser", "cabinet"}),
    frozenset({"lamp", "chandelier"}),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CommonSense:
    """For a concept, the others that may be said by mistake for it; sorted, so that a seed decides."""

    rooms: Mapping[str, tuple[str, ...]]
    objects: Mapping[str, tuple[str, ...]]

    def of(self, kind: str, concept: str) -> tuple[str, ...]:
        """What may replace a room or an object; nothing where none is known."""
        return (self.rooms if kind == ROOM else self.objects).get(concept, ())


def anything_goes() -> CommonSense:
    """Every other concept of the kind but for the same thing: replacements without common sense."""
    return CommonSense(rooms=_all_but_same(tuple(ROOMS)), objects=_all_but_same(tuple(OBJECTS)))


def derive_common_sense(
    instructions: Iterable[Instruction], *, near_m: float = 2.5, at_least: int = 5, lift: float = 1.2
) -> CommonSense:
    """Co-location and adjacency as they show in the data.

    Rooms adjoin that are said one after the other, or whose evidence follows one another along a walk;
    objects share a room that are seen within `near_m` of one viewpoint or said in one instruction. A pair
    counts where it occurs `at_least` so often and `lift` times as often as chance would have it.
    """
    rooms: Counter[tuple[str, str]] = Counter()
    objects: Counter[tuple[str, str]] = Counter()
    walks: dict[int, tuple[Viewpoint, ...]] = {}
    for instruction in instructions:
        mentions = find_mentions(instruction.tokens)
        said = [mention.concept for mention in mentions if mention.kind == ROOM]
        rooms.update(_pairs(pairwise(said)))
        objects.update(_pairs(combinations({m.concept for m in mentions if m.kind == OBJECT}, 2)))
        walks[id(instruction.trajectory)] = instruction.trajectory.viewpoints
    for viewpoints in walks.values():
        for before, after in pairwise(_room_of(viewpoint) for viewpoint in viewpoints):
            rooms.update(_pairs((a, b) for a in before for b in after))
        for viewpoint in viewpoints:
            near = {
                concept
                for seen in viewpoint.objects
                if seen.range_m is None or seen.range_m <= near_m
                for concept in concepts_of_name(seen.name)
            }
            objects.update(_pairs(combinations(near, 2)))
    return CommonSense(
        rooms=_likely(rooms, tuple(ROOMS), at_least, lift),
        objects=_likely(objects, tuple(OBJECTS), at_least, lift),
    )


def _room_of(viewpoint: Viewpoint) -> tuple[str, ...]:
    """What people call the most probable room type; nothing where the evidence is spread."""
    best = max(range(len(ROOM_TYPES)), key=viewpoint.rooms.__getitem__)
    if viewpoint.rooms[best] < 0.5:
        return ()
    return tuple(concept for concept, types in ROOM_TYPES_OF.items() if types[0] == ROOM_TYPES[best])


def _pairs(pairs: Iterable[tuple[str, str]]) -> Iterable[tuple[str, str]]:
    return [(min(a, b), max(a, b)) for a, b in pairs if a != b]


def _likely(
    seen: Counter[tuple[str, str]], concepts: tuple[str, ...], at_least: int, lift: float
) -> dict[str, tuple[str, ...]]:
    total = sum(seen.values())
    share: Counter[str] = Counter()
    for (a, b), count in seen.items():
        share[a] += count
        share[b] += count
    allowed = _all_but_same(concepts)
    return {
        a: tuple(
            b
            for b in allowed[a]
            if (count := seen[min(a, b), max(a, b)]) >= at_least
            and count * 2.0 * total >= lift * share[a] * share[b]
        )
        for a in concepts
    }


def _all_but_same(concepts: tuple[str, ...]) -> dict[str, tuple[str, ...]]:
    return {
        a: tuple(b for b in sorted(concepts) if b != a and frozenset({a, b}) not in SAME_THING)
        for a in concepts
    }
