"""What makes a home look lived in: plants, light, time and pictures."""

from sim_bridge.homes.materials import Material, Pattern, Substance, material
from sim_bridge.homes.objects.object_class import EVERY_PATTERN, Looks, ObjectClass
from sim_bridge.homes.objects.places import CHESTS, TABLES
from sim_bridge.homes.objects.trimmings import (
    DARK,
    FLAME,
    GLOW,
    LEAF,
    PAPER,
    SOIL,
    STALK,
    STEEL,
    WHITE,
    YOUNG_LEAF,
)
from sim_bridge.homes.shapes import Axis, Part, ball, box, cylinder

BLOSSOM = material("orange fabric")
POLLEN = material("yellow fabric")

# A picture on its canvas: where in depth its background ends, and how thick a layer of paint is.
CANVAS_X_M = 0.010
PAINT_M = 0.003


def plant(main: Material) -> tuple[Part, ...]:
    """A pot with a bush in it."""
    return (
        cylinder((0.0, 0.0, 0.07), 0.16, 0.14, main),
        cylinder((0.0, 0.0, 0.146), 0.18, 0.03, main),
        cylinder((0.0, 0.0, 0.161), 0.15, 0.005, SOIL),
        cylinder((0.0, 0.0, 0.20), 0.02, 0.08, STALK),
        ball((0.0, 0.0, 0.31), 0.19, LEAF),
        ball((0.06, 0.05, 0.26), 0.12, YOUNG_LEAF),
        ball((-0.06, 0.04, 0.28), 0.12, LEAF),
        ball((0.02, -0.07, 0.27), 0.12, YOUNG_LEAF),
        ball((0.0, 0.02, 0.40), 0.10, YOUNG_LEAF),
    )


def vase(main: Material) -> tuple[Part, ...]:
    """A vase with three flowers."""
    stems = ((0.0, 0.0), (0.03, 0.03), (-0.03, 0.03))
    blossoms = ((0.0, -0.03, 0.40), (0.05, 0.05, 0.36), (-0.05, 0.04, 0.38))
    return (
        cylinder((0.0, 0.0, 0.02), 0.09, 0.04, main),
        ball((0.0, 0.0, 0.09), 0.15, main),
        cylinder((0.0, 0.0, 0.175), 0.08, 0.06, main),
        cylinder((0.0, 0.0, 0.205), 0.11, 0.012, main),
        *(cylinder((x, y, 0.285), 0.012, 0.15, LEAF) for x, y in stems),
        *(ball(centre, 0.085, BLOSSOM) for centre in blossoms),
        *(ball((x, y, z + 0.03), 0.045, POLLEN) for x, y, z in blossoms),
    )


def lamp(main: Material) -> tuple[Part, ...]:
    """A table lamp: a round body, and a shade that glows."""
    return (
        cylinder((0.0, 0.0, 0.01), 0.15, 0.02, main),
        ball((0.0, 0.0, 0.10), 0.17, main),
        cylinder((0.0, 0.0, 0.21), 0.025, 0.08, STEEL),
        cylinder((0.0, 0.0, 0.25), 0.30, 0.012, main),
        cylinder((0.0, 0.0, 0.285), 0.285, 0.06, GLOW),
        cylinder((0.0, 0.0, 0.345), 0.235, 0.062, GLOW),
        cylinder((0.0, 0.0, 0.405), 0.185, 0.062, GLOW),
        cylinder((0.0, 0.0, 0.438), 0.16, 0.012, main),
    )


def clock(main: Material) -> tuple[Part, ...]:
    """An alarm clock with two bells; its face looks towards +x."""
    return (
        cylinder((0.0, 0.0, 0.13), 0.22, 0.08, main, Axis.X),
        cylinder((0.0395, 0.0, 0.13), 0.18, 0.005, WHITE, Axis.X),
        box((0.0425, 0.0, 0.162), (0.004, 0.014, 0.075), DARK),
        box((0.0430, -0.030, 0.13), (0.006, 0.066, 0.014), DARK),
        box((0.0415, 0.0, 0.055), (0.004, 0.014, 0.014), DARK),
        *(box((0.0415, y, 0.13), (0.004, 0.014, 0.013), DARK) for y in (-0.075, 0.075)),
        *(ball((0.0, y, 0.235), 0.085, STEEL) for y in (-0.065, 0.065)),
        cylinder((0.0, 0.0, 0.26), 0.02, 0.05, STEEL),
        *(cylinder((0.0, y, 0.015), 0.035, 0.03, DARK) for y in (-0.07, 0.07)),
    )


def candle(main: Material) -> tuple[Part, ...]:
    """A burning candle in a candlestick with a finger ring at +y."""
    return (
        cylinder((0.0, 0.0, 0.008), 0.15, 0.016, main),
        cylinder((0.0, 0.0, 0.018), 0.165, 0.010, main),
        cylinder((0.0, 0.0, 0.05), 0.035, 0.06, main),
        cylinder((0.0, 0.0, 0.09), 0.085, 0.024, main),
        cylinder((0.0, 0.0, 0.17), 0.055, 0.16, PAPER),
        cylinder((0.0, 0.0, 0.256), 0.008, 0.014, DARK),
        ball((0.0, 0.0, 0.275), 0.032, FLAME),
        ball((0.0, 0.0, 0.293), 0.020, GLOW),
        box((0.0, 0.095, 0.018), (0.018, 0.04, 0.016), main),
        cylinder((0.0, 0.112, 0.045), 0.055, 0.014, main, Axis.X),
    )


def _paint(y_m: float, z_m: float, width_m: float, height_m: float, colour: str, layer: int) -> Part:
    x_m = CANVAS_X_M + PAINT_M * (layer - 0.5)
    return box((x_m, y_m, z_m), (PAINT_M, width_m, height_m), material(f"{colour} paint"))


def _disc(y_m: float, z_m: float, diameter_m: float, colour: str, layer: int) -> Part:
    x_m = CANVAS_X_M + PAINT_M * (layer - 0.5)
    return cylinder((x_m, y_m, z_m), diameter_m, PAINT_M, material(f"{colour} paint"), Axis.X)


def _landscape() -> tuple[Part, ...]:
    """A house on a meadow under the sun."""
    return (
        _paint(0.0, 0.23, 0.46, 0.32, "sky", 0),
        _paint(0.0, 0.13, 0.456, 0.11, "green", 1),
        _disc(0.13, 0.32, 0.09, "yellow", 1),
        _paint(-0.09, 0.20, 0.12, 0.10, "white", 2),
        _paint(-0.09, 0.265, 0.15, 0.04, "red", 3),
    )


def _bars() -> tuple[Part, ...]:
    """Upright bars of colour."""
    bars = ((-0.17, "red"), (-0.085, "orange"), (0.0, "yellow"), (0.085, "turquoise"), (0.17, "blue"))
    return (
        _paint(0.0, 0.23, 0.46, 0.32, "cream", 0),
        *(_paint(y, 0.23, 0.055, 0.28, colour, 1) for y, colour in bars),
    )


def _blocks() -> tuple[Part, ...]:
    """Blocks in the three primary colours between black lines."""
    return (
        _paint(0.0, 0.23, 0.46, 0.32, "white", 0),
        _paint(0.09, 0.29, 0.26, 0.18, "red", 1),
        _paint(-0.14, 0.13, 0.14, 0.10, "blue", 1),
        _paint(0.18, 0.11, 0.08, 0.06, "yellow", 1),
        _paint(-0.055, 0.23, 0.014, 0.316, "black", 1),
        _paint(0.0, 0.19, 0.456, 0.014, "black", 2),
    )


def _discs() -> tuple[Part, ...]:
    """Large dots, two of them ringed."""
    return (
        _paint(0.0, 0.23, 0.46, 0.32, "cream", 0),
        _disc(0.12, 0.27, 0.17, "red", 1),
        _disc(0.12, 0.27, 0.08, "yellow", 2),
        _disc(-0.08, 0.19, 0.19, "blue", 1),
        _disc(-0.08, 0.19, 0.09, "orange", 2),
        _disc(-0.16, 0.33, 0.08, "green", 1),
        _disc(0.08, 0.13, 0.08, "purple", 1),
    )


MOTIFS = {
    Pattern.PLAIN: _landscape,
    Pattern.STRIPED: _bars,
    Pattern.CHECKED: _blocks,
    Pattern.DOTTED: _discs,
}


def picture(main: Material) -> tuple[Part, ...]:
    """A framed picture that hangs with its back, at -x, on the wall; the pattern decides what it shows."""
    return (
        *(box((0.0, 0.25 * y, 0.23), (0.036, 0.04, 0.46), main) for y in (-1, 1)),
        *(box((0.0, 0.0, 0.23 + 0.19 * z), (0.035, 0.46, 0.08), main) for z in (-1, 1)),
        *MOTIFS[main.pattern](),
    )


PLANT = ObjectClass(
    label="plant",
    looks=Looks(
        colours=("brown", "white", "orange", "blue", "turquoise"),
        substances=(Substance.CERAMIC, Substance.STONE, Substance.METAL),
        patterns=(Pattern.PLAIN, Pattern.STRIPED),
    ),
    build=plant,
    belongs_on={**TABLES, **CHESTS, "washstand": 1.0, "mat": 0.5, "kitchen counter": 0.7},
)
VASE = ObjectClass(
    label="vase",
    looks=Looks(
        colours=("blue", "white", "purple", "green", "yellow", "black"),
        substances=(Substance.CERAMIC, Substance.GLASS),
        patterns=(Pattern.PLAIN, Pattern.STRIPED, Pattern.DOTTED),
    ),
    build=vase,
    belongs_on={**TABLES, "sideboard": 2.0, "dresser": 1.0, "washstand": 1.0, "nightstand": 0.7, "desk": 0.7},
)
LAMP = ObjectClass(
    label="lamp",
    looks=Looks(
        colours=("black", "brown", "red", "blue", "white", "turquoise"),
        substances=(Substance.CERAMIC, Substance.METAL, Substance.WOOD),
    ),
    build=lamp,
    belongs_on={
        "nightstand": 5.0,
        "desk": 2.0,
        "sideboard": 2.0,
        "dresser": 2.0,
        "side table": 3.0,
        "console table": 2.0,
        "low shelf": 0.7,
    },
)
CLOCK = ObjectClass(
    label="clock",
    looks=Looks(
        colours=("red", "brown", "black", "green", "gold", "blue"),
        substances=(Substance.METAL, Substance.WOOD, Substance.PLASTIC),
    ),
    build=clock,
    belongs_on={**CHESTS, "desk": 1.0, "kitchen counter": 1.0, "washstand": 1.0, "console table": 1.0},
)
CANDLE = ObjectClass(
    label="candle",
    looks=Looks(
        colours=("gold", "silver", "red", "green", "blue", "white"),
        substances=(Substance.METAL, Substance.CERAMIC, Substance.WOOD),
    ),
    build=candle,
    belongs_on={**TABLES, "sideboard": 2.0, "bathtub": 1.0, "washstand": 0.7, "nightstand": 1.0, "desk": 0.3},
)
PICTURE = ObjectClass(
    label="picture",
    looks=Looks(
        colours=("brown", "black", "white", "gold", "red"),
        substances=(Substance.WOOD, Substance.METAL),
        patterns=EVERY_PATTERN,
    ),
    build=picture,
    belongs_on={
        "sofa": 3.0,
        "sideboard": 3.0,
        "bed": 2.0,
        "single bed": 2.0,
        "dresser": 2.0,
        "desk": 1.5,
        "console table": 2.0,
        "low shelf": 1.5,
    },
    hangs=True,
)
