"""What a person calls an object, so that no other object is meant."""

import itertools
from collections.abc import Sequence

from sim_bridge.homes.home import NUMBER, SmallObject
from sim_bridge.homes.materials import Substance
from sim_bridge.homes.objects.catalogue import CLASSES
from sim_bridge.homes.scene import Size

# In the order in which a person would try them, one or several.
TELLING = ("colour", "pattern", "material", "size", "on", "room")
# The order in which English puts them before the noun.
BEFORE_THE_NOUN = ("size", "colour", "pattern", "material")
ADJECTIVES: dict[str, str] = {Substance.WOOD: "wooden", Size.MEDIUM: "medium-sized"}
HANGING = frozenset(item.label for item in CLASSES if item.hangs)


def describe(thing: SmallObject, alike: Sequence[SmallObject]) -> str:
    """The shortest phrase that fits the object and no other of `alike`: "the red striped mug on the desk".

    `alike` may hold the object itself and objects of other classes. Where all attributes together fit another
    too, the furniture is named with its number; then only two equal objects on one piece are called the same.
    """
    own = dict(thing.attributes)
    others = [
        dict(other.attributes)
        for other in alike
        if other.label == thing.label and other.instance != thing.instance
    ]
    for count in range(len(TELLING) + 1):
        for names in itertools.combinations(TELLING, count):
            if not any(all(other[name] == own[name] for name in names) for other in others):
                return _phrase(own, names)
    return _phrase({**own, "on": thing.furniture}, TELLING)


def _phrase(own: dict[str, str], names: Sequence[str]) -> str:
    words = ["the"]
    words += [ADJECTIVES.get(own[name], own[name]) for name in BEFORE_THE_NOUN if name in names]
    words.append(own["class"])
    if "on" in names:
        words += ["above" if own["class"] in HANGING else "on", _with_article(own["on"])]
    if "room" in names:
        words += ["in", _with_article(own["room"])]
    return " ".join(words)


def _with_article(name: str) -> str:
    """People say "the desk" and "the bedroom", but "bedroom 2"."""
    return name if NUMBER.search(name) else f"the {name}"
