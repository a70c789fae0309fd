"""What lies about in bathrooms and on beds."""

from sim_bridge.homes.materials import Material, Pattern, Substance
from sim_bridge.homes.objects.object_class import EVERY_PATTERN, Looks, ObjectClass
from sim_bridge.homes.objects.places import WASHING
from sim_bridge.homes.objects.trimmings import STEEL, TAN_WOOD, WHITE
from sim_bridge.homes.shapes import Axis, Part, ball, box, cylinder


def pillow(main: Material) -> tuple[Part, ...]:
    """A plump pillow with drawn-out corners."""
    middle_m = 0.075
    return (
        box((0.0, 0.0, middle_m), (0.24, 0.34, 0.150), main),
        box((0.0, 0.0, middle_m), (0.31, 0.43, 0.125), main),
        *(cylinder((x, 0.0, middle_m), 0.10, 0.43, main, Axis.Y) for x in (-0.155, 0.155)),
        *(cylinder((0.0, y, middle_m), 0.10, 0.31, main, Axis.X) for y in (-0.215, 0.215)),
        *(ball((x, y, middle_m), 0.085, main) for x in (-0.165, 0.165) for y in (-0.225, 0.225)),
    )


def towel(main: Material) -> tuple[Part, ...]:
    """A towel folded to three layers, the folds at +x."""
    layers = ((0.021, 0.0, 0.34), (0.0635, 0.006, 0.33), (0.106, -0.004, 0.335))
    return (
        *(box((-0.02 + x, 0.0, z), (0.22, width, 0.042), main) for z, x, width in layers),
        *(cylinder((0.09 + x, 0.0, z), 0.042, width - 0.004, main, Axis.Y) for z, x, width in layers),
        *(box((-0.02, y, 0.1265), (0.19, 0.022, 0.004), WHITE) for y in (-0.13, -0.09, 0.09, 0.13)),
    )


def toilet_roll(main: Material) -> tuple[Part, ...]:
    """A roll of paper that lies along y, its last sheet hanging down at +x."""
    return (
        cylinder((0.0, 0.0, 0.065), 0.13, 0.12, main, Axis.Y),
        cylinder((0.0, 0.0, 0.065), 0.05, 0.126, TAN_WOOD, Axis.Y),
        box((0.065, 0.0, 0.04), (0.004, 0.116, 0.08), main),
    )


def soap_dispenser(main: Material) -> tuple[Part, ...]:
    """A bottle with a pump; its nozzle points to +x."""
    return (
        box((0.0, 0.0, 0.065), (0.085, 0.11, 0.13), main),
        cylinder((0.0, 0.0, 0.14), 0.055, 0.03, main),
        box((0.0425, 0.0, 0.06), (0.004, 0.07, 0.06), WHITE),
        cylinder((0.0, 0.0, 0.165), 0.038, 0.024, STEEL),
        cylinder((0.0, 0.0, 0.195), 0.014, 0.04, STEEL),
        cylinder((0.0, 0.0, 0.218), 0.048, 0.016, STEEL),
        box((0.045, 0.0, 0.2175), (0.075, 0.020, 0.010), STEEL),
        box((0.079, 0.0, 0.205), (0.012, 0.016, 0.022), STEEL),
    )


PILLOW = ObjectClass(
    label="pillow",
    looks=Looks(
        colours=("white", "yellow", "green", "blue", "red", "beige"),
        substances=(Substance.FABRIC, Substance.LEATHER),
        patterns=EVERY_PATTERN,
    ),
    build=pillow,
    belongs_on={"bed": 5.0, "single bed": 4.0, "sofa": 3.0, "armchair": 1.0},
)
TOWEL = ObjectClass(
    label="towel",
    looks=Looks(
        colours=("blue", "red", "green", "yellow", "purple", "turquoise"),
        substances=(Substance.FABRIC,),
        patterns=(Pattern.PLAIN, Pattern.STRIPED, Pattern.CHECKED),
    ),
    build=towel,
    belongs_on={
        "washing machine": 4.0,
        "dryer": 4.0,
        "ironing board": 4.0,
        "washstand": 1.0,
        "bed": 1.0,
        "chair": 0.5,
        "mat": 0.5,
        "dresser": 0.7,
    },
)
TOILET_ROLL = ObjectClass(
    label="toilet roll",
    looks=Looks(
        colours=("white", "pink", "turquoise", "yellow"),
        substances=(Substance.PAPER,),
        patterns=EVERY_PATTERN,
    ),
    build=toilet_roll,
    belongs_on={**WASHING, "toilet": 4.0, "low shelf": 1.0},
)
SOAP_DISPENSER = ObjectClass(
    label="soap dispenser",
    looks=Looks(
        colours=("white", "green", "blue", "orange", "pink"),
        substances=(Substance.PLASTIC, Substance.CERAMIC, Substance.GLASS),
    ),
    build=soap_dispenser,
    belongs_on={
        "washstand": 5.0,
        "sink unit": 4.0,
        "bathtub": 2.0,
        "washing machine": 1.0,
        "kitchen counter": 0.5,
    },
)
