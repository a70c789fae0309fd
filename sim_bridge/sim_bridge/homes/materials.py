"""What surfaces are made of: a substance, a colour by name, and a pattern.

A material is written in words, as a person would say it: "oak wood", "blue striped fabric", "#c8b496 paint".
"""

import re
from dataclasses import dataclass
from enum import StrEnum

from robustnav_msgs_py.errors import BadSceneError

Colour = tuple[float, float, float]

COLOURS: dict[str, Colour] = {
    "red": (0.80, 0.12, 0.10),
    "blue": (0.13, 0.30, 0.75),
    "green": (0.14, 0.55, 0.22),
    "yellow": (0.93, 0.78, 0.12),
    "white": (0.96, 0.96, 0.95),
    "black": (0.10, 0.10, 0.11),
    "brown": (0.50, 0.32, 0.18),
    "grey": (0.55, 0.56, 0.58),
    "orange": (0.93, 0.48, 0.10),
    "purple": (0.48, 0.22, 0.60),
    "pink": (0.93, 0.55, 0.66),
    "turquoise": (0.13, 0.66, 0.66),
    "beige": (0.82, 0.74, 0.60),
    "cream": (0.97, 0.95, 0.88),
    "navy": (0.12, 0.18, 0.36),
    "silver": (0.70, 0.72, 0.75),
    "gold": (0.80, 0.62, 0.24),
    "charcoal": (0.22, 0.22, 0.24),
    "oak": (0.72, 0.54, 0.34),
    "walnut": (0.42, 0.26, 0.15),
    "cherry": (0.55, 0.30, 0.18),
    "leaf": (0.16, 0.48, 0.17),
    "earth": (0.25, 0.16, 0.10),
    "glow": (1.00, 0.95, 0.74),
    "sky": (0.62, 0.80, 0.97),
}
_HEX = re.compile(r"#[0-9a-f]{6}")


class Substance(StrEnum):
    """What something is made of; each has a texture of its own."""

    PAINT = "paint"
    WOOD = "wood"
    BOARDS = "boards"
    FABRIC = "fabric"
    CARPET = "carpet"
    LEATHER = "leather"
    METAL = "metal"
    CERAMIC = "ceramic"
    GLASS = "glass"
    PLASTIC = "plastic"
    PAPER = "paper"
    STONE = "stone"
    TILES = "tiles"
    LIGHT = "light"


class Pattern(StrEnum):
    """What is printed or woven on a surface, in a second colour."""

    PLAIN = "plain"
    STRIPED = "striped"
    CHECKED = "checked"
    DOTTED = "dotted"


@dataclass(frozen=True, slots=True, kw_only=True)
class Material:
    """One material. `colour` is a name in COLOURS, or #rrggbb."""

    substance: Substance
    colour: str
    pattern: Pattern = Pattern.PLAIN

    def __post_init__(self) -> None:
        if self.colour not in COLOURS and not _HEX.fullmatch(self.colour):
            raise BadSceneError(
                f"no colour is called {self.colour!r}; there are {', '.join(COLOURS)}, and #rrggbb"
            )

    @property
    def rgb(self) -> Colour:
        """Red, green and blue in 0..1."""
        if self.colour in COLOURS:
            return COLOURS[self.colour]
        red, green, blue = (int(self.colour[at : at + 2], 16) / 255.0 for at in (1, 3, 5))
        return red, green, blue

    def shaded(self, factor: float) -> "Material":
        """The same material, darker (factor below 1) or lighter (above); its colour is then a #rrggbb."""
        levels = (round(255.0 * min(1.0, channel * factor)) for channel in self.rgb)
        colour = "#" + "".join(f"{level:02x}" for level in levels)
        return Material(substance=self.substance, colour=colour, pattern=self.pattern)

    def __str__(self) -> str:
        words = [self.colour, self.pattern, self.substance]
        return " ".join(word for word in words if word != Pattern.PLAIN)


def material(words: str) -> Material:
    """Read "blue striped fabric". Raises BadSceneError with a sentence that lists what there is."""
    parts = words.split()
    if len(parts) not in (2, 3):
        raise BadSceneError(
            f"a material is a colour, a pattern or none, and a substance, as 'blue striped fabric': {words!r}"
        )
    pattern = parts[1] if len(parts) == 3 else Pattern.PLAIN
    if pattern not in list(Pattern):
        raise BadSceneError(f"no pattern is called {pattern!r} in {words!r}; there are {', '.join(Pattern)}")
    if parts[-1] not in list(Substance):
        raise BadSceneError(
            f"nothing is made of {parts[-1]!r} in {words!r}; there are {', '.join(Substance)}"
        )
    return Material(substance=Substance(parts[-1]), colour=parts[0].lower(), pattern=Pattern(pattern))
