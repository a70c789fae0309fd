"""How substances take the light, beside their grain: what a person tells metal from plastic by."""

from dataclasses import dataclass

from sim_bridge.homes.materials import Colour, Substance


@dataclass(frozen=True, slots=True, kw_only=True)
class Finish:
    """A surface's finish; the default is matt.

    gloss: how bright the highlight of the lamp is; sharpness: it is the cosine to the power of 2 ** this.
    mirror: the share of light from the surroundings that it throws back when seen from straight ahead
    (towards the rim it is more: Schlick's approximation of Fresnel's law); tinted: it colours all that it
    mirrors, as metals nearly do. through: the share of its colour that it owes to what is behind it (glass),
    or to what it is under its stain, dye or print (wood, leather, paper): `beneath_rgb`, in 0..1.
    """

    gloss: float = 0.0
    sharpness: int = 5
    mirror: float = 0.0
    tinted: bool = False
    through: float = 0.0
    beneath_rgb: Colour = (0.0, 0.0, 0.0)


MATT = Finish()
FINISHES: dict[Substance, Finish] = {
    Substance.METAL: Finish(gloss=0.45, sharpness=4, mirror=0.60, tinted=True),
    Substance.GLASS: Finish(
        gloss=0.70, sharpness=7, mirror=0.08, through=0.45, beneath_rgb=(0.76, 0.83, 0.81)
    ),
    Substance.CERAMIC: Finish(gloss=0.50, sharpness=6, mirror=0.04),
    Substance.WOOD: Finish(through=0.25, beneath_rgb=(0.60, 0.42, 0.25)),
    Substance.PLASTIC: Finish(gloss=0.20, sharpness=3),
    Substance.LEATHER: Finish(gloss=0.22, sharpness=4, through=0.25, beneath_rgb=(0.26, 0.15, 0.09)),
    Substance.PAPER: Finish(through=0.20, beneath_rgb=(0.94, 0.92, 0.87)),
    Substance.TILES: Finish(gloss=0.07),
    Substance.STONE: Finish(gloss=0.07),
    Substance.BOARDS: Finish(gloss=0.07),
}


def finish_of(substance: Substance) -> Finish:
    """Its finish: matt where no other is known."""
    return FINISHES.get(substance, MATT)


def shown_rgb(rgb: Colour, finish: Finish) -> Colour:
    """The colour of a surface that is stained, dyed or printed in `rgb` (0..1)."""
    red, green, blue = (
        own + (beneath - own) * finish.through for own, beneath in zip(rgb, finish.beneath_rgb, strict=True)
    )
    return red, green, blue
