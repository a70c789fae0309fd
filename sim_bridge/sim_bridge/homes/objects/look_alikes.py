"""Objects of one class that are hard to tell apart in words: what a search has to ask about."""

import itertools
from typing import TypeVar

import numpy as np

from sim_bridge.homes.objects.object_class import ObjectClass
from sim_bridge.homes.scene import Look

# One object to look for and 2 to 8 others, 5 on average.
MIN_OTHERS, MORE_OTHERS, P_MORE = 2, 6, 0.5
MIN_ALIKE = 1 + MIN_OTHERS
# So few looks share each colour, substance, pattern or size on average; fewer choices share more.
OBJECTS_PER_COLOUR = 3
CHOICES = 2

_Choice = TypeVar("_Choice")


def draw_count(rng: np.random.Generator) -> int:
    """How many objects of the class a home with look-alikes holds: 3 to 9, 6 on average."""
    return MIN_ALIKE + int(rng.binomial(MORE_OTHERS, P_MORE))


def draw_looks(rng: np.random.Generator, item: ObjectClass, count: int) -> tuple[Look, ...]:
    """Looks for `count` objects of the class: few colours, substances, patterns and sizes, mixed.

    No two are equal, unless the class comes in fewer than `count` looks.
    """
    looks = item.looks
    colours = _pick(rng, looks.colours, max(CHOICES, -(-count // OBJECTS_PER_COLOUR)))
    substances = _pick(rng, looks.substances, CHOICES)
    patterns = _pick(rng, looks.patterns, CHOICES)
    sizes = _pick(rng, looks.sizes, CHOICES)
    alike = [
        Look(colour=colour, substance=substance, pattern=pattern, size=size)
        for colour, substance, pattern, size in itertools.product(colours, substances, patterns, sizes)
    ]
    if len(alike) < count:
        alike = list(looks.all())
    order = [int(at) for at in rng.permutation(len(alike))]
    return tuple(alike[order[number % len(order)]] for number in range(count))


def _pick(rng: np.random.Generator, choices: tuple[_Choice, ...], count: int) -> list[_Choice]:
    """Up to `count` different ones of the choices."""
    return [choices[int(at)] for at in rng.permutation(len(choices))[:count]]
