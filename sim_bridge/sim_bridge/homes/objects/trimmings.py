"""Materials that are the same on every object of a class, and colours that stand out against the main one."""

from sim_bridge.homes.materials import Material, Substance, material

PAPER = material("cream paper")
WHITE = material("white plastic")
CHINA = material("white ceramic")
DARK = material("black plastic")
RUBBER = material("charcoal plastic")
STEEL = material("silver metal")
LEAF = material("leaf fabric")
YOUNG_LEAF = material("#4d9e3d fabric")
STALK = material("earth wood")
SOIL = material("earth stone")
SCREEN = material("sky light")
DARK_SCREEN = material("navy glass")
WINDOW = material("sky glass")
GLOW = material("glow light")
FLAME = material("orange light")
TAN_WOOD = material("oak wood")

# Rec. 709: how bright red, green and blue look.
BRIGHTNESS = (0.2126, 0.7152, 0.0722)
BRIGHT = 0.45


def against(main: Material, substance: Substance = Substance.PLASTIC) -> Material:
    """White on what is dark, charcoal on what is bright."""
    bright = sum(share * channel for share, channel in zip(BRIGHTNESS, main.rgb, strict=True)) > BRIGHT
    return Material(substance=substance, colour="charcoal" if bright else "white")
