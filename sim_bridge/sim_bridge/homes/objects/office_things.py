"""What one works, reads, calls and watches with."""

from sim_bridge.homes.materials import Material, Pattern, Substance
from sim_bridge.homes.objects.object_class import Looks, ObjectClass
from sim_bridge.homes.objects.places import CHESTS, SEATS, TABLES
from sim_bridge.homes.objects.trimmings import DARK, DARK_SCREEN, PAPER, RUBBER, SCREEN, WHITE, against
from sim_bridge.homes.scene import Size
from sim_bridge.homes.shapes import Axis, Part, box, cylinder


def book(main: Material) -> tuple[Part, ...]:
    """A thick book that lies, its spine at -y, a title on its cover."""
    return (
        box((0.0, 0.0, 0.005), (0.26, 0.19, 0.010), main),
        box((0.0, 0.004, 0.035), (0.245, 0.174, 0.05), PAPER),
        box((0.0, 0.0, 0.065), (0.26, 0.19, 0.010), main),
        box((0.0, -0.090, 0.035), (0.26, 0.010, 0.05), main),
        box((0.03, 0.0, 0.070), (0.08, 0.12, 0.003), PAPER),
        box((-0.06, 0.0, 0.070), (0.02, 0.12, 0.003), PAPER),
    )


def laptop(main: Material) -> tuple[Part, ...]:
    """An open laptop; its screen faces +x."""
    return (
        box((0.0, 0.0, 0.009), (0.26, 0.36, 0.018), main),
        box((-0.02, 0.0, 0.0185), (0.12, 0.31, 0.003), against(main)),
        box((0.085, 0.0, 0.0185), (0.06, 0.11, 0.003), against(main)),
        box((-0.126, 0.0, 0.135), (0.010, 0.362, 0.234), main),
        box((-0.1205, 0.0, 0.138), (0.003, 0.32, 0.20), SCREEN),
        box((-0.1190, 0.06, 0.16), (0.003, 0.12, 0.09), WHITE),
    )


def phone(main: Material) -> tuple[Part, ...]:
    """A desk telephone: the dial looks up at +x, the handset lies across its back."""
    return (
        box((0.0, 0.0, 0.025), (0.22, 0.20, 0.05), main),
        box((-0.045, 0.0, 0.065), (0.11, 0.16, 0.05), main),
        cylinder((0.05, 0.0, 0.055), 0.11, 0.015, WHITE),
        cylinder((0.05, 0.0, 0.0635), 0.05, 0.006, main),
        *(box((-0.045, y, 0.10), (0.06, 0.016, 0.03), DARK) for y in (-0.05, 0.05)),
        box((-0.045, 0.0, 0.125), (0.036, 0.22, 0.028), main),
        *(cylinder((-0.045, y, 0.106), 0.066, 0.05, main) for y in (-0.115, 0.115)),
    )


def keyboard(main: Material) -> tuple[Part, ...]:
    """A computer keyboard, its space bar at +x, with a block of numbers at +y."""
    keys = against(main)
    rows = (-0.055, -0.022, 0.011)
    return (
        box((0.0, 0.0, 0.011), (0.18, 0.46, 0.022), main),
        *(box((x, y, 0.023), (0.026, 0.075, 0.008), keys) for x in rows for y in (-0.17, -0.085, 0.0, 0.155)),
        box((0.046, -0.085, 0.023), (0.026, 0.16, 0.008), keys),
        box((0.046, 0.155, 0.023), (0.026, 0.075, 0.008), keys),
    )


def headphones(main: Material) -> tuple[Part, ...]:
    """Headphones that stand on their cups; the band arches over them along y."""
    return (
        *(cylinder((0.0, 0.086 * y, 0.055), 0.11, 0.036, main, Axis.Y) for y in (-1, 1)),
        *(cylinder((0.0, 0.058 * y, 0.055), 0.095, 0.028, RUBBER, Axis.Y) for y in (-1, 1)),
        *(box((0.0, 0.107 * y, 0.115), (0.030, 0.014, 0.13), main) for y in (-1, 1)),
        *(box((0.0, 0.092 * y, 0.185), (0.034, 0.026, 0.034), main) for y in (-1, 1)),
        *(box((0.0, 0.066 * y, 0.206), (0.038, 0.040, 0.028), main) for y in (-1, 1)),
        box((0.0, 0.0, 0.220), (0.042, 0.10, 0.024), main),
    )


def tv(main: Material) -> tuple[Part, ...]:
    """A television on a foot; its screen faces +x."""
    return (
        box((0.0, 0.0, 0.01), (0.20, 0.40, 0.02), main),
        box((0.0, 0.0, 0.06), (0.04, 0.10, 0.09), main),
        box((0.0, 0.0, 0.36), (0.05, 0.92, 0.54), main),
        box((0.0255, 0.0, 0.365), (0.003, 0.86, 0.48), DARK_SCREEN),
    )


BOOK = ObjectClass(
    label="book",
    looks=Looks(
        colours=("red", "blue", "green", "purple", "brown", "yellow", "grey"),
        substances=(Substance.PAPER, Substance.LEATHER, Substance.FABRIC),
        patterns=(Pattern.PLAIN, Pattern.STRIPED, Pattern.CHECKED),
    ),
    build=book,
    belongs_on={**TABLES, **CHESTS, **SEATS, "mat": 0.5, "toy chest": 0.7},
)
LAPTOP = ObjectClass(
    label="laptop",
    looks=Looks(colours=("grey", "black", "white", "pink"), substances=(Substance.METAL, Substance.PLASTIC)),
    build=laptop,
    belongs_on={
        "desk": 5.0,
        "dining table": 2.0,
        "coffee table": 2.0,
        "bed": 0.7,
        "sofa": 0.7,
        "sideboard": 0.5,
    },
)
PHONE = ObjectClass(
    label="phone",
    looks=Looks(
        colours=("red", "black", "white", "green", "grey"), substances=(Substance.PLASTIC, Substance.METAL)
    ),
    build=phone,
    belongs_on={
        "console table": 4.0,
        "desk": 3.0,
        "side table": 2.0,
        "nightstand": 1.5,
        "sideboard": 1.5,
        "filing cabinet": 1.0,
        "ironing board": 0.3,
    },
)
KEYBOARD = ObjectClass(
    label="keyboard",
    looks=Looks(colours=("black", "white", "grey", "red"), substances=(Substance.PLASTIC, Substance.METAL)),
    build=keyboard,
    belongs_on={
        "desk": 5.0,
        "low shelf": 1.0,
        "filing cabinet": 0.7,
        "dining table": 0.7,
        "coffee table": 0.5,
    },
)
HEADPHONES = ObjectClass(
    label="headphones",
    looks=Looks(
        colours=("black", "white", "red", "blue", "pink"), substances=(Substance.PLASTIC, Substance.LEATHER)
    ),
    build=headphones,
    belongs_on={
        **CHESTS,
        "desk": 4.0,
        "coffee table": 1.5,
        "sofa": 0.7,
        "single bed": 0.7,
        "office chair": 0.5,
    },
)
TV = ObjectClass(
    label="tv",
    looks=Looks(
        colours=("black", "grey", "white", "silver"),
        substances=(Substance.PLASTIC, Substance.METAL),
        sizes=(Size.SMALL, Size.MEDIUM),
    ),
    build=tv,
    belongs_on={"tv stand": 6.0, "sideboard": 1.0, "dresser": 1.0},
)
