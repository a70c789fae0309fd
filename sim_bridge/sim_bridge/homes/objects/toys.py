"""What one plays with."""

from sim_bridge.homes.materials import Material, Pattern, Substance
from sim_bridge.homes.objects.object_class import EVERY_PATTERN, Looks, ObjectClass
from sim_bridge.homes.objects.places import SEATS
from sim_bridge.homes.objects.trimmings import DARK, GLOW, PAPER, RUBBER, STEEL, TAN_WOOD, WINDOW, against
from sim_bridge.homes.shapes import Axis, Part, box, cylinder
from sim_bridge.homes.shapes import ball as round_part


def teddy(main: Material) -> tuple[Part, ...]:
    """A sitting teddy bear that looks towards +x."""
    return (
        round_part((0.0, 0.0, 0.10), 0.20, main),
        round_part((0.01, 0.0, 0.25), 0.16, main),
        round_part((0.085, 0.0, 0.235), 0.06, PAPER),
        round_part((0.113, 0.0, 0.24), 0.022, DARK),
        *(round_part((0.08, y, 0.28), 0.022, DARK) for y in (-0.035, 0.035)),
        *(round_part((0.0, y, 0.325), 0.06, main) for y in (-0.065, 0.065)),
        *(round_part((0.11, y, 0.04), 0.08, main) for y in (-0.07, 0.07)),
        *(round_part((0.05, y, 0.15), 0.07, main) for y in (-0.11, 0.11)),
    )


def ball(main: Material) -> tuple[Part, ...]:
    """A large ball with two bands around it."""
    bands = against(main)
    return (
        round_part((0.0, 0.0, 0.111), 0.218, main),
        cylinder((0.0, 0.0, 0.111), 0.222, 0.022, bands),
        cylinder((0.0, 0.0, 0.111), 0.222, 0.022, bands, Axis.X),
    )


def toy_car(main: Material) -> tuple[Part, ...]:
    """A car that drives towards +x."""
    return (
        box((0.0, 0.0, 0.066), (0.32, 0.14, 0.06), main),
        box((-0.02, 0.0, 0.12), (0.16, 0.126, 0.054), WINDOW),
        box((-0.02, 0.0, 0.151), (0.17, 0.136, 0.012), main),
        box((-0.02, 0.0, 0.12), (0.02, 0.13, 0.056), main),
        *(
            cylinder((x, y, 0.04), 0.08, 0.034, RUBBER, Axis.Y)
            for x in (-0.10, 0.10)
            for y in (-0.065, 0.065)
        ),
        *(cylinder((x, y, 0.04), 0.04, 0.040, STEEL, Axis.Y) for x in (-0.10, 0.10) for y in (-0.065, 0.065)),
        *(cylinder((0.159, y, 0.072), 0.032, 0.008, GLOW, Axis.X) for y in (-0.045, 0.045)),
        box((0.158, 0.0, 0.046), (0.012, 0.146, 0.016), STEEL),
    )


def guitar(main: Material) -> tuple[Part, ...]:
    """A guitar that stands on two feet, its sound hole towards +x."""
    return (
        cylinder((0.0, 0.0, 0.18), 0.34, 0.09, main, Axis.X),
        cylinder((0.0, 0.0, 0.385), 0.25, 0.087, main, Axis.X),
        cylinder((0.0445, 0.0, 0.30), 0.14, 0.005, PAPER, Axis.X),
        cylinder((0.0463, 0.0, 0.30), 0.10, 0.005, DARK, Axis.X),
        box((0.0475, 0.0, 0.15), (0.008, 0.13, 0.022), DARK),
        box((0.040, 0.0, 0.60), (0.026, 0.050, 0.40), TAN_WOOD),
        box((0.0535, 0.0, 0.56), (0.003, 0.040, 0.42), DARK),
        box((0.040, 0.0, 0.85), (0.034, 0.085, 0.12), main),
        *(
            cylinder((0.040, 0.055 * y, z), 0.022, 0.03, STEEL, Axis.Y)
            for y in (-1, 1)
            for z in (0.825, 0.875)
        ),
        *(box((0.0, y, 0.03), (0.14, 0.03, 0.06), DARK) for y in (-0.08, 0.08)),
    )


TEDDY = ObjectClass(
    label="teddy",
    looks=Looks(
        colours=("brown", "white", "pink", "grey", "beige"),
        substances=(Substance.FABRIC,),
        patterns=(Pattern.PLAIN, Pattern.CHECKED, Pattern.DOTTED),
    ),
    build=teddy,
    belongs_on={**SEATS, "single bed": 4.0, "dresser": 1.0, "toy chest": 3.0, "low shelf": 1.5, "mat": 1.0},
)
BALL = ObjectClass(
    label="ball",
    looks=Looks(
        colours=("red", "blue", "yellow", "green", "orange", "pink"),
        substances=(Substance.PLASTIC, Substance.LEATHER),
        patterns=EVERY_PATTERN,
    ),
    build=ball,
    belongs_on={
        "mat": 4.0,
        "toy chest": 3.0,
        "armchair": 1.0,
        "single bed": 1.0,
        "sofa": 1.0,
        "low shelf": 1.0,
    },
)
TOY_CAR = ObjectClass(
    label="toy car",
    looks=Looks(
        colours=("red", "blue", "yellow", "green", "purple", "silver"),
        substances=(Substance.METAL, Substance.WOOD, Substance.PLASTIC),
    ),
    build=toy_car,
    belongs_on={
        "mat": 3.0,
        "toy chest": 3.0,
        "low shelf": 2.0,
        "coffee table": 1.0,
        "single bed": 1.0,
        "desk": 1.0,
        "sofa": 0.5,
    },
)
GUITAR = ObjectClass(
    label="guitar",
    looks=Looks(
        colours=("brown", "red", "black", "blue", "white"), substances=(Substance.WOOD, Substance.PLASTIC)
    ),
    build=guitar,
    belongs_on={"mat": 3.0, "sofa": 2.0, "armchair": 1.0, "bed": 1.0, "single bed": 1.5, "toy chest": 1.0},
)
