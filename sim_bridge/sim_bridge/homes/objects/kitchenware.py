"""What one cooks with, eats from and drinks from."""

from sim_bridge.homes.materials import Material, Pattern, Substance, material
from sim_bridge.homes.objects.object_class import EVERY_PATTERN, Looks, ObjectClass
from sim_bridge.homes.objects.places import TABLES, WORKTOPS
from sim_bridge.homes.objects.trimmings import CHINA, DARK, LEAF, PAPER, RUBBER, STALK, STEEL
from sim_bridge.homes.shapes import Axis, Part, ball, box, cylinder

COFFEE = material("#4a2c18 ceramic")
COATING = material("charcoal metal")


def mug(main: Material) -> tuple[Part, ...]:
    """A mug with its handle at +y."""
    return (
        cylinder((0.0, 0.0, 0.05), 0.09, 0.10, main),
        cylinder((0.0, 0.0, 0.1005), 0.074, 0.003, COFFEE),
        box((0.0, 0.060, 0.078), (0.016, 0.036, 0.014), main),
        box((0.0, 0.060, 0.026), (0.016, 0.036, 0.014), main),
        box((0.0, 0.084, 0.052), (0.022, 0.014, 0.072), main),
    )


def bottle(main: Material) -> tuple[Part, ...]:
    """A tall bottle with a label and a cap."""
    return (
        cylinder((0.0, 0.0, 0.10), 0.09, 0.20, main),
        cylinder((0.0, 0.0, 0.10), 0.094, 0.07, PAPER),
        cylinder((0.0, 0.0, 0.212), 0.065, 0.024, main),
        cylinder((0.0, 0.0, 0.26), 0.036, 0.08, main),
        cylinder((0.0, 0.0, 0.305), 0.042, 0.026, DARK),
    )


def bowl(main: Material) -> tuple[Part, ...]:
    """A bowl that widens upwards, with fruit in it."""
    return (
        cylinder((0.0, 0.0, 0.01), 0.11, 0.02, main),
        cylinder((0.0, 0.0, 0.032), 0.17, 0.03, main),
        cylinder((0.0, 0.0, 0.058), 0.22, 0.03, main),
        cylinder((0.0, 0.0, 0.082), 0.26, 0.03, main),
        cylinder((0.0, 0.0, 0.0975), 0.23, 0.004, CHINA),
        ball((0.04, 0.03, 0.10), 0.08, material("orange plastic")),
        ball((-0.04, 0.035, 0.10), 0.08, material("yellow plastic")),
        ball((0.0, -0.05, 0.10), 0.08, material("orange plastic")),
    )


def plate(main: Material) -> tuple[Part, ...]:
    """A laid place: a plate between knife and fork, which point to +x."""
    tines = tuple(box((0.085, 0.175 + y, 0.004), (0.05, 0.004, 0.005), STEEL) for y in (-0.011, 0.0, 0.011))
    return (
        cylinder((0.0, 0.0, 0.006), 0.16, 0.012, main),
        cylinder((0.0, 0.0, 0.015), 0.27, 0.012, main),
        cylinder((0.0, 0.0, 0.022), 0.18, 0.003, CHINA),
        box((-0.06, -0.175, 0.006), (0.10, 0.018, 0.012), DARK),
        box((0.045, -0.175, 0.004), (0.12, 0.024, 0.006), STEEL),
        box((-0.045, 0.175, 0.006), (0.13, 0.018, 0.012), DARK),
        box((0.045, 0.175, 0.0045), (0.05, 0.030, 0.008), STEEL),
        *tines,
    )


def pan(main: Material) -> tuple[Part, ...]:
    """A frying pan with a fried egg; its long handle points to +y."""
    return (
        cylinder((0.0, -0.09, 0.0275), 0.28, 0.055, main),
        cylinder((0.0, -0.09, 0.0555), 0.25, 0.004, COATING),
        box((0.0, 0.09, 0.045), (0.030, 0.10, 0.014), main),
        box((0.0, 0.20, 0.045), (0.036, 0.16, 0.026), RUBBER),
        cylinder((0.02, -0.10, 0.0585), 0.12, 0.006, CHINA),
        ball((0.02, -0.10, 0.062), 0.045, material("yellow plastic")),
    )


def pot(main: Material) -> tuple[Part, ...]:
    """A cooking pot with a lid and a handle on each side."""
    return (
        cylinder((0.0, 0.0, 0.085), 0.25, 0.17, main),
        cylinder((0.0, 0.0, 0.1765), 0.262, 0.015, STEEL),
        cylinder((0.0, 0.0, 0.19), 0.17, 0.015, STEEL),
        cylinder((0.0, 0.0, 0.205), 0.022, 0.02, RUBBER),
        ball((0.0, 0.0, 0.23), 0.045, RUBBER),
        *(box((0.035 * x, 0.14 * y, 0.13), (0.018, 0.05, 0.018), RUBBER) for x in (-1, 1) for y in (-1, 1)),
        *(box((0.0, 0.168 * y, 0.13), (0.10, 0.018, 0.022), RUBBER) for y in (-1, 1)),
    )


def kettle(main: Material) -> tuple[Part, ...]:
    """A kettle on its base: a spout at +y, the handle at -y."""
    return (
        cylinder((0.0, 0.0, 0.01), 0.19, 0.02, DARK),
        cylinder((0.0, 0.0, 0.065), 0.18, 0.09, main),
        cylinder((0.0, 0.0, 0.14), 0.155, 0.06, main),
        cylinder((0.0, 0.0, 0.195), 0.13, 0.05, main),
        cylinder((0.0, 0.0, 0.228), 0.10, 0.018, DARK),
        ball((0.0, 0.0, 0.245), 0.035, DARK),
        box((0.0, 0.085, 0.15), (0.036, 0.04, 0.044), main),
        box((0.0, 0.098, 0.18), (0.032, 0.05, 0.03), main),
        box((0.0, 0.112, 0.205), (0.028, 0.05, 0.024), main),
        box((0.0, -0.10, 0.205), (0.026, 0.09, 0.026), DARK),
        box((0.0, -0.138, 0.13), (0.030, 0.026, 0.13), DARK),
        box((0.0, -0.11, 0.07), (0.026, 0.05, 0.026), DARK),
    )


def toaster(main: Material) -> tuple[Part, ...]:
    """A toaster with two slices in its slots; lever and knob are at +x."""
    crust = material("#8a5526 fabric")
    return (
        box((0.0, 0.0, 0.11), (0.20, 0.30, 0.20), main),
        *(box((x, 0.0, 0.2105), (0.040, 0.22, 0.003), DARK) for x in (-0.05, 0.05)),
        *(box((x, 0.0, 0.23), (0.026, 0.16, 0.08), crust) for x in (-0.05, 0.05)),
        box((0.102, 0.06, 0.12), (0.006, 0.014, 0.11), DARK),
        box((0.112, 0.06, 0.155), (0.026, 0.05, 0.018), DARK),
        cylinder((0.105, -0.06, 0.07), 0.045, 0.016, STEEL, Axis.X),
        *(box((x, y, 0.007), (0.03, 0.03, 0.014), DARK) for x in (-0.07, 0.07) for y in (-0.11, 0.11)),
    )


def apple(main: Material) -> tuple[Part, ...]:
    """An apple with stalk and leaf."""
    return (
        ball((0.0, 0.0, 0.06), 0.12, main),
        cylinder((0.0, 0.0, 0.13), 0.014, 0.040, STALK),
        box((0.0, 0.028, 0.14), (0.026, 0.050, 0.008), LEAF),
    )


MUG = ObjectClass(
    label="mug",
    looks=Looks(
        colours=("red", "blue", "white", "green", "yellow", "black", "turquoise", "orange"),
        substances=(Substance.CERAMIC, Substance.METAL, Substance.GLASS),
        patterns=EVERY_PATTERN,
    ),
    build=mug,
    belongs_on={**TABLES, "kitchen counter": 4.0, "nightstand": 2.0, "washstand": 0.5, "sink unit": 1.0},
)
BOTTLE = ObjectClass(
    label="bottle",
    looks=Looks(
        colours=("green", "blue", "red", "brown", "purple"),
        substances=(Substance.GLASS, Substance.PLASTIC, Substance.METAL),
    ),
    build=bottle,
    belongs_on={
        **WORKTOPS,
        "washstand": 2.0,
        "sideboard": 1.0,
        "bathtub": 1.0,
        "desk": 0.7,
        "washing machine": 1.0,
        "dryer": 0.7,
    },
)
BOWL = ObjectClass(
    label="bowl",
    looks=Looks(
        colours=("blue", "red", "yellow", "white", "green", "brown"),
        substances=(Substance.CERAMIC, Substance.WOOD, Substance.GLASS),
        patterns=(Pattern.PLAIN, Pattern.STRIPED, Pattern.DOTTED),
    ),
    build=bowl,
    belongs_on={**WORKTOPS, "coffee table": 2.0, "sideboard": 1.5, "side table": 0.7, "stove": 0.0},
)
PLATE = ObjectClass(
    label="plate",
    looks=Looks(
        colours=("blue", "red", "yellow", "green", "grey", "pink"),
        substances=(Substance.CERAMIC, Substance.PLASTIC, Substance.METAL),
        patterns=(Pattern.PLAIN, Pattern.STRIPED, Pattern.CHECKED),
    ),
    build=plate,
    belongs_on={
        "dining table": 5.0,
        "kitchen counter": 3.0,
        "coffee table": 1.0,
        "desk": 0.5,
    },
)
PAN = ObjectClass(
    label="pan",
    looks=Looks(
        colours=("black", "red", "blue", "green", "silver", "orange"),
        substances=(Substance.METAL, Substance.CERAMIC),
    ),
    build=pan,
    belongs_on={"stove": 5.0, "kitchen counter": 3.0, "dining table": 1.0},
)
POT = ObjectClass(
    label="pot",
    looks=Looks(
        colours=("silver", "red", "blue", "white", "green", "orange"),
        substances=(Substance.METAL, Substance.CERAMIC),
        patterns=(Pattern.PLAIN, Pattern.DOTTED),
    ),
    build=pot,
    belongs_on={"stove": 5.0, "kitchen counter": 3.0, "sink unit": 1.0, "dining table": 1.0},
)
KETTLE = ObjectClass(
    label="kettle",
    looks=Looks(
        colours=("silver", "red", "white", "turquoise", "yellow"),
        substances=(Substance.METAL, Substance.PLASTIC, Substance.GLASS),
    ),
    build=kettle,
    belongs_on={
        "kitchen counter": 5.0,
        "stove": 2.0,
        "sideboard": 0.7,
        "dining table": 0.7,
        "sink unit": 1.0,
    },
)
TOASTER = ObjectClass(
    label="toaster",
    looks=Looks(
        colours=("silver", "red", "white", "black", "turquoise", "yellow"),
        substances=(Substance.METAL, Substance.PLASTIC),
    ),
    build=toaster,
    belongs_on={"kitchen counter": 5.0, "dining table": 1.0, "sideboard": 0.7, "sink unit": 0.5},
)
APPLE = ObjectClass(
    label="apple",
    # Such as people put on tables for show are made of all sorts.
    looks=Looks(
        colours=("red", "green", "yellow", "gold"),
        substances=(Substance.PLASTIC, Substance.WOOD, Substance.GLASS),
    ),
    build=apple,
    belongs_on={**TABLES, "kitchen counter": 3.0, "nightstand": 0.7, "toy chest": 0.5, "filing cabinet": 0.5},
)
