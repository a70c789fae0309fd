"""What one wears, carries about or gives away."""

from sim_bridge.homes.materials import Material, Pattern, Substance
from sim_bridge.homes.objects.object_class import EVERY_PATTERN, Looks, ObjectClass
from sim_bridge.homes.objects.places import FLOOR, SEATS
from sim_bridge.homes.objects.trimmings import DARK, PAPER, STEEL, TAN_WOOD, WHITE, against
from sim_bridge.homes.shapes import Axis, Part, ball, box, cylinder


def backpack(main: Material) -> tuple[Part, ...]:
    """A backpack that stands; its pocket is at +x."""
    pocket = main.shaded(0.65)
    return (
        box((0.0, 0.0, 0.17), (0.16, 0.28, 0.34), main),
        cylinder((0.0, 0.0, 0.34), 0.156, 0.276, main, Axis.Y),
        box((0.10, 0.0, 0.12), (0.06, 0.22, 0.18), pocket),
        box((0.131, 0.0, 0.185), (0.005, 0.18, 0.014), STEEL),
        box((0.080, 0.0, 0.29), (0.006, 0.286, 0.024), DARK),
        *(box((0.0, y, 0.12), (0.10, 0.05, 0.20), pocket) for y in (-0.15, 0.15)),
        box((0.0, 0.0, 0.448), (0.030, 0.10, 0.024), DARK),
        *(box((0.0, y, 0.425), (0.024, 0.024, 0.04), DARK) for y in (-0.04, 0.04)),
        *(box((-0.09, y, 0.20), (0.024, 0.05, 0.30), DARK) for y in (-0.08, 0.08)),
    )


def basket(main: Material) -> tuple[Part, ...]:
    """A shopping basket with a high handle along y and a cloth inside."""
    return (
        *(box((0.12 * x, 0.0, 0.10), (0.02, 0.356, 0.20), main) for x in (-1, 1)),
        *(box((0.0, 0.17 * y, 0.099), (0.222, 0.02, 0.194), main) for y in (-1, 1)),
        box((0.0, 0.0, 0.07), (0.22, 0.32, 0.14), PAPER),
        *(box((0.132 * x, 0.0, 0.19), (0.012, 0.384, 0.028), main) for x in (-1, 1)),
        *(box((0.0, 0.186 * y, 0.189), (0.252, 0.012, 0.024), main) for y in (-1, 1)),
        *(box((0.0, 0.171 * y, 0.27), (0.034, 0.028, 0.16), main) for y in (-1, 1)),
        *(box((0.0, 0.145 * y, 0.352), (0.037, 0.05, 0.026), main) for y in (-1, 1)),
        box((0.0, 0.0, 0.366), (0.040, 0.26, 0.024), main),
    )


def shoe(main: Material) -> tuple[Part, ...]:
    """A laced shoe on a white sole, its toe towards +x."""
    return (
        box((-0.02, 0.0, 0.015), (0.25, 0.10, 0.03), WHITE),
        cylinder((0.105, 0.0, 0.017), 0.10, 0.034, WHITE),
        box((-0.075, 0.0, 0.085), (0.12, 0.094, 0.115), main),
        cylinder((-0.075, 0.0, 0.1425), 0.07, 0.006, DARK),
        box((0.02, 0.0, 0.068), (0.09, 0.090, 0.08), main),
        box((0.075, 0.0, 0.055), (0.07, 0.086, 0.054), main),
        ball((0.105, 0.0, 0.046), 0.088, main),
        *(
            box((x, 0.0, z), (0.014, 0.100, 0.010), WHITE)
            for x, z in ((0.045, 0.108), (0.02, 0.109), (-0.005, 0.11))
        ),
        box((-0.136, 0.0, 0.09), (0.006, 0.03, 0.08), WHITE),
    )


def hat(main: Material) -> tuple[Part, ...]:
    """A hat with a wide brim and a ribbon."""
    return (
        cylinder((0.0, 0.0, 0.01), 0.38, 0.012, main),
        cylinder((0.0, 0.0, 0.075), 0.21, 0.13, main),
        cylinder((0.0, 0.0, 0.036), 0.22, 0.042, against(main, Substance.FABRIC)),
        cylinder((0.0, 0.0, 0.145), 0.175, 0.02, main),
        cylinder((0.0, 0.0, 0.002), 0.37, 0.004, main),
    )


def umbrella(main: Material) -> tuple[Part, ...]:
    """An open umbrella that stands on its hooked handle."""
    return (
        cylinder((0.0, 0.0, 0.24), 0.016, 0.44, STEEL),
        cylinder((0.0, 0.0, 0.07), 0.034, 0.10, TAN_WOOD),
        box((0.0, 0.03, 0.014), (0.034, 0.094, 0.028), TAN_WOOD),
        box((0.0, 0.062, 0.045), (0.030, 0.024, 0.05), TAN_WOOD),
        cylinder((0.0, 0.0, 0.335), 0.46, 0.024, main),
        cylinder((0.0, 0.0, 0.357), 0.41, 0.024, main),
        cylinder((0.0, 0.0, 0.379), 0.34, 0.024, main),
        cylinder((0.0, 0.0, 0.401), 0.25, 0.024, main),
        cylinder((0.0, 0.0, 0.421), 0.14, 0.020, main),
        cylinder((0.0, 0.0, 0.455), 0.020, 0.06, DARK),
        *(
            cylinder((0.226 * x, 0.226 * y, 0.325), 0.016, 0.03, DARK)
            for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
        ),
    )


def gift_box(main: Material) -> tuple[Part, ...]:
    """A box with a lid, a ribbon crosswise and a bow."""
    ribbon = against(main, Substance.FABRIC)
    return (
        box((0.0, 0.0, 0.075), (0.21, 0.21, 0.15), main),
        box((0.0, 0.0, 0.165), (0.225, 0.225, 0.045), main),
        box((0.0, 0.0, 0.0955), (0.04, 0.229, 0.187), ribbon),
        box((0.0, 0.0, 0.0955), (0.229, 0.039, 0.191), ribbon),
        *(ball((0.0, y, 0.205), 0.065, ribbon) for y in (-0.04, 0.04)),
        *(ball((x, 0.0, 0.20), 0.050, ribbon) for x in (-0.035, 0.035)),
        ball((0.0, 0.0, 0.215), 0.035, main),
    )


def watering_can(main: Material) -> tuple[Part, ...]:
    """A watering can: its spout rises to +y, its handle is at -y."""
    return (
        cylinder((0.0, -0.04, 0.09), 0.20, 0.18, main),
        cylinder((0.0, -0.04, 0.1855), 0.14, 0.015, DARK),
        *(
            box((0.0, 0.07 + 0.030 * n, 0.05 + 0.042 * n), (0.040 - 0.003 * n, 0.040, 0.050), main)
            for n in range(5)
        ),
        cylinder((0.0, 0.212, 0.242), 0.055, 0.024, main, Axis.Y),
        cylinder((0.0, 0.230, 0.246), 0.085, 0.020, main, Axis.Y),
        cylinder((0.0, 0.246, 0.250), 0.12, 0.014, STEEL, Axis.Y),
        *(box((0.0, -0.04 + y, 0.225), (0.026, 0.026, 0.11), main) for y in (-0.08, 0.08)),
        box((0.0, -0.04, 0.288), (0.030, 0.19, 0.026), main),
        *(box((0.0, -0.165, z), (0.026, 0.09, 0.026), main) for z in (0.05, 0.14)),
        box((0.0, -0.210, 0.095), (0.030, 0.026, 0.124), main),
    )


BACKPACK = ObjectClass(
    label="backpack",
    looks=Looks(
        colours=("red", "blue", "orange", "green", "purple", "grey"),
        substances=(Substance.FABRIC, Substance.LEATHER),
        patterns=(Pattern.PLAIN, Pattern.CHECKED, Pattern.DOTTED),
    ),
    build=backpack,
    belongs_on={**SEATS, **FLOOR, "desk": 1.0},
)
BASKET = ObjectClass(
    label="basket",
    looks=Looks(
        colours=("brown", "beige", "white", "blue", "pink"),
        substances=(Substance.WOOD, Substance.FABRIC, Substance.PLASTIC),
        patterns=(Pattern.PLAIN, Pattern.CHECKED),
    ),
    build=basket,
    belongs_on={
        "mat": 4.0,
        "washing machine": 2.0,
        "dryer": 2.0,
        "kitchen counter": 1.5,
        "low shelf": 2.0,
        "dining table": 1.0,
        "shoe bench": 1.0,
        "ironing board": 0.5,
    },
)
SHOE = ObjectClass(
    label="shoe",
    looks=Looks(
        colours=("red", "blue", "black", "green", "brown", "pink"),
        substances=(Substance.LEATHER, Substance.FABRIC),
        patterns=(Pattern.PLAIN, Pattern.STRIPED, Pattern.CHECKED),
    ),
    build=shoe,
    belongs_on={"shoe bench": 5.0, "mat": 4.0, "chair": 0.3, "low shelf": 1.0},
)
HAT = ObjectClass(
    label="hat",
    looks=Looks(
        colours=("brown", "black", "red", "beige", "green", "purple"),
        substances=(Substance.FABRIC, Substance.LEATHER),
    ),
    build=hat,
    belongs_on={
        **SEATS,
        "dresser": 2.0,
        "sideboard": 0.7,
        "ironing board": 0.7,
        "toy chest": 0.5,
    },
)
UMBRELLA = ObjectClass(
    label="umbrella",
    looks=Looks(
        colours=("red", "blue", "yellow", "black", "purple", "turquoise"),
        substances=(Substance.FABRIC, Substance.PLASTIC),
        patterns=EVERY_PATTERN,
    ),
    build=umbrella,
    belongs_on={
        "mat": 5.0,
        "armchair": 0.5,
        "bed": 0.3,
        "washing machine": 0.7,
    },
)
GIFT_BOX = ObjectClass(
    label="gift box",
    looks=Looks(
        colours=("red", "blue", "green", "gold", "purple", "pink"),
        substances=(Substance.PAPER, Substance.METAL),
        patterns=EVERY_PATTERN,
    ),
    build=gift_box,
    belongs_on={
        "coffee table": 3.0,
        "dining table": 2.0,
        "bed": 1.5,
        "single bed": 1.5,
        "sofa": 1.5,
        "dresser": 1.5,
        "sideboard": 1.5,
        "low shelf": 1.0,
        "toy chest": 1.0,
        "office chair": 0.5,
        "filing cabinet": 0.7,
    },
)
WATERING_CAN = ObjectClass(
    label="watering can",
    looks=Looks(
        colours=("green", "blue", "silver", "yellow", "red"), substances=(Substance.METAL, Substance.PLASTIC)
    ),
    build=watering_can,
    belongs_on={
        "mat": 3.0,
        "low shelf": 2.0,
        "washing machine": 1.0,
        "shoe bench": 1.0,
        "filing cabinet": 1.0,
        "kitchen counter": 0.7,
        "sideboard": 0.7,
    },
)
