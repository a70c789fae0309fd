"""What a class of objects is: its shape, the looks it comes in, and where it belongs.

Every class has a shape of its own, so that a person (and a detector) tells it from the others whatever its
colour. An object's frame has its origin below its middle; x is its front.
"""

import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from sim_bridge.homes.materials import Material, Pattern, Substance
from sim_bridge.homes.scene import SCALE, Look, Size
from sim_bridge.homes.shapes import Part, scaled

EVERY_PATTERN = tuple(Pattern)
EVERY_SIZE = tuple(Size)


@dataclass(frozen=True, slots=True, kw_only=True)
class Looks:
    """What a class comes in: every combination of these."""

    colours: tuple[str, ...]
    substances: tuple[Substance, ...]
    patterns: tuple[Pattern, ...] = (Pattern.PLAIN,)
    sizes: tuple[Size, ...] = EVERY_SIZE

    def __contains__(self, look: Look) -> bool:
        return (
            look.colour in self.colours
            and look.substance in self.substances
            and look.pattern in self.patterns
            and look.size in self.sizes
        )

    def all(self) -> tuple[Look, ...]:
        """Every look, in a fixed order."""
        ways = itertools.product(self.colours, self.substances, self.patterns, self.sizes)
        return tuple(
            Look(colour=colour, substance=substance, pattern=pattern, size=size)
            for colour, substance, pattern, size in ways
        )

    def __str__(self) -> str:
        words = (self.colours, self.substances, self.patterns, self.sizes)
        return "; ".join(", ".join(choices) for choices in words)


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectClass:
    """One class of objects. `build` makes a medium-sized one whose main parts are of the material.

    `belongs_on` tells by furniture kind how willingly it stands there, or where it `hangs`, hangs above it.
    """

    label: str
    looks: Looks
    build: Callable[[Material], tuple[Part, ...]]
    belongs_on: Mapping[str, float]
    hangs: bool = False

    def parts(self, look: Look) -> tuple[Part, ...]:
        """The parts of an object with that look, in its own frame."""
        return scaled(self.build(look.material), SCALE[look.size])

    @property
    def default_look(self) -> Look:
        """The look of an object of which nothing is said."""
        return Look(
            colour=self.looks.colours[0],
            substance=self.looks.substances[0],
            pattern=self.looks.patterns[0],
            size=Size.MEDIUM,
        )
