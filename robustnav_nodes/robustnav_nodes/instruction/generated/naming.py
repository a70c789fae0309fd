"""What people call a thing: words for each name of a detector, with or without a look, one or several."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np

from robustnav_nodes.instruction.generated.dwelling import Thing

# Of each name the words for it, the commonest oftener; None: too small a thing, or no word for it.
SAID: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "couch": ("couch", "couch", "couch", "sofa", "sofa"),
        "armchair": ("armchair", "armchair", "arm chair", "recliner"),
        "chair": ("chair",),
        "office chair": ("chair",),
        "stool": ("stool", "stool", "bar stool"),
        "ottoman": ("ottoman",),
        "bench": ("bench",),
        "dining table": ("table", "table", "dining table"),
        "coffee table": ("table", "table", "coffee table"),
        "side table": ("table", "side table", "end table"),
        "console table": ("table",),
        "desk": ("desk",),
        "bed": ("bed",),
        "nightstand": ("nightstand", "nightstand", "night stand"),
        "dresser": ("dresser",),
        "wardrobe": ("dresser", "wardrobe", "wardrobe", "armoire"),
        "cabinet": ("cabinet", "cabinet", "cupboard"),
        "bookshelf": ("shelf", "bookshelf", "bookcase", "shelf"),
        "shelf": ("shelf",),
        "kitchen counter": ("counter", "counter", "countertop"),
        "sink": ("sink",),
        "stove": ("stove", "stove", "oven"),
        "refrigerator": ("refrigerator", "refrigerator", "fridge"),
        "dishwasher": ("dishwasher",),
        "microwave": ("microwave",),
        "toilet": ("toilet",),
        "bathtub": ("bathtub", "bathtub", "tub"),
        "shower": ("shower",),
        "washing machine": ("washing machine", "washing machine", "washer"),
        "dryer": ("washing machine", "dryer"),
        "tv": ("tv", "tv", "television"),
        "fireplace": ("fireplace",),
        "piano": ("piano",),
        "treadmill": ("treadmill", "treadmill", "exercise machine"),
        "plant": ("plant", "plant", "potted plant"),
        "flower vase": ("vase", "vase", "flowers"),
        "lamp": ("lamp",),
        "floor lamp": ("lamp",),
        "clock": ("clock",),
        "picture": ("painting", "painting", "picture", "picture", "photo"),
        "mirror": ("mirror",),
        "window": ("window",),
        "curtain": ("curtain",),
        "door": ("door", "door", "doorway"),
        "rug": ("rug", "rug", "carpet"),
        "statue": ("statue", "statue", "sculpture"),
        "column": ("column", "pillar"),
        "chandelier": ("chandelier",),
        "ceiling fan": ("fan", "ceiling fan"),
        "trash can": ("trash can", "trash can", "garbage can"),
        "basket": ("basket",),
        "towel": ("towel",),
        "thermostat": ("thermostat",),
        "guitar": ("guitar",),
        "teddy bear": ("teddy bear",),
        "backpack": ("backpack",),
        "ironing board": ("ironing board",),
    }
)
_ALWAYS_SEVERAL = frozenset({"flowers"})
_IRREGULAR = {"shelf": "shelves", "bookshelf": "bookshelves", "bench": "benches", "dish": "dishes"}


def noun_of(thing: Thing, rng: np.random.Generator, *, plain: bool = False) -> str:
    """A word for it, in the singular. `plain`: the commonest."""
    words = SAID[thing.name]
    return words[0] if plain else words[int(rng.integers(len(words)))]


def named(thing: Thing, like: Sequence[Thing], rng: np.random.Generator, *, p_look: float) -> str:
    """The thing with its article; `like`: others of its name that are in sight too.

    Several near one another are mostly named together: "the chairs".
    """
    noun = noun_of(thing, rng)
    looks = thing.looks
    look = looks[int(rng.integers(len(looks)))] + " " if looks and rng.random() < p_look else ""
    if noun in _ALWAYS_SEVERAL:
        return f"the {look}{noun}"
    if like and thing.joins is not None:
        return _with_article(look + noun)
    if like:
        near = [other for other in like if thing.away_m(*other.centre_m[:2]) <= 1.5]
        if near and rng.random() < 0.6:
            if len(near) == 1 and rng.random() < 0.4:
                return f"the two {plural(noun)}"
            return f"the {plural(noun)}"
        chance = rng.random()
        if chance < 0.35:
            return _with_article(look + noun)
        if chance < 0.5:
            return f"one of the {plural(noun)}"
    return f"the {look}{noun}"


def plural(noun: str) -> str:
    """Of the words in SAID."""
    if noun in _ALWAYS_SEVERAL:
        return noun
    first, _, last = noun.rpartition(" ")
    ending = "es" if last.endswith(("s", "x", "ch", "sh")) else "s"
    several = _IRREGULAR.get(last, last + ending)
    return f"{first} {several}" if first else several


def _with_article(noun: str) -> str:
    return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
